"""Where two boundaries touch at one pose."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np

from cagepose.kernels.algebra.record import FloatArray, IntArray, Rows, empty_rows
from cagepose.kernels.algebra.vector import minus, norm, vector_from
from cagepose.kernels.boundary.circle import is_on_arc
from cagepose.kernels.boundary.circle_meeting import circle_meeting, find_places
from cagepose.kernels.boundary.circle_places import GREATEST, SADDLE, WHOLE, Kept, Place, write_place
from cagepose.kernels.boundary.features import (
    CIRCLE,
    FACE,
    LINE,
    VERTEX,
    Feature,
    PlacedBoundary,
    box_of,
    in_body,
    place_feature,
    position_of,
)
from cagepose.kernels.boundary.meeting import both_reach, is_seated, meeting, seated
from cagepose.kernels.boundary.tree import FACES, VERTICES, Node, boxes_apart, may_touch
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.shapes.meeting import SAME_PLACE, Meeting, swapped
from cagepose.kernels.shapes.touching import SAME_NORMAL

DEEPEST_OF_LEAST = 0.05
"""Of the shortest edge: features that are deeper in each other are on far sides of a part, and do not touch."""
LEAST_SLACK, MOST_SLACK = 1e-9, 0.1
"""Sines that normals may be beyond those of a feature."""
MOST_MEETINGS, MOST_PAIRS, MOST_PLACES = 4096, 256, 16
"""Meetings that there is memory for; pairs of nodes that wait while two trees are descended; places of one circle."""
PLACES_AROUND = 8
"""Of a circle that is equally far all around, which stand for it."""
FLAT, EQUALLY_FAR = 2.0, 0.5
"""In touch tolerances: by how much less the gap changes along a circle that lies flat on a face, or on a round side."""


class Touching:
    """Two features that touch; a record.

    Attributes
    ----------
    feature, cage_feature
        Indices.
    angle
        Where on a circle, if one of them is one, radians; of two, on the object's.
    is_around
        Whether all of the circle is equally far there, to the touch tolerance, and this is one of the places that stand
        for it.
    gap, normal, place
        As in `Meeting`.
    group
        Index of the first row that it is an alternative to: the object is out of the cage there if it is along one of
        the normals of a group. A row that is the first of its group has its own.
    """

    feature: int
    cage_feature: int
    angle: float
    is_around: bool
    gap: float
    normal: Annotated[FloatArray, 3]
    place: Annotated[FloatArray, 3]
    group: int


class Meetings(NamedTuple):
    """What touches at one pose.

    Attributes
    ----------
    used
        How many rows count, (1,); -1: there are more than there is memory for.
    rows
        One for each meeting.
    pairs
        Memory for pairs of nodes, (MOST_PAIRS, 2).
    places, kept
        Memory for the places of a circle, and for those of them that touch.
    heights
        Memory for how far a vertex is above faces, (n_features,) of the body that has more, metres.
    """

    used: IntArray
    rows: Rows[Touching]
    pairs: IntArray
    places: Rows[Place]
    kept: Rows[Kept]
    heights: FloatArray


def empty_meetings(n_features: int) -> Meetings:
    """Return memory for the meetings of two boundaries, of which none has more features (plain Python)."""
    pairs, places = np.zeros((MOST_PAIRS, 2), np.int64), empty_rows(Place, MOST_PLACES)
    return Meetings(
        np.zeros(1, np.int64),
        empty_rows(Touching, MOST_MEETINGS),
        pairs,
        places,
        empty_rows(Kept, MOST_PLACES),
        np.zeros(n_features),
    )


@kernel
def can_touch(one: Feature, other: Feature) -> bool:
    """Whether features of these kinds can touch: a face meets vertices and circles, two lines cross, and what has a
    radius meets all but faces of the same kind.
    """
    if one.kind == FACE or other.kind == FACE:
        return one.kind in (VERTEX, CIRCLE) or other.kind in (VERTEX, CIRCLE)
    if one.kind == LINE and other.kind == LINE:
        return min(one.radius, other.radius) >= 0.0
    if one.kind == CIRCLE or other.kind == CIRCLE:
        return (one.kind in (LINE, CIRCLE) and other.kind in (LINE, CIRCLE)) or one.radius + other.radius != 0.0
    return one.radius + other.radius != 0.0


@kernel
def slack_of(one: Feature, other: Feature, touch_m: float) -> float:
    """Return the sine by which what touches all along the shortest edge of two features may be tilted."""
    return min(MOST_SLACK, max(LEAST_SLACK, SAME_PLACE * touch_m / min(one.least, other.least)))


@kernel
def find_meetings(held: PlacedBoundary, cage: PlacedBoundary, touch_m: float, found: Meetings) -> None:
    """Find all meetings of two bodies at their poses; see `groups` for which are alternatives."""
    found.used[0] = 0
    for own in range(3):
        for other in range(3):
            if found.used[0] >= 0 and may_touch(own, held.own.nodes[own], other, cage.own.nodes[other]):
                descend(held, own, cage, other, touch_m, found)


@kernel
def descend(held: PlacedBoundary, own: int, cage: PlacedBoundary, other: int, touch_m: float, found: Meetings) -> None:
    """Append the meetings of features below a node of each body's trees."""
    found.pairs[0, 0], found.pairs[0, 1] = own, other
    n_waiting = 1
    while n_waiting > 0:
        n_waiting -= 1
        one, two = held.own.nodes[found.pairs[n_waiting, 0]], cage.own.nodes[found.pairs[n_waiting, 1]]
        if one.first == one.last or two.first == two.last:
            continue
        at, cage_at = found.pairs[n_waiting, 0], found.pairs[n_waiting, 1]
        box, cage_box = box_of(held, at), box_of(cage, cage_at)
        if boxes_apart(box, cage_box) > touch_m:
            continue
        if one.left < 0 and two.left < 0:
            if own == FACES and other == VERTICES:
                meet_vertices(cage, two, held, one, True, touch_m, found)
            elif own == VERTICES and other == FACES:
                meet_vertices(held, one, cage, two, False, touch_m, found)
            else:
                meet_leaves(held, one.first, one.last, cage, two.first, two.last, touch_m, found)
            if found.used[0] < 0:
                return
            continue
        divides_held = two.left < 0 or (one.left >= 0 and max(box.half) >= max(cage_box.half))
        for side in range(2):  # of the larger one, if it has two
            left, right = (one.left, one.right) if divides_held else (two.left, two.right)
            child = left if side == 0 else right
            found.pairs[n_waiting, 0] = child if divides_held else at
            found.pairs[n_waiting, 1] = cage_at if divides_held else child
            n_waiting += 1


