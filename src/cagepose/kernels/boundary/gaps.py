"""Where two boundaries that do not touch are nearest to each other: the places where their distance is extreme nearby.

Two features have a gap where a common normal leads out of the one and into the other, equation (2.11), through nothing
else. These are the meetings of `meetings`, farther apart than what touches; and those of sharp corners and edges, which
can be nearest to each other though they never touch.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np

from cagepose.kernels.algebra.record import FloatArray, IntArray, Rows, empty_rows
from cagepose.kernels.algebra.vector import Vector, minus, norm, plus, scaled, vector_from
from cagepose.kernels.boundary.circle import circle_of, is_on_arc
from cagepose.kernels.boundary.circle_meeting import common_at, is_core, write_place_on
from cagepose.kernels.boundary.extents import extent_of, surely_apart
from cagepose.kernels.boundary.features import (
    CIRCLE,
    FACE,
    LINE,
    VERTEX,
    Feature,
    PlacedBoundary,
    box_of,
    in_body,
    number_of_bodies,
    place_boundary,
    place_feature,
    position_of,
)
from cagepose.kernels.boundary.geometry import Geometry, Placement, cage_at, held_at
from cagepose.kernels.boundary.meeting import between_cores, both_reach, meeting, seated
from cagepose.kernels.boundary.meetings import EQUALLY_FAR, find_circle_places, slack_of
from cagepose.kernels.boundary.met import CENTRED, Meeting, swapped
from cagepose.kernels.boundary.surfaces import crossing, has_surface, most_crossings
from cagepose.kernels.boundary.tapered import nearest_on_axis
from cagepose.kernels.boundary.touching import MOST_PAIRS, MOST_PLACES
from cagepose.kernels.boundary.tree import EDGES, FACES, SAFE, VERTICES, Node, boxes_apart
from cagepose.kernels.boundary.within import root_has_surfaces
from cagepose.kernels.circles.beside_circle import places_by_circle
from cagepose.kernels.circles.places import SADDLE, WHOLE, Place
from cagepose.kernels.native.interrupt import heed_interrupt
from cagepose.kernels.native.kernel import entry, kernel

MOST_ASKED, MOST_FOR_NARROWEST = 1_000_000, 20_000_000
"""Pairs of features, or of boxes around them, that one search asks: of bodies of thousands of triangles this takes some
0.05 s; and twenty times that for the narrowest gap alone."""
PLACES_OF_WHOLE = 4
"""Of a circle that is equally far all around, which stand for it."""
SLACK_OF_TOUCH = 2.0
"""A foot may be so many touch tolerances beyond the end of a feature, as in `meetings`."""


class Gap:
    """Two places that are nearest to each other; a record.

    Attributes
    ----------
    part, cage_part
        What they are of, by the numbers of the parts of each body.
    gap
        How far they are apart, metres.
    place, cage_place
        In the world, metres.
    """

    part: int
    cage_part: int
    gap: float
    place: Annotated[FloatArray, 3]
    cage_place: Annotated[FloatArray, 3]


class GapWork(NamedTuple):
    """Memory for a search: the gaps that are found; how many there are, -1: too many, and how many pairs may still be
    asked, (2,); how far it looks, (1,), metres; pairs of nodes and nodes that wait; and the places of one circle.
    """

    rows: Rows[Gap]
    used: IntArray
    within: FloatArray
    pairs: IntArray
    waiting: IntArray
    places: Rows[Place]


def empty_gap_work(n_rows: int) -> GapWork:
    """Return memory for so many gaps (plain Python)."""
    pairs, waiting = np.zeros((MOST_PAIRS, 2), np.int64), np.zeros(MOST_PAIRS, np.int64)
    rows, places = empty_rows(Gap, n_rows), empty_rows(Place, MOST_PLACES)
    return GapWork(rows, np.zeros(2, np.int64), np.zeros(1), pairs, waiting, places)


@entry
def find_gaps(
    geometry: Geometry,
    position: Vector,
    quaternion: tuple[float, float, float, float],
    within_m: float,
    narrowest: bool,
    placement: Placement,
    work: GapWork,
) -> int:
    """Find the gaps of the object, at a pose, from the cage that are wider than what touches, up to a length; or the
    narrowest of these alone.

    Returns
    -------
    int
        How many there are; -1: more than there is memory for, or than can be found in short.
    """
    heed_interrupt()
    held = held_at(geometry, placement)
    place_boundary(held, position, quaternion)
    work.used[0], work.used[1] = 0, MOST_FOR_NARROWEST if narrowest else MOST_ASKED
    work.within[0] = within_m
    for body in range(number_of_bodies(geometry.cage)):
        cage = cage_at(geometry, body)
        for own in range(3):
            for other in range(3):
                if work.used[0] >= 0 and may_have_gaps(own, held.own.nodes[own], other, cage.own.nodes[other]):
                    descend(geometry, held, own, cage, other, narrowest, work)
    return int(work.used[0])


@kernel
def may_have_gaps(root: int, one: Node, other_root: int, other: Node) -> bool:
    """Whether features of two trees can have a gap: a face with vertices and circles alone."""
    if root == FACES:
        return other_root == VERTICES or (other_root == EDGES and other.has_circles)
    return other_root != FACES or root == VERTICES or one.has_circles


@kernel
def ask_one_more(work: GapWork) -> bool:
    """Count a pair; False: there are too many."""
    work.used[1] -= 1
    if work.used[1] < 0:
        work.used[0] = -1
    return bool(work.used[0] >= 0)


@kernel
def descend(
    geometry: Geometry, held: PlacedBoundary, own: int, cage: PlacedBoundary, other: int, narrowest: bool, work: GapWork
) -> None:
    """Append the gaps of features below a node of each body's trees."""
    work.pairs[0, 0], work.pairs[0, 1] = own, other
    n_waiting = 1
    while n_waiting > 0 and ask_one_more(work):
        n_waiting -= 1
        at, cage_at_ = work.pairs[n_waiting, 0], work.pairs[n_waiting, 1]
        one, two = held.own.nodes[at], cage.own.nodes[cage_at_]
        if one.first == one.last or two.first == two.last:
            continue
        box, cage_box = box_of(held, at), box_of(cage, cage_at_)
        if boxes_apart(box, cage_box) > work.within[0]:
            continue
        if one.left < 0 and two.left < 0:
            for i in range(one.first, one.last):
                place_feature(held, i)
                for j in range(two.first, two.last):
                    if not ask_one_more(work):
                        return
                    place_feature(cage, j)
                    add_gaps(geometry, held, i, cage, j, narrowest, work)
            continue
        divides_held = two.left < 0 or (one.left >= 0 and max(box.half) >= max(cage_box.half))
        left, right = (one.left, one.right) if divides_held else (two.left, two.right)
        if divides_held:
            is_left_near = boxes_apart(box_of(held, left), cage_box) < boxes_apart(box_of(held, right), cage_box)
        else:
            is_left_near = boxes_apart(box, box_of(cage, left)) < boxes_apart(box, box_of(cage, right))
        for side in range(2):  # the nearer one is asked first
            child = left if (side == 1) == is_left_near else right
            work.pairs[n_waiting, 0] = child if divides_held else at
            work.pairs[n_waiting, 1] = cage_at_ if divides_held else child
            n_waiting += 1


