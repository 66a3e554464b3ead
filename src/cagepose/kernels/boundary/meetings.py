"""Where two boundaries touch at one pose."""

from __future__ import annotations

import math

from cagepose.kernels.algebra.record import FloatArray, Rows
from cagepose.kernels.algebra.vector import dot, minus, plus, row, scaled, times, vector_from
from cagepose.kernels.boundary.chart import is_trimmed
from cagepose.kernels.boundary.circle import WHOLE_TURN, circle_of, is_on_arc
from cagepose.kernels.boundary.circle_meeting import (
    circle_meeting,
    find_places,
    meet_all_around,
    round_of,
    write_place_on,
)
from cagepose.kernels.boundary.extents import extent_of, surely_apart
from cagepose.kernels.boundary.far_sides import drop_far_sides
from cagepose.kernels.boundary.features import (
    CIRCLE,
    FACE,
    LINE,
    VERTEX,
    Feature,
    PlacedBoundary,
    box_of,
    in_body,
    in_frame,
    place_feature,
    position_of,
    rotation_of,
)
from cagepose.kernels.boundary.flat_circle import Arc, next_arc, part_to_ask
from cagepose.kernels.boundary.meeting import both_reach, is_seated, meeting, seated, vertex_over_face
from cagepose.kernels.boundary.met import Meeting, swapped
from cagepose.kernels.boundary.neighbours import forget_layers
from cagepose.kernels.boundary.reach import beyond_normals
from cagepose.kernels.boundary.touching import AT_ONE_PLACE, HALF_SECTOR, SAME_PLACE, Along, Meetings
from cagepose.kernels.boundary.tree import FACES, VERTICES, Node, boxes_apart, may_touch
from cagepose.kernels.boundary.twins import append_meeting
from cagepose.kernels.boundary.within import OUTSIDE, depth_in, is_within, nearest_surface
from cagepose.kernels.circles.beside_circle import place_by_circle_near
from cagepose.kernels.circles.beside_round import place_by_round_near
from cagepose.kernels.circles.places import GREATEST, SADDLE, WHOLE, Place, write_place
from cagepose.kernels.native.kernel import kernel

DEEPEST_OF_LEAST = 0.05
"""Of the shortest edge, of a face or of two other features: what is deeper in each other is on far sides of a part, and
does not touch."""
BEYOND_OF_DEPTH = 4.0
"""What is so many times its depth beyond the border of a face may be in it: there is material behind a hollow edge."""
LEAST_SLACK, MOST_SLACK = 1e-9, 0.1
"""Sines that normals may be beyond those of a feature."""
PLACES_AROUND = 8
"""Of a circle that is equally far all around, which stand for it."""
FLAT, EQUALLY_FAR = 2.0, 0.5
"""In touch tolerances: by how much less the gap changes along a circle that lies flat on a face, or on a round side."""