@kernel
def meet_leaves(
    held: PlacedBoundary,
    first: int,
    last: int,
    cage: PlacedBoundary,
    cage_first: int,
    cage_last: int,
    touch_m: float,
    found: Meetings,
) -> None:
    """Append the meetings of two ranges of features."""
    for i in range(first, last):
        for j in range(cage_first, cage_last):
            one, other = held.own.features[i], cage.own.features[j]
            if not can_touch(one, other):
                continue
            place_feature(held, i)
            place_feature(cage, j)
            if one.kind == CIRCLE or other.kind == CIRCLE:
                meet_circle(held, i, cage, j, touch_m, found)
                continue
            if is_seated(held.features[i], cage.features[j]) or is_seated(cage.features[j], held.features[i]):
                meet_seat(held, i, cage, j, touch_m, found)
                continue
            append_touching(held, i, cage, j, 0.0, False, meeting(held, i, cage, j), touch_m, found)


@kernel
def find_beyond(
    vertices: PlacedBoundary, i: int, faces: PlacedBoundary, first: int, last: int, touch_m: float, out: FloatArray
) -> int:
    """Write how far a vertex of one body is from touching the planes of some faces of another one: above them, or so
    deep below that it is on their far side; at most zero: it may touch. Return of how many.
    """
    place_feature(vertices, i)
    vertex, planes = vertices.features[i], faces.own.planes
    x, y, z = in_body(faces, minus(vector_from(vertex.point), position_of(faces)))
    radius, deepest = vertex.radius, DEEPEST_OF_LEAST * vertex.least
    n, m, k, above = planes[0, first:last], planes[1, first:last], planes[2, first:last], planes[3, first:last]
    least, here = planes[4, first:last], out[first:last]  # slices from zero on, so that several are worked out at once
    n_near = 0
    for j in range(len(here)):
        height = n[j] * x + m[j] * y + k[j] * z - above[j] - radius
        here[j] = max(height - touch_m, -height - min(DEEPEST_OF_LEAST * least[j], deepest))
        n_near += here[j] <= 0.0
    return n_near


@kernel
def meet_vertices(
    vertices: PlacedBoundary,
    one: Node,
    faces: PlacedBoundary,
    other: Node,
    of_cage: bool,
    touch_m: float,
    found: Meetings,
) -> None:
    """Append the meetings of the vertices of a leaf, which are those of the cage or of the object, with some faces."""
    for i in range(one.first, one.last):
        if find_beyond(vertices, i, faces, other.first, other.last, touch_m, found.heights) == 0:
            continue
        for j in range(other.first, other.last):
            if found.heights[j] <= 0.0:
                place_feature(faces, j)
                held, cage = (faces, vertices) if of_cage else (vertices, faces)
                at, cage_at = (j, i) if of_cage else (i, j)
                met = meeting(held, at, cage, cage_at)
                append_touching(held, at, cage, cage_at, 0.0, False, met, touch_m, found)


