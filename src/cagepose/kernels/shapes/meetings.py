"""Where the parts of two bodies touch at one pose, and how far apart they are otherwise.

Convex parts are apart if along one direction they are: the normal of a face, or that across two edges, which is an
outward normal of both. The greatest such distance is that of overlapping parts, below zero, and no more than that of
parts that are apart; there, features that reach where they meet are nearest, and tell it. Of parts with holes they tell
all: these may be within each other's hull, so that a feature on their far side is known by its depth alone.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.vector import (
    Vector,
    dot,
    minus,
    norm,
    plus,
    row,
    scaled,
    transposed_times,
    vector_from,
)
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.shapes.advancement import away_from_arc
from cagepose.kernels.shapes.along_motion import can_touch, is_near_part
from cagepose.kernels.shapes.body import PlacedBody, place_asked, rotation_of
from cagepose.kernels.shapes.covered import covers, is_in_parts, place_around
from cagepose.kernels.shapes.features import (
    FACE,
    HOLE,
    RIM,
    SOLID,
    VERTEX,
    Shapes,
    height_of_end,
    is_end,
)
from cagepose.kernels.shapes.meeting import (
    SAME_PLACE,
    Meeting,
    both_reach,
    common_normal,
    farthest_beyond,
    meeting,
    swapped,
    toward_vertex,
)
from cagepose.kernels.shapes.rims import lie_flat
from cagepose.kernels.shapes.side_by_side import (
    ends_at_edge,
    flush,
    has_flat_ends,
    lie_side_by_side,
)
from cagepose.kernels.shapes.touching import (
    Meetings,
    Touching,
    append_if_one,
    keep_nearest,
    note_twin,
    told_before,
    write_touching,
)

DEEPEST = 0.05
"""Fraction of the shortest edge or least radius. Features of parts with holes that are deeper in each other do not
touch."""


@kernel
def slack_of(a: Shapes, one: int, b: Shapes, other: int, touch_m: float) -> float:
    """Return the sine by which parts that touch all along their shortest edge may be tilted."""
    least = min(a.parts[one].least_length, b.parts[other].least_length)
    return min(0.1, max(1e-9, SAME_PLACE * touch_m / least))


@kernel
def balls_apart(a: Shapes, one: int, b: Shapes, other: int) -> float:
    """Return how far apart the balls around two parts are."""
    between = minus(vector_from(a.parts[one].middle), vector_from(b.parts[other].middle))
    return norm(between) - a.parts[one].reach - b.parts[other].reach


@kernel
def tells_apart(a: Shapes, i: int, b: Shapes, j: int, met: Meeting, slack: float) -> bool:
    """Whether two features are those of their parts that are farthest along the normal of their meeting."""
    one, other = a.features[i].kind, b.features[j].kind
    core = minus(met.place, scaled(met.normal, a.features[i].radius))
    there = plus(met.place, scaled(met.normal, met.gap + b.features[j].radius))
    if one != FACE and farthest_beyond(a, i, met.normal, core) > slack:
        return False
    return other == FACE or farthest_beyond(b, j, scaled(met.normal, -1.0), there) <= slack


@kernel
def apart_along(a: Shapes, one: int, b: Shapes, other: int, normal: Vector) -> float:
    """Return how far apart two parts are along an outward normal of the first; they are no nearer than that."""
    last, first, middle, back = -math.inf, math.inf, vector_from(a.parts[one].middle), scaled(normal, -1.0)
    for i in range(a.parts[one].first, a.parts[one].last):
        if is_end(a.features[i]):
            last = max(last, height_of_end(a.features[i], middle, normal))
    for j in range(b.parts[other].first, b.parts[other].last):
        if is_end(b.features[j]):
            first = min(first, -height_of_end(b.features[j], middle, back))
    return first - last


@kernel
def deepest_gap(a: Shapes, one: int, b: Shapes, other: int) -> float:
    """Return the gap below which features of parts with holes meet on their far sides; -inf: there are no holes."""
    if a.parts[one].kind == SOLID and b.parts[other].kind == SOLID:
        return -math.inf
    return -DEEPEST * min(a.parts[one].least_length, b.parts[other].least_length, a.parts[one].reach)


@kernel
def meet_parts(a: Shapes, one: int, b: Shapes, other: int, at_least_m: float, touch_m: float, found: Meetings) -> float:
    """Append the meetings of two parts; return how far apart they are at least, below zero how deep in each other (not
    of parts with holes: see `find_meetings`); NaN: there is no room.

    They are known to be ``at_least_m`` apart, metres.
    """
    slack, slack_m = slack_of(a, one, b, other, touch_m), 2.0 * touch_m
    first = found.used[0]
    separation, nearest, deepest = -math.inf, math.inf, deepest_gap(a, one, b, other)
    are_solid = deepest == -math.inf
    is_flat = has_flat_ends(a, one, b, other)
    within_m = max(touch_m, -deepest)
    for j in range(b.parts[other].first, b.parts[other].last):
        found.are_near[j] = is_near_part(b, j, a, one, within_m)
    for i in range(a.parts[one].first, a.parts[one].last):
        if not is_near_part(a, i, b, other, within_m):
            continue
        for j in range(b.parts[other].first, b.parts[other].last):
            if not found.are_near[j] or not can_touch(a, i, b, j):
                continue
            has_face = a.features[i].kind == FACE or b.features[j].kind == FACE  # of solids, it tells how far apart
            if not (are_solid and has_face) and away_from_arc(a, i, b, j) > touch_m:
                continue
            met = meeting(a, i, b, j)
            if not met.is_one or not (are_solid or deepest <= met.gap <= touch_m):
                continue
            if are_solid and tells_apart(a, i, b, j, met, slack):
                separation = max(separation, apart_along(a, one, b, other, met.normal))
            if not both_reach(a, i, b, j, met, slack, slack_m):
                continue
            if met.gap > touch_m:
                nearest = min(nearest, met.gap)
                continue
            least_gap = on_far_side(max(separation, at_least_m), touch_m) if are_solid else deepest
            if met.gap < least_gap or lie_flat(a.features[i], b.features[j], touch_m):
                continue
            beside = lie_side_by_side(a.features[i], b.features[j], met)
            if beside or (is_flat and ends_at_edge(a.features[i], b.features[j], met, touch_m)):
                nearest = min(nearest, met.gap)
                continue
            if found.used[0] == len(found.rows):
                found.used[0] = first
                return math.nan
            write_touching(one, other, i, j, met, found.rows[found.used[0]])
            told = told_before(found, first, touch_m)
            if told < 0:
                found.used[0] += 1
            else:
                note_twin(a, b, found.rows[told], found.rows[found.used[0]])
    if not are_solid:
        return max(at_least_m, 0.0)
    keep_nearest(found, first, on_far_side(max(separation, at_least_m), touch_m))
    for at in range(first, found.used[0]):
        add_flat_ends(a, one, b, other, at, slack, touch_m, found)
    for at in range(first, found.used[0]):
        nearest = min(nearest, found.rows[at].gap)
    if touch_m < nearest <= SAME_PLACE * touch_m and tip_is_at_rim(a, one, b, other, nearest):
        nearest = math.inf
    radii = a.features[a.parts[one].first].radius + b.features[b.parts[other].first].radius
    if (nearest == math.inf or touch_m < -separation - radii < math.inf) and max(separation, at_least_m) <= touch_m:
        separation = max(separation, apart_by_rims(a, one, b, other, slack, touch_m))
    if nearest == math.inf or touch_m < -separation - radii < math.inf:  # of cores: what reaches does so by the slack
        return max(separation, at_least_m)
    return max(separation, nearest)  # at an edge, one of the faces may be deep


@kernel
def add_flat_ends(
    a: Shapes, one: int, b: Shapes, other: int, at: int, slack: float, touch_m: float, found: Meetings
) -> None:
    """Append, where a rim meets the side of a part at the height of a face there, its meeting with this face: the parts
    are apart along its normal, too.
    """
    i, j = found.rows[at].feature, found.rows[at].cage_feature
    place = vector_from(found.rows[at].place)
    there = plus(place, scaled(vector_from(found.rows[at].normal), found.rows[at].gap))
    if a.features[i].kind == RIM:
        for face in range(b.parts[other].first_face, b.parts[other].last):
            if face != j:
                append_if_one(found, one, other, i, face, flush(a.features[i], place, b, face, slack, touch_m))
    if b.features[j].kind == RIM:
        for face in range(a.parts[one].first_face, a.parts[one].last):
            if face != i:
                append_if_one(found, one, other, face, j, swapped(flush(b.features[j], there, a, face, slack, touch_m)))


@kernel
def apart_by_rims(a: Shapes, one: int, b: Shapes, other: int, slack: float, touch_m: float) -> float:
    """Return how far apart two parts are along the ways between their rims and other features, however far these are;
    -inf: there are no rims.
    """
    separation = -math.inf
    for i in range(a.parts[one].first, a.parts[one].last):
        for j in range(b.parts[other].first, b.parts[other].last):
            kind, other_kind = a.features[i].kind, b.features[j].kind
            if separation > 0.0 or (kind != RIM and other_kind != RIM):
                continue
            is_vertex = kind == VERTEX or other_kind == VERTEX
            met = toward_vertex(a, i, b, j) if is_vertex else meeting(a, i, b, j)
            if met.is_one and (is_vertex or tells_apart(a, i, b, j, met, slack)):
                separation = max(separation, apart_along(a, one, b, other, met.normal))
            if met.is_one and is_vertex and met.gap <= SAME_PLACE * touch_m:
                separation = max(separation, apart_along(a, one, b, other, common_normal(a, i, b, j, met)))
    return separation


@kernel
def tip_is_at_rim(a: Shapes, one: int, b: Shapes, other: int, within_m: float) -> bool:
    """Whether a sharp vertex of one of two parts is so near to a sharp rim of the other."""
    for i in range(a.parts[one].first, a.parts[one].last):
        for j in range(b.parts[other].first, b.parts[other].last):
            kind, other_kind = a.features[i].kind, b.features[j].kind
            if (kind == RIM and other_kind == VERTEX) or (kind == VERTEX and other_kind == RIM):
                met = toward_vertex(a, i, b, j)
                if met.is_one and met.gap <= within_m:
                    return True
    return False


@kernel
def on_far_side(separation: float, touch_m: float) -> float:
    """Return the gap below which features meet on the far sides of parts that are so far apart."""
    return 2.0 * min(separation, 0.0) - touch_m


@kernel
def faces_from_ball(shapes: Shapes, which: int, middle: Vector, reach: float) -> float:
    """Return how far a ball is beyond the faces of a part; -inf: it has none."""
    farthest = -math.inf
    for i in range(shapes.parts[which].first_face, shapes.parts[which].last):
        face = shapes.features[i]
        height = dot(vector_from(face.direction), minus(middle, vector_from(face.point))) - face.radius
        farthest = max(farthest, height)
    return farthest - reach


@kernel
def faces_from_ends(a: Shapes, one: int, b: Shapes, other: int, enough_m: float) -> float:
    """Return how far a part's ends are beyond the faces of another one, or more than ``enough_m``; -inf: there are
    no faces.
    """
    farthest = -math.inf
    if b.parts[other].kind == HOLE:  # its ends are not all that it is
        return farthest
    for i in range(a.parts[one].first_face, a.parts[one].last):
        face, lowest = a.features[i], math.inf
        for j in range(b.parts[other].first, b.parts[other].last):
            if not is_end(b.features[j]):
                break
            height = -height_of_end(b.features[j], vector_from(face.point), scaled(vector_from(face.direction), -1.0))
            lowest = min(lowest, height - face.radius)
        farthest = max(farthest, lowest)
        if farthest > enough_m:
            break
    return farthest


@kernel
def find_meetings(
    own: Shapes, body: PlacedBody, cage: Shapes, n_boxes: int, n_points: int, touch_m: float, found: Meetings
) -> None:
    """Find all meetings of two bodies, but those of the object's first ``n_boxes`` parts with the cage's first
    ``n_points``: of boxes and points `cagepose.kernels.collision` knows.

    Parts are asked the more closely the nearer they are.
    """
    found.used[0] = 0
    position, rotation, held = row(body.pose, 0), rotation_of(body), body.world
    for other in range(len(cage.parts)):
        middle, reach = vector_from(cage.parts[other].middle), cage.parts[other].reach
        seen = transposed_times(rotation, minus(middle, position))
        for one in range(len(own.parts)):
            found.gaps[one, other] = math.inf
            if one < n_boxes and other < n_points:
                continue
            gap = balls_apart(held, one, cage, other)
            if gap <= touch_m:
                gap = max(gap, faces_from_ball(own, one, seen, reach))
            if gap <= touch_m:
                gap = max(gap, faces_from_ball(cage, other, vector_from(held.parts[one].middle), held.parts[one].reach))
            if gap <= touch_m:
                place_asked(own, one, body)
                gap = max(gap, faces_from_ends(held, one, cage, other, touch_m))
            if gap <= touch_m:
                gap = max(gap, faces_from_ends(cage, other, held, one, touch_m))
            if gap <= touch_m:
                gap = meet_parts(held, one, cage, other, gap, touch_m, found)
                if math.isnan(gap):
                    found.used[0] = -1
                    return
            found.gaps[one, other] = gap
    for at in range(found.used[0]):
        touching = found.rows[at]
        touching.is_hidden = is_hidden(own, body, cage, touching, touch_m)
        if not touching.is_hidden and deepest_gap(held, touching.part, cage, touching.cage_part) > -math.inf:
            gap = found.gaps[touching.part, touching.cage_part]
            found.gaps[touching.part, touching.cage_part] = min(gap, touching.gap)


@kernel
def is_hidden(own: Shapes, body: PlacedBody, cage: Shapes, one: Touching, touch_m: float) -> bool:
    """Whether another part of one of the bodies covers the place of a meeting; or it is deep in a wall of a hole, or in
    a face beside one, where there is no material: beyond the corner between them.
    """
    place, normal = vector_from(one.place), vector_from(one.normal)
    there, held, least_m = plus(place, scaled(normal, one.gap)), body.world, SAME_PLACE * touch_m
    place_around(own, body, place, touch_m)
    if covers(held, one.part, one.feature, place, normal, touch_m):
        return True
    if covers(cage, one.cage_part, one.cage_feature, there, scaled(normal, -1.0), touch_m):
        return True
    if one.gap >= -least_m or deepest_gap(held, one.part, cage, one.cage_part) == -math.inf:
        return False
    return not (is_in_parts(cage, -1, place, least_m) or is_in_parts(held, -1, there, least_m))
