"""First contact of two boundaries while the object moves at a constant twist.

Pairs of nodes of the two bodies' trees wait in the order in which their boxes can first overlap, so that a contact that
is found ends all that can only come later.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.motion import Motion, velocity_at
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.vector import cross, dot, minus, norm, row, scaled, vector_from
from cagepose.kernels.boundary.along_motion import ahead, safe_step
from cagepose.kernels.boundary.circle_first import first_touch_of_curved, kept_at, lines_apart
from cagepose.kernels.boundary.extents import extent_of, surely_apart
from cagepose.kernels.boundary.features import (
    CIRCLE,
    FACE,
    LINE,
    VERTEX,
    Feature,
    PlacedBoundary,
    box_of,
    in_frame,
    place_feature,
)
from cagepose.kernels.boundary.first_touch import clear_step, distance_from, first_touch, keeps_radius
from cagepose.kernels.boundary.kept_meetings import hold_places, is_beside_kept, is_there, passes_axis
from cagepose.kernels.boundary.meeting import both_reach, meeting
from cagepose.kernels.boundary.meetings import (
    MOST_SLACK,
    PLACES_AROUND,
    can_touch,
    find_circle_places,
    meeting_at,
    slack_of,
)
from cagepose.kernels.boundary.met import Meeting
from cagepose.kernels.boundary.queue import Queue, put, take_first
from cagepose.kernels.boundary.touching import SAME_PLACE, Meetings
from cagepose.kernels.boundary.tree import Node, may_touch, span_of_overlap
from cagepose.kernels.circles.places import GREATEST, SADDLE, WHOLE
from cagepose.kernels.native.kernel import kernel

LEAVES_OF_SPEED = 1e-6
"""Features that touch and move apart faster leave each other, and may meet again."""
LEAST_SLACK = 1e-12
"""Sine, of rounding."""
THIN_OF_LEAST = 0.1
"""Of the shortest edge of two features: they may not go deeper, or could come out on the other side."""


class Search(NamedTuple):
    """What a first contact is asked with.

    Attributes
    ----------
    motion, end
        That of the object, and its greatest amount.
    near_m, near_depth_m
        Features nearer than the one may go so deep as the other.
    speed
        That no point of the object exceeds, metres for each unit of the amount.
    touch_m, size_m
        The touch tolerance, and the size of both bodies.
    """

    motion: Motion
    end: float
    near_m: float
    near_depth_m: float
    speed: float
    touch_m: float
    size_m: float


class Hit(NamedTuple):
    """What is reached, and after which amount of a motion.

    Attributes
    ----------
    amount
        Inf: nothing is.
    feature, cage_feature
        Indices; -1: nothing.
    gap
        How far apart they are now, metres.
    angle
        Where on a circle, if one of them is one, radians; of two, on the object's. Else zero.
    is_open
        They are not reached, but graze each other so long that what comes behind the amount is not known. Nothing is
        reached before it: ask again from there.
    """

    amount: float
    feature: int
    cage_feature: int
    gap: float
    angle: float
    is_open: bool


NO_HIT = Hit(math.inf, -1, -1, math.inf, 0.0, False)


@kernel
def let_wait(
    held: PlacedBoundary, node: int, cage: PlacedBoundary, cage_node: int, search: Search, until: float, queue: Queue
) -> bool:
    """Let two nodes wait, if they may meet before an amount; False: there is no room."""
    one, other = held.own.nodes[node], cage.own.nodes[cage_node]
    if one.first == one.last or other.first == other.last:
        return True
    box, cage_box = box_of(held, node), box_of(cage, cage_node)
    span = span_of_overlap(box, cage_box, search.motion, min(search.end, until), search.touch_m)
    if span.begin == math.inf:
        return True
    return put(queue, node, cage_node, span)


@kernel
def first_to_meet(
    held: PlacedBoundary, cage: PlacedBoundary, search: Search, meetings: Meetings, queue: Queue, moved: PlacedBoundary
) -> Hit:
    """Return what the object reaches first, but for what touches and is kept, or leaves.

    Parameters
    ----------
    held, cage
        At their poses.
    search
        See there.
    meetings
        What touches now; see `is_there`.
    queue, moved
        Memory.
    """
    hit = NO_HIT
    queue.used[:] = 0
    for root in range(3):
        for cage_root in range(3):
            if may_touch(root, held.own.nodes[root], cage_root, cage.own.nodes[cage_root]):
                let_wait(held, root, cage, cage_root, search, hit.amount, queue)
    while queue.used[1] > 0:
        at = take_first(queue)
        node, cage_node, end = queue.rows[at].node, queue.rows[at].cage_node, queue.rows[at].end
        if queue.rows[at].begin >= hit.amount:
            break
        one, other = held.own.nodes[node], cage.own.nodes[cage_node]
        if one.left < 0 and other.left < 0:
            hit = first_of_leaves(held, node, cage, cage_node, min(end, search.end), search, meetings, moved, hit)
            continue
        divides_held = other.left < 0 or (one.left >= 0 and max(one.half) >= max(other.half))
        for side in range(2):
            left, right = (one.left, one.right) if divides_held else (other.left, other.right)
            child = left if side == 0 else right
            node_below, cage_below = (child, cage_node) if divides_held else (node, child)
            if not let_wait(held, node_below, cage, cage_below, search, hit.amount, queue):
                hit = first_below(held, node_below, cage, cage_below, search, meetings, moved, hit)
    return hit


@kernel
def first_below(
    held: PlacedBoundary,
    node: int,
    cage: PlacedBoundary,
    cage_node: int,
    search: Search,
    meetings: Meetings,
    moved: PlacedBoundary,
    hit: Hit,
) -> Hit:
    """As `first_to_meet`, of what is below two nodes, in no order: where too many pairs wait."""
    pairs, n_waiting = meetings.pairs, 1
    pairs[0, 0], pairs[0, 1] = node, cage_node
    while n_waiting > 0:
        n_waiting -= 1
        node, cage_node = pairs[n_waiting, 0], pairs[n_waiting, 1]
        one, other = held.own.nodes[node], cage.own.nodes[cage_node]
        until = min(search.end, hit.amount)
        span = span_of_overlap(box_of(held, node), box_of(cage, cage_node), search.motion, until, search.touch_m)
        if span.begin >= until:
            continue
        if one.left < 0 and other.left < 0:
            hit = first_of_leaves(held, node, cage, cage_node, min(span.end, until), search, meetings, moved, hit)
            continue
        divides_held = other.left < 0 or (one.left >= 0 and max(one.half) >= max(other.half))
        left, right = (one.left, one.right) if divides_held else (other.left, other.right)
        for side in range(2):
            child = left if side == 0 else right
            pairs[n_waiting, 0] = child if divides_held else node
            pairs[n_waiting, 1] = cage_node if divides_held else child
            n_waiting += 1
    return hit


@kernel
def first_of_leaves(
    held: PlacedBoundary,
    node: int,
    cage: PlacedBoundary,
    cage_node: int,
    until: float,
    search: Search,
    meetings: Meetings,
    moved: PlacedBoundary,
    hit: Hit,
) -> Hit:
    """Return what the features of two leaves reach if that is sooner than ``hit``, and else this."""
    one, other = held.own.nodes[node], cage.own.nodes[cage_node]
    kind, cage_kind = held.own.features[one.first].kind, cage.own.features[other.first].kind
    if kind == FACE and cage_kind == VERTEX:
        return first_of_vertices(cage, other, held, one, True, until, search, meetings, moved, hit)
    if kind == VERTEX and cage_kind == FACE:
        return first_of_vertices(held, one, cage, other, False, until, search, meetings, moved, hit)
    reach_m = reach_of(search) + SAME_PLACE * max(search.near_m, search.touch_m)
    for i in range(one.first, one.last):
        if not held.is_placed[i]:
            place_feature(held, i)
        box = extent_of(held.features[i])
        for j in range(other.first, other.last):
            if not can_touch(held.own.features[i], cage.own.features[j]):
                continue
            if not cage.is_placed[j]:
                place_feature(cage, j)
            apart = surely_apart(held.features[i], box, cage.features[j]) - reach_m
            if apart >= min(until, hit.amount) * search.speed:
                continue
            hit = sooner(held, i, cage, j, min(until, hit.amount), search, meetings, moved, hit)
    return hit


@kernel
def first_of_vertices(
    vertices: PlacedBoundary,
    one: Node,
    faces: PlacedBoundary,
    other: Node,
    of_cage: bool,
    until: float,
    search: Search,
    meetings: Meetings,
    moved: PlacedBoundary,
    hit: Hit,
) -> Hit:
    """Return what the vertices of a leaf, which are those of the cage or of the object, and some faces reach if that is
    sooner than ``hit``, and else this.
    """
    sense, heights = -1.0 if of_cage else 1.0, meetings.heights
    held, cage = (faces, vertices) if of_cage else (vertices, faces)
    for i in range(one.first, one.last):
        latest = min(until, hit.amount)
        if not vertices.is_placed[i]:
            place_feature(vertices, i)
        find_clearances(
            vertices.features[i], faces.pose, faces.own.planes, other.first, other.last, sense, latest, search, heights
        )
        for j in range(other.first, other.last):
            if heights[j] <= 0.0:
                if not faces.is_placed[j]:
                    place_feature(faces, j)
                at, cage_at = (j, i) if of_cage else (i, j)
                hit = sooner(held, at, cage, cage_at, min(until, hit.amount), search, meetings, moved, hit)
    return hit


@kernel
def find_clearances(
    vertex: Feature,
    pose: FloatArray,
    planes: FloatArray,
    first: int,
    last: int,
    sense: float,
    until: float,
    search: Search,
    out: FloatArray,
) -> None:
    """Write how far a vertex of one body surely stays from some faces of the other one, with its pose and its planes,
    on its side of these or beside the boxes around the faces, up to an amount; at most zero: it may reach them.
    ``sense`` is 1 where the vertex moves, and -1 where the faces do.

    Along each direction it goes straight, give or take the way's curvature.
    """
    motion, point, radius = search.motion, vector_from(vertex.point), vertex.radius
    way = scaled(velocity_at(motion, point), sense)
    x, y, z = in_frame(pose, minus(point, row(pose, 0)))
    u, v, w = in_frame(pose, way)
    bend = 0.5 * motion.rate * norm(cross(motion.axis, way)) * until * until
    margin = bend + 2.0 * search.touch_m
    around = margin + radius + max(reach_of(search), SAME_PLACE * max(search.near_m, search.touch_m))
    x_low, x_high = min(x, x + u * until) - around, max(x, x + u * until) + around
    y_low, y_high = min(y, y + v * until) - around, max(y, y + v * until) + around
    z_low, z_high = min(z, z + w * until) - around, max(z, z + w * until) + around
    n, m, k, above = planes[0, first:last], planes[1, first:last], planes[2, first:last], planes[3, first:last]
    lows = planes[5, first:last], planes[6, first:last], planes[7, first:last]
    highs = planes[8, first:last], planes[9, first:last], planes[10, first:last]
    here = out[first:last]
    for j in range(len(here)):
        height = n[j] * x + m[j] * y + k[j] * z - above[j] - radius
        rises = (n[j] * u + m[j] * v + k[j] * w) * until
        beside = max(lows[0][j] - x_high, x_low - highs[0][j], lows[1][j] - y_high)
        beside = max(beside, y_low - highs[1][j], lows[2][j] - z_high, z_low - highs[2][j])
        here[j] = max(min(height, height + rises) - margin, -max(height, height + rises) - margin, beside)


@kernel
def sooner(
    held: PlacedBoundary,
    i: int,
    cage: PlacedBoundary,
    j: int,
    until: float,
    search: Search,
    meetings: Meetings,
    moved: PlacedBoundary,
    hit: Hit,
) -> Hit:
    """Return what two features reach before an amount, or ``hit``."""
    motion = search.motion
    if is_curved(held.own.features[i], cage.own.features[j]):
        if (curved_apart(held, i, cage, j) - search.touch_m) >= until * search.speed:
            return hit
        return first_of_curved(held, i, cage, j, until, search, meetings, moved, hit)
    if safe_step(ahead(held.features[i], cage.features[j], motion, 0.0, 0.0, 1.0, until)) >= until:
        return hit
    clear = clear_step(held, i, cage, j, motion, reach_of(search))
    is_near = clear * search.speed <= SAME_PLACE * max(search.near_m, search.touch_m)  # and may be deep already
    if not is_near and clear >= until:
        return hit
    met = meeting(held, i, cage, j)
    amount = first_of_features(held, i, cage, j, met, until, search, meetings, moved)
    return Hit(amount, i, j, met.gap, 0.0, False) if amount < until else hit


@kernel
def is_curved(one: Feature, other: Feature) -> bool:
    """Whether first contact of two features is found by advancement: of circles, and of lines with sides of cones."""
    if one.kind == CIRCLE or other.kind == CIRCLE:
        return True
    return bool(one.kind == LINE and other.kind == LINE and (one.taper != 0.0 or other.taper != 0.0))


@kernel
def curved_apart(held: PlacedBoundary, i: int, cage: PlacedBoundary, j: int) -> float:
    """Return a length that two curved features are surely apart; below zero: none is known."""
    one, other = held.features[i], cage.features[j]
    apart = -math.inf
    if one.kind == LINE and other.kind == LINE:
        return lines_apart(one, other)
    if one.kind == CIRCLE and keeps_radius(other):
        apart = distance_from(cage, j, vector_from(one.point)) - one.length - one.radius - other.radius
    if other.kind == CIRCLE and keeps_radius(one):
        apart = max(apart, distance_from(held, i, vector_from(other.point)) - other.length - other.radius - one.radius)
    return apart


@kernel
def first_of_curved(
    held: PlacedBoundary,
    i: int,
    cage: PlacedBoundary,
    j: int,
    until: float,
    search: Search,
    meetings: Meetings,
    moved: PlacedBoundary,
    hit: Hit,
) -> Hit:
    """Return what two curved features reach before an amount, see `is_curved`, or ``hit``."""
    one, other, touch_m = held.features[i], cage.features[j], search.touch_m
    slack, slowest, least = slack_of(one, other, touch_m), LEAVES_OF_SPEED * search.speed, math.inf
    deepest = min(search.near_depth_m, THIN_OF_LEAST * min(one.least, other.least))
    n_kept = hold_places(i, j, meetings)
    n_places, is_flat = find_circle_places(one, other, touch_m, meetings.places), one.kind == FACE or other.kind == FACE
    for k in range(PLACES_AROUND if n_places == WHOLE else n_places):
        if n_kept == len(meetings.kept):
            break
        place = meetings.places[k]
        met = meeting_at(held, i, cage, j, place)
        if place.kind in (GREATEST, SADDLE) or not met.is_one or kept_at(place.angle, meetings.kept, n_kept) >= 0:
            continue
        if met.gap > max(touch_m, search.near_m):
            least = min(least, met.gap)
            continue
        touches = abs(met.gap) <= touch_m
        reaches_there = both_reach(held, i, cage, j, met, slack, 2.0 * touch_m)
        depth = deepest if abs(met.gap) <= search.near_m or (touches and reaches_there) else 0.0
        depth = max(depth, 2.0 * touch_m)  # they may not reach there now, but might
        is_passed = reaches_there and met.gap < -depth
        is_held = touches and is_there(meetings, met, True, touch_m)
        is_grazing = False
        if touches:
            closing = dot(met.normal, velocity_at(search.motion, met.place))
            if is_held:
                is_passed = True
            elif reaches_there:  # a contact that carries, or it would not go into it, but may along a curve
                is_beside = is_beside_kept(i, j, meetings, met, touch_m)
                is_grazing = abs(closing) <= slowest and search.near_m == 0.0 and not is_beside
                is_passed = closing >= -slowest or is_beside
            else:  # that of features next to them; or circles that cross in one plane, as where parts are flush
                is_passed = abs(closing) <= slowest and is_there(meetings, met, False, touch_m)
                is_grazing = not is_passed and search.near_m == 0.0
        elif reaches_there and met.gap < 0.0:
            is_passed = is_passed or is_beside_kept(i, j, meetings, met, touch_m)
        if not is_held:
            least = min(least, met.gap)
        is_deep = met.gap < -depth  # and does not reach there; but another place may come up beside it
        if is_passed or not is_deep or not is_flat:
            row = meetings.kept[n_kept]
            row.angle, row.other_angle, row.is_held = place.angle, place.other_angle, is_held
            row.depth_m, row.is_grazing = math.inf if (is_passed or is_deep) and not is_grazing else depth, is_grazing
            n_kept += 1
    exact, reach_m = tilt_of(search, one, other), reach_of(search)
    places, waiting, kept = meetings.places, meetings.waiting, meetings.kept
    found = first_touch_of_curved(
        held, i, cage, j, search.motion, until, exact, reach_m, touch_m, moved, places, waiting, kept, n_kept
    )
    return Hit(found.amount, i, j, least, found.angle, found.is_open) if found.amount < until else hit


@kernel
def first_of_features(
    held: PlacedBoundary,
    i: int,
    cage: PlacedBoundary,
    j: int,
    met: Meeting,
    until: float,
    search: Search,
    meetings: Meetings,
    moved: PlacedBoundary,
) -> float:
    """Return when two features that do not touch, or leave each other, reach each other; inf: they do not before an
    amount.
    """
    one, other, motion, touch_m = held.own.features[i], cage.own.features[j], search.motion, search.touch_m
    touches = met.is_one and abs(met.gap) <= touch_m
    leaves = touches and both_reach(held, i, cage, j, met, slack_of(one, other, touch_m), 2.0 * touch_m)
    is_hollow = one.radius < 0.0 or other.radius < 0.0
    closing = dot(met.normal, velocity_at(motion, met.place)) if touches else -math.inf
    slowest = LEAVES_OF_SPEED * search.speed
    if touches and is_there(meetings, met, True, touch_m):  # it is put back there, or stands all around
        return passes_axis(held, i, cage, j, motion) if is_hollow else math.inf
    if touches and not leaves:
        if abs(closing) <= slowest and is_there(meetings, met, False, touch_m):  # that of features next to them
            return math.inf
        closing = -math.inf
    if leaves and motion.rate == 0.0 and not is_hollow:
        return math.inf
    if closing >= -slowest or (leaves and is_beside_kept(i, j, meetings, met, touch_m)):  # a contact that carries
        return math.inf
    level, side = 0.0, 0.0
    if met.is_one and abs(met.gap) <= max(search.near_m, touch_m):
        depth = min(search.near_depth_m, THIN_OF_LEAST * min(one.least, other.least))
        level = depth if leaves or abs(met.gap) <= search.near_m else 0.0
        if not leaves:
            level = max(level, 2.0 * touch_m)  # they do not reach there now, but might
        if one.kind == LINE and other.kind == LINE:
            crossed = cross(vector_from(held.features[i].direction), vector_from(cage.features[j].direction))
            side = -math.copysign(1.0, dot(met.normal, crossed))
    exact = tilt_of(search, one, other)
    reach_m, waiting = reach_of(search), meetings.waiting
    return first_touch(held, i, cage, j, motion, until, level, side, exact, touch_m, reach_m, moved, waiting)


@kernel
def tilt_of(search: Search, one: Feature, other: Feature) -> float:
    """Return the sine by which features may be tilted that count as reached: so much what strays from its face on a
    screw tilts them.
    """
    strayed = min(search.near_depth_m / min(one.least, other.least), MOST_SLACK)
    return max(LEAST_SLACK, search.touch_m / search.size_m, strayed)


@kernel
def reach_of(search: Search) -> float:
    """Return how far beyond its border a feature still counts as reached, metres: what slides in a hollow edge strays
    from it on a screw, as far as it may go into its faces, and is put back.
    """
    return max(search.touch_m, search.near_depth_m)