@kernel
def add_gaps(
    geometry: Geometry, held: PlacedBoundary, i: int, cage: PlacedBoundary, j: int, narrowest: bool, work: GapWork
) -> None:
    """Append the gaps of two features."""
    one, other = held.features[i], cage.features[j]
    if surely_apart(one, extent_of(one), other) > work.within[0]:
        return
    if narrowest and one.kind == VERTEX and other.kind == VERTEX:  # no gap is wider than these are apart
        apart_m = norm(minus(vector_from(one.point), vector_from(other.point)))
        work.within[0] = min(work.within[0], SAFE * max(apart_m, geometry.touch_m))
    if one.kind != CIRCLE and other.kind != CIRCLE:
        add_gap(geometry, held, i, cage, j, straight_gap(held, i, cage, j), narrowest, work)
        return
    circle = one if one.kind == CIRCLE else other
    if one.kind == CIRCLE and other.kind == CIRCLE:  # in a hole, the far side of its mouth counts, too
        flat_m = EQUALLY_FAR * geometry.touch_m
        n_places = places_by_circle(circle_of(one), circle_of(other), flat_m, work.places)
    else:
        n_places = find_circle_places(one, other, geometry.touch_m, work.places)
    if n_places == WHOLE:
        for k in range(PLACES_OF_WHOLE):
            angle = circle.start + circle.width * k / PLACES_OF_WHOLE
            write_place_on(one, other, angle, work.places[k])
        n_places = PLACES_OF_WHOLE
    for k in range(n_places):
        place = work.places[k]
        if place.kind != SADDLE and is_on_arc(circle, place.angle, SLACK_OF_TOUCH * geometry.touch_m):
            met = circle_gap(held, i, cage, j, place)
            add_gap(geometry, held, i, cage, j, met, narrowest, work)


@kernel
def is_centred(vertex: Feature, wall: Feature) -> bool:
    """Whether a vertex is on the axis of a straight wall around it, and so has no one nearest place of it."""
    if vertex.kind != VERTEX or wall.kind != LINE or wall.radius >= 0.0 or wall.taper != 0.0:
        return False
    center = vector_from(vertex.point)
    return norm(minus(nearest_on_axis(wall, center).place, center)) <= CENTRED * max(vertex.radius, -wall.radius)