@kernel
def meeting_at(held: PlacedBoundary, i: int, cage: PlacedBoundary, j: int, place: Place) -> Meeting:
    """Return how two features meet; of a circle, at a place of it; of two, of the object's."""
    if held.features[i].kind != CIRCLE and cage.features[j].kind != CIRCLE:
        return meeting(held, i, cage, j)
    if held.features[i].kind == CIRCLE:
        return circle_meeting(held, i, cage, j, place)
    return swapped(circle_meeting(cage, j, held, i, place))


@kernel
def find_circle_places(one: Feature, other: Feature, touch_m: float, places: Rows[Place]) -> int:
    """Write the places where two features may touch; return how many there are, `WHOLE`: those that stand for all of a
    circle are written. Without a circle there is one.
    """
    if one.kind != CIRCLE and other.kind != CIRCLE:
        write_place(places[0], 0.0, 0.0, 0, True)
        return 1
    circle, beside = (one, other) if one.kind == CIRCLE else (other, one)
    n_places = find_places(circle, beside, (FLAT if beside.kind == FACE else EQUALLY_FAR) * touch_m, places)
    if n_places == WHOLE and beside.kind != CIRCLE:
        for k in range(PLACES_AROUND):
            write_place(places[k], math.pi * (2 * k + 1) / PLACES_AROUND, 0.0, 0, True)
    return n_places


@kernel
def meet_circle(held: PlacedBoundary, i: int, cage: PlacedBoundary, j: int, touch_m: float, found: Meetings) -> None:
    """Append the meetings of two features, of which one is a circle."""
    one, other = held.features[i], cage.features[j]
    circle = one if one.kind == CIRCLE else other
    n_places = find_circle_places(one, other, touch_m, found.places)
    is_around = n_places == WHOLE
    if is_around and one.kind == CIRCLE and other.kind == CIRCLE:
        return
    for k in range(PLACES_AROUND if is_around else n_places):
        place = found.places[k]
        if place.kind in (GREATEST, SADDLE) or not is_on_arc(circle, place.angle, 2.0 * touch_m):
            continue
        met = meeting_at(held, i, cage, j, place)
        append_touching(held, i, cage, j, place.angle, is_around, met, touch_m, found)


@kernel
def meet_seat(held: PlacedBoundary, i: int, cage: PlacedBoundary, j: int, touch_m: float, found: Meetings) -> None:
    """Append the meetings of a ball and of the slanted wall of a hole that it is in the middle of."""
    one, other = held.features[i], cage.features[j]
    for k in range(PLACES_AROUND):
        angle = math.pi * (2 * k + 1) / PLACES_AROUND
        met = seated(one, other, angle) if one.kind == VERTEX else swapped(seated(other, one, angle))
        append_touching(held, i, cage, j, angle, True, met, touch_m, found)


@kernel
def append_touching(
    held: PlacedBoundary,
    i: int,
    cage: PlacedBoundary,
    j: int,
    angle: float,
    is_around: bool,
    met: Meeting,
    touch_m: float,
    found: Meetings,
) -> None:
    """Append a meeting, if two features touch there: they are near, not on far sides of a part, and both reach."""
    one, other = held.own.features[i], cage.own.features[j]
    if not met.is_one or not -DEEPEST_OF_LEAST * min(one.least, other.least) <= met.gap <= touch_m:
        return
    if both_reach(held, i, cage, j, met, slack_of(one, other, touch_m), 2.0 * touch_m):
        append_meeting(i, j, angle, is_around, met, touch_m, found)


@kernel
def append_meeting(
    i: int, j: int, angle: float, is_around: bool, met: Meeting, touch_m: float, found: Meetings
) -> None:
    """Append a meeting, unless one with this normal is at this place."""
    at = found.used[0]
    if at == len(found.rows):
        found.used[0] = -1
        return
    row = found.rows[at]
    row.feature, row.cage_feature, row.angle, row.is_around = i, j, angle, is_around
    row.gap, row.group = met.gap, at
    for k in range(3):
        row.normal[k], row.place[k] = met.normal[k], met.place[k]
    for before in range(at):
        turned = norm(minus(vector_from(found.rows[before].normal), met.normal))
        if turned <= SAME_NORMAL and is_at_place(found, before, at, touch_m):
            return
    found.used[0] = at + 1


@kernel
def is_at_place(found: Meetings, one: int, other: int, touch_m: float) -> bool:
    """Whether two meetings are at one place."""
    between = minus(vector_from(found.rows[one].place), vector_from(found.rows[other].place))
    return norm(between) <= SAME_PLACE * touch_m