@kernel
def can_touch(one: Feature, other: Feature) -> bool:
    """Whether features of these kinds can touch.

    A face does vertices and circles; a line does lines, unless one of them is the wall of a hole; a circle does lines
    and circles. A vertex does vertices, lines and circles if one of the two has a radius.
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
    forget_layers(found)
    for own in range(3):
        for other in range(3):
            if found.used[0] >= 0 and may_touch(own, held.own.nodes[own], other, cage.own.nodes[other]):
                descend(held, own, cage, other, touch_m, found)
    drop_far_sides(held.own, cage.own, touch_m, found)
    found.used[1] = found.used[0]


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
        if not held.is_placed[i]:
            place_feature(held, i)
        box = extent_of(held.features[i])
        for j in range(cage_first, cage_last):
            one, other = held.own.features[i], cage.own.features[j]
            if not can_touch(one, other):
                continue
            if not cage.is_placed[j]:
                place_feature(cage, j)
            if surely_apart(held.features[i], box, cage.features[j]) > farthest_listed(one, other, touch_m):
                continue
            if one.kind == CIRCLE or other.kind == CIRCLE:
                meet_circle(held, i, cage, j, touch_m, found)
                continue
            if is_seated(held.features[i], cage.features[j]) or is_seated(cage.features[j], held.features[i]):
                meet_seat(held, i, cage, j, touch_m, found)
                continue
            append_touching(held, i, cage, j, AT_ONE_PLACE, meeting(held, i, cage, j), touch_m, found)


@kernel
def farthest_listed(one: Feature, other: Feature, touch_m: float) -> float:
    """Return a length that features which touch are no farther apart; or, of sharp edges that are deep in each other,
    which are as far apart, no deeper.
    """
    is_sharp = one.radius == 0.0 and other.radius == 0.0 and one.kind != FACE and other.kind != FACE
    return max(4.0 * touch_m, DEEPEST_OF_LEAST * min(one.least, other.least) if is_sharp else 0.0)


@kernel
def find_beyond(
    vertex: Feature, pose: FloatArray, planes: FloatArray, first: int, last: int, touch_m: float, out: FloatArray
) -> int:
    """Write how far a vertex of one body is from touching some faces of another one, with its pose and its planes:
    above these, so deep below that it is on their far side, or beside the boxes around the faces; at most zero: it may
    touch. Return of how many.
    """
    x, y, z = in_frame(pose, minus(vector_from(vertex.point), row(pose, 0)))
    radius = vertex.radius
    n, m, k, above = planes[0, first:last], planes[1, first:last], planes[2, first:last], planes[3, first:last]
    least, here = planes[4, first:last], out[first:last]  # slices from zero on, so that several are worked out at once
    lows = planes[5, first:last], planes[6, first:last], planes[7, first:last]
    highs = planes[8, first:last], planes[9, first:last], planes[10, first:last]
    n_near = 0
    for j in range(len(here)):
        height = n[j] * x + m[j] * y + k[j] * z - above[j] - radius
        beside = max(lows[0][j] - x, x - highs[0][j], lows[1][j] - y, y - highs[1][j], lows[2][j] - z, z - highs[2][j])
        beside -= radius + 4.0 * touch_m + (1.0 + BEYOND_OF_DEPTH) * max(-height, 0.0)
        here[j] = max(height - touch_m, -height - DEEPEST_OF_LEAST * least[j], beside)
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
        if not vertices.is_placed[i]:
            place_feature(vertices, i)
        vertex = vertices.features[i]
        if find_beyond(vertex, faces.pose, faces.own.planes, other.first, other.last, touch_m, found.heights) == 0:
            continue
        for j in range(other.first, other.last):
            if found.heights[j] <= 0.0:
                if not faces.is_placed[j]:
                    place_feature(faces, j)
                met = vertex_over_face(vertex, faces.features[j])
                if met.gap > touch_m:
                    continue
                held, cage = (faces, vertices) if of_cage else (vertices, faces)
                at, cage_at = (j, i) if of_cage else (i, j)
                met = swapped(met) if of_cage else met
                append_touching(held, at, cage, cage_at, AT_ONE_PLACE, met, touch_m, found)


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
    if n_places == WHOLE and meet_all_around(one, other):
        for k in range(PLACES_AROUND):
            write_place_on(one, other, math.pi * (2 * k + 1) / PLACES_AROUND, places[k])
    return n_places


@kernel
def find_places_near(one: Feature, other: Feature, angle: float, touch_m: float, places: Rows[Place]) -> int:
    """As `find_circle_places`, but the place that is nearest to an angle alone, if that is told without the others."""
    circle, beside = (one, other) if one.kind == CIRCLE else (other, one)
    if one.kind == CIRCLE and other.kind == CIRCLE:
        return place_by_circle_near(circle_of(one), circle_of(other), angle, EQUALLY_FAR * touch_m, places)
    if circle.kind != CIRCLE or beside.kind != LINE:
        return find_circle_places(one, other, touch_m, places)
    return place_by_round_near(circle_of(circle), round_of(beside), angle, EQUALLY_FAR * touch_m, places)


@kernel
def meet_circle(held: PlacedBoundary, i: int, cage: PlacedBoundary, j: int, touch_m: float, found: Meetings) -> None:
    """Append the meetings of two features, of which one is a circle."""
    one, other = held.features[i], cage.features[j]
    circle = one if one.kind == CIRCLE else other
    n_places = find_circle_places(one, other, touch_m, found.places)
    if n_places == WHOLE:
        if one.kind == FACE or other.kind == FACE:
            meet_flat(held, i, cage, j, touch_m, found)
        elif meet_all_around(one, other):
            meet_around(held, i, cage, j, touch_m, found)
        return
    for k in range(n_places):
        place = found.places[k]
        if place.kind in (GREATEST, SADDLE) or not is_on_arc(circle, place.angle, 2.0 * touch_m):
            continue
        met = meeting_at(held, i, cage, j, place)
        append_touching(held, i, cage, j, Along(place.angle, 0.0, 0.0), met, touch_m, found)


@kernel
def meet_around(held: PlacedBoundary, i: int, cage: PlacedBoundary, j: int, touch_m: float, found: Meetings) -> None:
    """Append the meetings of a circle and of what all of it lies on; of a side with borders, those of some places."""
    circle = held.features[i] if held.features[i].kind == CIRCLE else cage.features[j]
    ends_anywhere = is_trimmed(held.own, i) or is_trimmed(cage.own, j)
    if cage.features[j].kind == CIRCLE and cage.features[j].width < WHOLE_TURN:  # of two circles either may end
        ends_anywhere = ends_anywhere or held.features[i].kind == CIRCLE
    if circle.width < WHOLE_TURN and not ends_anywhere:
        append_arc(held, i, cage, j, Arc(circle.start, circle.start + circle.width), circle.length, touch_m, found)
        return
    half = 0.0 if ends_anywhere else HALF_SECTOR
    for k in range(PLACES_AROUND):
        angle = circle.start + circle.width * (k + 0.5) / PLACES_AROUND
        append_along(held, i, cage, j, Along(angle, half, half), touch_m, found)


@kernel
def append_along(
    held: PlacedBoundary, i: int, cage: PlacedBoundary, j: int, along: Along, touch_m: float, found: Meetings
) -> None:
    """Append the meeting of a circle at one of its places, if it touches there."""
    place = found.places[0]
    write_place_on(held.features[i], cage.features[j], along.angle, place)
    there = Along(place.angle, along.before, along.after)
    append_touching(held, i, cage, j, there, meeting_at(held, i, cage, j, place), touch_m, found)


@kernel
def meet_flat(held: PlacedBoundary, i: int, cage: PlacedBoundary, j: int, touch_m: float, found: Meetings) -> None:
    """Append the meetings of a circle that lies flat on a face: of each arc over the face both ends, and places between
    them that are no farther apart than `HALF_SECTOR`.
    """
    of_cage = held.features[i].kind == FACE
    circle, body, at = (cage.features[j], held, i) if of_cage else (held.features[i], cage, j)
    face, slack_m = body.features[at], 2.0 * touch_m
    height = dot(vector_from(face.direction), minus(vector_from(circle.point), vector_from(face.point)))
    if height - face.radius - circle.radius > (1.0 + FLAT) * touch_m:
        return
    part = part_to_ask(circle, body, at, slack_m)
    if part.last - part.first >= WHOLE_TURN:
        meet_around(held, i, cage, j, touch_m, found)
        return
    begin, counts = part.first, True
    while begin <= part.last < math.inf:
        arc = next_arc(circle, body, at, begin, part.last, counts, slack_m)
        if arc.first == math.inf:
            return
        append_arc(held, i, cage, j, arc, circle.length, touch_m, found)
        begin, counts = arc.last, False


@kernel
def append_arc(
    held: PlacedBoundary,
    i: int,
    cage: PlacedBoundary,
    j: int,
    arc: Arc,
    radius: float,
    touch_m: float,
    found: Meetings,
) -> None:
    """Append the meetings of an arc that touches all along; one that is straight to the slack is one place, as where a
    circle leads over an edge that has its tangent. Others have a place between their ends, as edges may cross there.
    """
    span = arc.last - arc.first
    if span < math.pi and radius * (1.0 - math.cos(0.5 * span)) <= 2.0 * touch_m:
        append_along(held, i, cage, j, Along(arc.first + 0.5 * span, 0.5 * span, 0.5 * span), touch_m, found)
        return
    n_between = max(math.ceil(span / HALF_SECTOR - LEAST_SLACK), 2)
    for k in range(n_between + 1):
        before = span * k / n_between
        ends = min(before, HALF_SECTOR), min(span - before, HALF_SECTOR)
        append_along(held, i, cage, j, Along(arc.first + before, ends[0], ends[1]), touch_m, found)


@kernel
def meet_seat(held: PlacedBoundary, i: int, cage: PlacedBoundary, j: int, touch_m: float, found: Meetings) -> None:
    """Append the meetings of a ball and of the slanted wall of a hole that it is in the middle of."""
    one, other = held.features[i], cage.features[j]
    for k in range(PLACES_AROUND):
        angle = math.pi * (2 * k + 1) / PLACES_AROUND
        met = seated(one, other, angle) if one.kind == VERTEX else swapped(seated(other, one, angle))
        append_touching(held, i, cage, j, Along(angle, HALF_SECTOR, HALF_SECTOR), met, touch_m, found)


@kernel
def append_touching(
    held: PlacedBoundary,
    i: int,
    cage: PlacedBoundary,
    j: int,
    along: Along,
    met: Meeting,
    touch_m: float,
    found: Meetings,
) -> None:
    """Append a meeting, if two features touch there: they are near, not on far sides of a part, and both reach. What is
    deep in a face is in its body, with no other surface nearer; of other features that are, it is well within them, and
    if they are sharp, in one of the bodies: a thin plate is as far beyond the far edges of another one beside it.
    """
    one, other = held.own.features[i], cage.own.features[j]
    if not met.is_one or met.gap > touch_m:
        return
    slack, face = slack_of(one, other, touch_m), one if one.kind == FACE else other
    if met.gap >= -touch_m:
        is_point = one.kind == VERTEX or other.kind == VERTEX
        touches = both_reach(held, i, cage, j, met, slack, touch_m if is_point else 2.0 * touch_m)
    elif face.kind == FACE:
        reach_m = 2.0 * touch_m - BEYOND_OF_DEPTH * met.gap
        touches = met.gap >= -DEEPEST_OF_LEAST * face.least and both_reach(held, i, cage, j, met, slack, reach_m)
        touches = touches and is_nearest(held, i, cage, j, met, touch_m, found)
    else:
        deepest = DEEPEST_OF_LEAST * min(one.least, other.least)
        touches = met.gap >= -deepest and both_reach(held, i, cage, j, met, slack, -touch_m)
        is_sharp = one.radius == 0.0 and other.radius == 0.0
        touches = touches and (not is_sharp or is_in_either(held, cage, met, touch_m, found))
    if touches:
        append_meeting(held, i, cage, j, along, met, touch_m, found)


@kernel
def is_in_either(held: PlacedBoundary, cage: PlacedBoundary, met: Meeting, touch_m: float, found: Meetings) -> bool:
    """Whether, of two features that are deep in each other, the place of one of them is in the body of the other, or on
    it.
    """
    seen = in_body(cage, minus(met.place, position_of(cage)))
    if depth_in(cage.own, seen, touch_m, found.waiting).distance != OUTSIDE:
        return True
    opposite = plus(met.place, scaled(met.normal, met.gap))
    seen = in_body(held, minus(opposite, position_of(held)))
    return depth_in(held.own, seen, touch_m, found.waiting).distance != OUTSIDE


@kernel
def is_nearest(
    held: PlacedBoundary, i: int, cage: PlacedBoundary, j: int, met: Meeting, touch_m: float, found: Meetings
) -> bool:
    """Whether what is deep in a face is in its body, and no other surface of that is nearer. A face that it cannot
    lie on, as it has no such normal, does not count: a corner that is in a wall below its upper edge comes out of the
    wall.
    """
    if held.own.features[i].kind == FACE:
        body, deep, at, place = held, cage, j, plus(met.place, scaled(met.normal, met.gap))
    else:
        body, deep, at, place = cage, held, i, met.place
    within = in_body(body, minus(place, position_of(body)))
    nearer = nearest_surface(body.own, within, -met.gap - touch_m, found.waiting).feature
    if nearer >= 0:
        face = body.own.features[nearer]
        back = scaled(times(rotation_of(body), vector_from(face.direction)), -1.0)
        slack = slack_of(face, deep.own.features[at], touch_m)
        if face.kind != FACE or beyond_normals(deep, at, back, place) <= slack:
            return False
    return is_within(body.own, within, touch_m, found.waiting)
