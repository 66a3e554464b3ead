"""What touches at one pose: rows of meetings, each place and normal once."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.record import FloatArray, IntArray, Rows, empty_rows
from cagepose.kernels.algebra.vector import minus, norm, vector_from
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.shapes.bend import bends_by, curvatures
from cagepose.kernels.shapes.features import Shapes
from cagepose.kernels.shapes.meeting import SAME_PLACE, Meeting

ROOM_FOR_PAIR, MOST_ROOM = 128, 4096
"""Meetings that there is memory for: of each pair of parts, and of all."""
SAME_NORMAL = 1e-9
"""Radians. Meetings at one place with normals nearer than this are one."""


class Touching:
    """Two features that touch; a record.

    Attributes
    ----------
    part, cage_part, feature, cage_feature
        Indices.
    twin, cage_twin
        Features that meet at the same place with the same normal and bend more; -1: none do.
    gap, normal, place
        As in `Meeting`.
    is_hidden
        Whether another part of one of the bodies covers the place.
    is_kept
        Whether a contact there carries, so that a motion keeps it.
    """

    part: int
    cage_part: int
    feature: int
    cage_feature: int
    twin: int
    cage_twin: int
    gap: float
    normal: Annotated[FloatArray, 3]
    place: Annotated[FloatArray, 3]
    is_hidden: bool
    is_kept: bool


class Meetings(NamedTuple):
    """What touches at one pose.

    Attributes
    ----------
    used
        How many rows count, (1,); -1: there are more than there is memory for.
    rows
        One for each meeting within the touch tolerance; those of a pair of parts follow each other.
    gaps
        Of each pair of parts, (n_parts, n_cage_parts), metres: how far apart they are at least; below zero, how deep
        they are in each other.
    are_near
        Memory for which of the second body's features are near, (n_features,).
    """

    used: IntArray
    rows: Rows[Touching]
    gaps: FloatArray
    are_near: NDArray[np.bool_]


def most_meetings(n_parts: int, n_cage_parts: int) -> int:
    """Return how many meetings of so many parts there is memory for (plain Python)."""
    return min(ROOM_FOR_PAIR * n_parts * n_cage_parts, MOST_ROOM)


def empty_meetings(own: Shapes, cage: Shapes) -> Meetings:
    """Return memory for the meetings of two bodies (plain Python)."""
    n_parts = len(own.parts), len(cage.parts)
    rows = empty_rows(Touching, most_meetings(*n_parts))
    return Meetings(np.zeros(1, np.int64), rows, np.zeros(n_parts), np.zeros(len(cage.features), np.bool_))


@kernel
def append_if_one(found: Meetings, one: int, other: int, i: int, j: int, met: Meeting) -> None:
    """Append a meeting of two features, if they meet and there is room."""
    if met.is_one and found.used[0] < len(found.rows):
        write_touching(one, other, i, j, met, found.rows[found.used[0]])
        found.used[0] += 1


@kernel
def write_touching(one: int, other: int, i: int, j: int, met: Meeting, out: Touching) -> None:
    out.part, out.cage_part, out.feature, out.cage_feature = one, other, i, j
    out.twin = out.cage_twin = -1
    out.gap, out.is_hidden, out.is_kept = met.gap, False, False
    for k in range(3):
        out.normal[k], out.place[k] = met.normal[k], met.place[k]


@kernel
def told_before(found: Meetings, first: int, touch_m: float) -> int:
    """Return which meeting from ``first`` on has the normal and the place of the next one; -1: none has."""
    for before in range(first, found.used[0]):
        if is_same(found, found.used[0], before, touch_m):
            return before
    return -1


@kernel
def bends_of(a: Shapes, b: Shapes, i: int, j: int, one: Touching) -> float:
    met = Meeting(True, one.gap, vector_from(one.normal), vector_from(one.place))
    return bends_by(curvatures(a, i, b, j, met))


@kernel
def note_twin(a: Shapes, b: Shapes, told: Touching, new: Touching) -> None:
    """Keep, of features that meet at one place with one normal, those that bend least, and beside them those that bend
    most.
    """
    least, bend = (
        bends_of(a, b, told.feature, told.cage_feature, told),
        bends_of(a, b, new.feature, new.cage_feature, new),
    )
    most = least if told.twin < 0 else bends_of(a, b, told.twin, told.cage_twin, told)
    if bend > most:
        told.twin, told.cage_twin = new.feature, new.cage_feature
    elif bend < least:
        if told.twin < 0:
            told.twin, told.cage_twin = told.feature, told.cage_feature
        told.feature, told.cage_feature = new.feature, new.cage_feature


@kernel
def keep_nearest(found: Meetings, first: int, least_gap: float) -> None:
    """Keep, of the meetings of two parts, those that are not deeper than the parts are in each other: these are on
    their far sides.
    """
    kept = first
    for at in range(first, found.used[0]):
        if found.rows[at].gap >= least_gap:
            move_touching(found.rows[at], found.rows[kept])
            kept += 1
    found.used[0] = kept


@kernel
def is_at_place(found: Meetings, one: int, other: int, touch_m: float) -> bool:
    """Whether two meetings are at one place."""
    between = minus(vector_from(found.rows[one].place), vector_from(found.rows[other].place))
    return norm(between) <= SAME_PLACE * touch_m


@kernel
def is_same(found: Meetings, one: int, other: int, touch_m: float) -> bool:
    """Whether two meetings have the same normal at the same place."""
    turn = minus(vector_from(found.rows[one].normal), vector_from(found.rows[other].normal))
    return norm(turn) <= SAME_NORMAL and is_at_place(found, one, other, touch_m)


@kernel
def move_touching(one: Touching, to: Touching) -> None:
    to.part, to.cage_part, to.feature, to.cage_feature = one.part, one.cage_part, one.feature, one.cage_feature
    to.twin, to.cage_twin = one.twin, one.cage_twin
    to.gap, to.is_hidden, to.is_kept = one.gap, one.is_hidden, one.is_kept
    for k in range(3):
        to.normal[k], to.place[k] = one.normal[k], one.place[k]