@kernel
def straight_gap(held: PlacedBoundary, i: int, cage: PlacedBoundary, j: int) -> Meeting:
    """Return where two features, none of which is a circle, are nearest to each other."""
    one, other = held.features[i], cage.features[j]
    if is_centred(one, other):
        return seated(one, other, 0.0)
    if is_centred(other, one):
        return swapped(seated(other, one, 0.0))
    if one.kind == FACE or other.kind == FACE or one.radius + other.radius != 0.0:
        return meeting(held, i, cage, j)
    if one.kind == LINE and other.kind == LINE:
        return meeting(held, i, cage, j)
    if one.kind == VERTEX and other.kind == VERTEX:
        return between_cores(vector_from(one.point), 0.0, vector_from(other.point), 0.0, 1.0)
    if one.kind == VERTEX:
        foot = nearest_on_axis(other, vector_from(one.point)).place
        return between_cores(vector_from(one.point), 0.0, foot, 0.0, 1.0)
    foot = nearest_on_axis(one, vector_from(other.point)).place
    return between_cores(foot, 0.0, vector_from(other.point), 0.0, 1.0)


@kernel
def circle_gap(held: PlacedBoundary, i: int, cage: PlacedBoundary, j: int, place: Place) -> Meeting:
    """Return where two features, one of which is a circle, are nearest to each other at a place of it."""
    if held.features[i].kind != CIRCLE:
        return swapped(gap_of_circle(cage, j, held, i, place))
    return gap_of_circle(held, i, cage, j, place)


@kernel
def gap_of_circle(a: PlacedBoundary, i: int, b: PlacedBoundary, j: int, place: Place) -> Meeting:
    """As `circle_gap`, of a circle of the first body."""
    circle, other = a.features[i], b.features[j]
    common = common_at(circle, other, place)
    radius = other.radius if is_core(circle, other) else 0.0
    if other.kind == FACE or radius != other.radius:
        start = plus(common.point, scaled(common.normal, circle.radius))
        return Meeting(True, common.gap - circle.radius - radius, common.normal, start)
    return between_cores(common.point, circle.radius, common.other_point, radius, 1.0)


@kernel
def add_gap(
    geometry: Geometry,
    held: PlacedBoundary,
    i: int,
    cage: PlacedBoundary,
    j: int,
    met: Meeting,
    narrowest: bool,
    work: GapWork,
) -> None:
    """Append a gap if it is one: both features reach there, and nothing is between them."""
    touch_m = geometry.touch_m
    if not met.is_one or not touch_m < met.gap <= work.within[0]:
        return
    slack = slack_of(held.own.features[i], cage.own.features[j], touch_m)
    if not both_reach(held, i, cage, j, met, slack, SLACK_OF_TOUCH * touch_m):
        return
    if is_between(held, met, touch_m, work.waiting):
        return
    for body in range(number_of_bodies(geometry.cage)):
        if is_between(cage_at(geometry, body), met, touch_m, work.waiting):
            return
    if narrowest:
        work.used[0], work.within[0] = 0, met.gap
    at = work.used[0]
    if at == len(work.rows):
        work.used[0] = -1
        return
    row, other = work.rows[at], plus(met.place, scaled(met.normal, met.gap))
    row.part, row.cage_part = held.own.features[i].part, cage.own.features[j].part
    row.gap = met.gap
    for k in range(3):
        row.place[k], row.cage_place[k] = met.place[k], other[k]
    work.used[0] = at + 1


@kernel
def is_between(body: PlacedBoundary, met: Meeting, touch_m: float, waiting: IntArray) -> bool:
    """Whether a surface of a body is crossed on the way from one end of a gap to the other."""
    own = body.own
    start, way = in_body(body, minus(met.place, position_of(body))), in_body(body, met.normal)
    half = scaled(way, 0.5 * met.gap)
    middle = plus(start, half)
    for root in range(3):
        if not root_has_surfaces(own, root):
            continue
        waiting[0], n_waiting = root, 1
        while n_waiting > 0:
            n_waiting -= 1
            node = own.nodes[waiting[n_waiting]]
            farthest = -math.inf
            for k in range(3):
                farthest = max(farthest, abs(middle[k] - node.middle[k]) - node.half[k] - abs(half[k]))
            if farthest > 0.0:
                continue
            if node.left >= 0:
                waiting[n_waiting], waiting[n_waiting + 1] = node.left, node.right
                n_waiting += 2
                continue
            for i in range(node.first, node.last):
                if not has_surface(own.features[i]):
                    continue
                for which in range(most_crossings(own.features[i])):
                    found = crossing(own, i, start, way, met.gap, 0.0, which)
                    if found.is_one and touch_m < found.along < met.gap - touch_m and found.beyond < -touch_m:
                        return True
    return False
