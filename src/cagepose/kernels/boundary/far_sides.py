"""Meetings of features that are deep in each other, but on the far sides of bodies that are not so deep."""

from __future__ import annotations

from cagepose.kernels.algebra.vector import Vector, minus, norm, plus, scaled, vector_from
from cagepose.kernels.boundary.features import FACE, Boundary
from cagepose.kernels.boundary.touching import Meetings
from cagepose.kernels.native.kernel import kernel

FAR = -1
"""Instead of a group, of a meeting that is to be dropped."""


@kernel
def drop_far_sides(held: Boundary, cage: Boundary, touch_m: float, found: Meetings) -> None:
    """Drop meetings that say that a place of one body is deep in the other one, where this has a surface that is nearer
    to the place. Of what is deep in a face it has been asked whether any surface is.
    """
    n_far = 0
    for at in range(found.used[0]):
        row = found.rows[at]
        of_face = held.features[row.feature].kind == FACE or cage.features[row.cage_feature].kind == FACE
        if row.gap < -touch_m and not of_face and is_on_far_side(found, at, touch_m):
            row.group = FAR
            n_far += 1
    kept = 0
    for at in range(found.used[0] if n_far > 0 else 0):
        if found.rows[at].group != FAR:
            found.rows[kept] = found.rows[at]  # type: ignore[index]
            found.rows[kept].group = kept
            kept += 1
    if n_far > 0:
        found.used[0] = kept


@kernel
def is_on_far_side(found: Meetings, at: int, touch_m: float) -> bool:
    """Whether another meeting shows a surface nearer to one of the places of a meeting than that is deep."""
    row = found.rows[at]
    place, opposite, nearer_m = vector_from(row.place), opposite_of(found, at), -row.gap - touch_m
    for other in range(found.used[0]):
        if other == at:
            continue
        if norm(minus(vector_from(found.rows[other].place), opposite)) < nearer_m:
            return True
        if norm(minus(opposite_of(found, other), place)) < nearer_m:
            return True
    return False


@kernel
def opposite_of(found: Meetings, at: int) -> Vector:
    """Return the place of a meeting on the cage."""
    row = found.rows[at]
    return plus(vector_from(row.place), scaled(vector_from(row.normal), row.gap))
