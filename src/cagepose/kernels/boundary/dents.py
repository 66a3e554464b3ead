"""Dents: where two smooth surfaces are in each other, and no sharp edge is near.

A ball and a face, a ball and a round side, two balls or two round sides have a common normal there; so have the tube
around a circle and any of these.
"""

from __future__ import annotations

from typing import NamedTuple

from cagepose.kernels.algebra.record import IntArray, Rows
from cagepose.kernels.algebra.vector import Vector, minus, plus, scaled, transposed_times
from cagepose.kernels.boundary.circle_meeting import meet_all_around
from cagepose.kernels.boundary.features import (
    CIRCLE,
    FACE,
    LINE,
    VERTEX,
    Feature,
    PlacedBoundary,
    box_of,
    place_feature,
    position_of,
    rotation_of,
)
from cagepose.kernels.boundary.meeting import both_reach
from cagepose.kernels.boundary.meetings import PLACES_AROUND, find_circle_places, meeting_at
from cagepose.kernels.boundary.surfaces import has_surface
from cagepose.kernels.boundary.tree import boxes_apart
from cagepose.kernels.boundary.within import Nearest, depth_in, root_has_surfaces
from cagepose.kernels.circles.places import GREATEST, SADDLE, WHOLE, Place
from cagepose.kernels.native.kernel import kernel

SLACK_SINE = 1e-6
"""Sine that a normal may be beyond those of a feature, so that none falls between two."""


class Dent(NamedTuple):
    """Two features that have a common normal in each other, and how deep, metres; -1: none."""

    feature: int
    cage_feature: int
    depth_m: float


@kernel
def can_dent(one: Feature, other: Feature) -> bool:
    """Whether the surfaces of two features can be in each other where they have a common normal, of which one is a
    ball or a tube; or both are round outward sides.
    """
    if one.kind == CIRCLE or other.kind == CIRCLE:
        return has_surface(one) and has_surface(other)
    if one.kind == LINE and other.kind == LINE:
        return one.radius > 0.0 and other.radius > 0.0
    if one.kind == VERTEX and one.radius > 0.0:
        return other.kind == FACE or other.radius != 0.0
    return other.kind == VERTEX and other.radius > 0.0 and (one.kind == FACE or one.radius != 0.0)


@kernel
def find_dents(
    held: PlacedBoundary,
    cage: PlacedBoundary,
    touch_m: float,
    deeper_than_m: float,
    pairs: IntArray,
    waiting: IntArray,
    places: Rows[Place],
) -> Dent:
    """Return the deepest dent, if it is deeper than a length."""
    best = Dent(-1, -1, deeper_than_m)
    for own in range(3):
        for other in range(3):
            is_round = held.own.nodes[own].is_rounded or cage.own.nodes[other].is_rounded
            if is_round and root_has_surfaces(held.own, own) and root_has_surfaces(cage.own, other):
                best = _descend(held, own, cage, other, touch_m, best, pairs, waiting, places)
    return best


@kernel
def _descend(
    held: PlacedBoundary,
    own: int,
    cage: PlacedBoundary,
    other: int,
    touch_m: float,
    best: Dent,
    pairs: IntArray,
    waiting: IntArray,
    places: Rows[Place],
) -> Dent:
    pairs[0, 0], pairs[0, 1] = own, other
    n_waiting = 1
    while n_waiting > 0:
        n_waiting -= 1
        at, cage_at = pairs[n_waiting, 0], pairs[n_waiting, 1]
        one, two = held.own.nodes[at], cage.own.nodes[cage_at]
        box, cage_box = box_of(held, at), box_of(cage, cage_at)
        if boxes_apart(box, cage_box) > 0.0:
            continue
        if one.left < 0 and two.left < 0:
            for i in range(one.first, one.last):
                for j in range(two.first, two.last):
                    if can_dent(held.own.features[i], cage.own.features[j]):
                        best = _deeper(held, i, cage, j, touch_m, best, waiting, places)
            continue
        divides_held = two.left < 0 or (one.left >= 0 and max(box.half) >= max(cage_box.half))
        for side in range(2):
            left, right = (one.left, one.right) if divides_held else (two.left, two.right)
            child = left if side == 0 else right
            pairs[n_waiting, 0] = child if divides_held else at
            pairs[n_waiting, 1] = cage_at if divides_held else child
            n_waiting += 1
    return best


@kernel
def _deeper(
    held: PlacedBoundary,
    i: int,
    cage: PlacedBoundary,
    j: int,
    touch_m: float,
    best: Dent,
    waiting: IntArray,
    places: Rows[Place],
) -> Dent:
    """Return the deeper of a dent and those of two features: a foot of a common normal is in the other body."""
    place_feature(held, i)
    place_feature(cage, j)
    one, other = held.features[i], cage.features[j]
    n_places = find_circle_places(one, other, touch_m, places)
    if n_places == WHOLE:
        n_places = PLACES_AROUND if meet_all_around(one, other) else 0
    for k in range(n_places):
        if places[k].kind in (GREATEST, SADDLE):
            continue
        met = meeting_at(held, i, cage, j, places[k])
        if not met.is_one or met.gap >= -touch_m or not both_reach(held, i, cage, j, met, SLACK_SINE, touch_m):
            continue
        depth = _depth_at(cage, met.place, touch_m, waiting).distance
        depth = max(depth, _depth_at(held, plus(met.place, scaled(met.normal, met.gap)), touch_m, waiting).distance)
        if depth > best.depth_m:
            best = Dent(i, j, depth)
    return best


@kernel
def _depth_at(body: PlacedBoundary, place: Vector, touch_m: float, waiting: IntArray) -> Nearest:
    seen = transposed_times(rotation_of(body), minus(place, position_of(body)))
    return depth_in(body.own, seen, touch_m, waiting)
