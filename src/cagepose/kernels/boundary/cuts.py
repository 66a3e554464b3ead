"""Where strands of one body cross the surfaces of another one."""

from __future__ import annotations

import math

from cagepose.kernels.algebra.record import FloatArray, IntArray, Rows
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.boundary.chart import beyond_trim
from cagepose.kernels.boundary.circle import circle_of
from cagepose.kernels.boundary.circle_meeting import round_of
from cagepose.kernels.boundary.features import CIRCLE, FACE, VERTEX, Boundary, Feature
from cagepose.kernels.boundary.reach import beyond_borders
from cagepose.kernels.boundary.strands import Strand, circle_under, on_strand
from cagepose.kernels.boundary.surfaces import (
    beyond_cone,
    crossing,
    has_surface,
    height_over,
    most_crossings,
    normal_of_face,
)
from cagepose.kernels.boundary.tree import FACES, Node
from cagepose.kernels.boundary.tube import beside_tube, beyond_tube
from cagepose.kernels.boundary.within import root_has_surfaces
from cagepose.kernels.circles.beside_circle import circle_equation, is_whole_equally_near
from cagepose.kernels.circles.beside_round import Round, common_with_round, places_by_round
from cagepose.kernels.circles.equation import seen_along
from cagepose.kernels.circles.places import Circle, Place, on_circle
from cagepose.kernels.circles.search import search
from cagepose.kernels.native.kernel import kernel

MOST_CUTS = 1024
"""Of one strand: more are not noted."""
HALVINGS = 60
"""Of the arc in which a circle enters or leaves a round side."""


@kernel
def find_cuts(
    strand: Strand, solid: Boundary, slack_m: float, waiting: IntArray, places: Rows[Place], cuts: FloatArray
) -> tuple[int, bool]:
    """Write in order where a strand crosses surfaces, their borders included, to a length; return how often, and
    whether it does or ends on one.
    """
    n_cuts, meets = 0, False
    low, high = _limits(strand)
    middle, half = scaled(plus(low, high), 0.5), scaled(minus(high, low), 0.5)
    for root in range(3):
        if not root_has_surfaces(solid, root):
            continue
        waiting[0], n_waiting = root, 1
        while n_waiting > 0:
            n_waiting -= 1
            node = solid.nodes[waiting[n_waiting]]
            if _is_beside(node, strand, middle, half, slack_m):
                continue
            if node.left >= 0:
                waiting[n_waiting], waiting[n_waiting + 1] = node.left, node.right
                n_waiting += 2
                continue
            for i in range(node.first, node.last):
                if not has_surface(solid.features[i]):
                    continue
                if strand.is_arc:
                    n_cuts = _cut_arc(strand, solid, i, slack_m, places, cuts, n_cuts)
                    continue
                if root == FACES and _is_on_one_side(strand, solid, i, slack_m):
                    continue
                for which in range(most_crossings(solid.features[i])):
                    met = crossing(solid, i, strand.point, strand.way, strand.end, slack_m, which)
                    if met.is_one and met.beyond <= slack_m:
                        meets = True
                        n_cuts = _noted(strand, met.along, cuts, n_cuts)
    return n_cuts, meets or n_cuts > 0


@kernel
def _is_on_one_side(line: Strand, solid: Boundary, i: int, slack_m: float) -> bool:
    """Whether a straight strand is on one side of the plane of a face, farther away than a length."""
    start = height_over(solid, i, line.point)
    end = start + line.end * dot(normal_of_face(solid, i), line.way)
    return min(start, end) > slack_m or max(start, end) < -slack_m


@kernel
def _limits(strand: Strand) -> tuple[Vector, Vector]:
    """Return the lowest and highest coordinates of a line, or of the circle that an arc is on."""
    if strand.is_arc:
        c, a, r = strand.point, strand.way, strand.radius
        reach = (
            r * math.sqrt(max(0.0, 1.0 - a[0] * a[0])),
            r * math.sqrt(max(0.0, 1.0 - a[1] * a[1])),
            r * math.sqrt(max(0.0, 1.0 - a[2] * a[2])),
        )
        return minus(c, reach), plus(c, reach)
    p, q = strand.point, on_strand(strand, strand.end)
    return (
        (min(p[0], q[0]), min(p[1], q[1]), min(p[2], q[2])),
        (max(p[0], q[0]), max(p[1], q[1]), max(p[2], q[2])),
    )


@kernel
def _is_beside(node: Node, strand: Strand, middle: Vector, half: Vector, slack_m: float) -> bool:
    """Whether a strand passes by a box, farther than a length; of an arc, what is around it does."""
    away = minus(middle, vector_from(node.middle))
    for k in range(3):
        if abs(away[k]) > half[k] + node.half[k] + slack_m:
            return True
    if strand.is_arc:
        return False
    aside, way = cross(away, strand.way), strand.way
    x, y, z = node.half[0] + slack_m, node.half[1] + slack_m, node.half[2] + slack_m
    if abs(aside[0]) > y * abs(way[2]) + z * abs(way[1]) or abs(aside[1]) > x * abs(way[2]) + z * abs(way[0]):
        return True
    return bool(abs(aside[2]) > x * abs(way[1]) + y * abs(way[0]))


@kernel
def _noted(strand: Strand, at: float, cuts: FloatArray, n_cuts: int) -> int:
    """Write a cut in its order, if it is between the ends of a strand and there is room; return how many there are."""
    if strand.is_arc:
        at = strand.begin + (at - strand.begin) % (2.0 * math.pi)
    is_on = strand.begin < at < strand.end or (strand.is_closed and at == strand.begin)
    if not is_on or n_cuts == len(cuts):
        return n_cuts
    k = n_cuts
    while k > 0 and cuts[k - 1] > at:
        cuts[k] = cuts[k - 1]
        k -= 1
    cuts[k] = at
    return n_cuts + 1


@kernel
def _cut_arc(
    strand: Strand, solid: Boundary, i: int, slack_m: float, places: Rows[Place], cuts: FloatArray, n_cuts: int
) -> int:
    """Note where an arc crosses a surface."""
    feature, circle = solid.features[i], circle_under(strand)
    if feature.kind != FACE and feature.kind != VERTEX:
        return _cut_by_round(strand, solid, i, slack_m, places, cuts, n_cuts)
    seen = minus(circle.centre, vector_from(feature.point))
    if feature.kind == FACE:
        way = vector_from(feature.direction)
        level = feature.radius - dot(way, seen)
    else:  # |seen + r out|^2 = radius^2
        way, square = scaled(seen, 2.0 * circle.radius), dot(seen, seen) + circle.radius * circle.radius
        level = feature.radius * feature.radius - square
    one, other = dot(way, circle.toward), dot(way, cross(circle.axis, circle.toward))
    most = circle.radius * math.hypot(one, other) if feature.kind == FACE else math.hypot(one, other)
    if most <= abs(level):
        return n_cuts
    start, half = math.atan2(other, one), math.acos(level / most)
    for side in range(2):
        angle = start + half if side == 0 else start - half
        there = minus(on_circle(circle, angle).point, vector_from(feature.point))
        if _beyond_at(solid, i, there) <= slack_m:
            n_cuts = _noted(strand, angle, cuts, n_cuts)
    return n_cuts


@kernel
def _beyond_at(solid: Boundary, i: int, there: Vector) -> float:
    """Return how far a place on a plane or a ball, seen from its feature's point, is beyond its bounds."""
    feature = solid.features[i]
    if feature.kind == FACE:
        return beyond_borders(solid, i, minus(there, scaled(vector_from(feature.direction), feature.radius)), math.inf)
    return feature.radius * beyond_cone(solid, i, scaled(there, 1.0 / norm(there)))


@kernel
def _cut_by_round(
    strand: Strand, solid: Boundary, i: int, slack_m: float, places: Rows[Place], cuts: FloatArray, n_cuts: int
) -> int:
    """Note where an arc crosses a round side or a tube: between places of a stationary distance once, or not."""
    feature, circle = solid.features[i], circle_under(strand)
    if feature.kind == CIRCLE:
        n_places = _places_by_tube(circle, feature, 0.5 * slack_m, places)
    else:
        side = round_of(feature)
        if _is_far(circle, side, feature.length, slack_m):
            return n_cuts
        n_places = places_by_round(circle, side, 0.5 * slack_m, places)
    for k in range(n_places):
        begin, end = places[k].angle, begin_of_next(places, n_places, k)
        low, high = _height(circle, feature, begin), _height(circle, feature, end)
        if low * high >= 0.0:
            continue
        for _ in range(HALVINGS):
            angle = 0.5 * (begin + end)
            height = _height(circle, feature, angle)
            if (height < 0.0) == (low < 0.0):
                begin = angle
            else:
                end = angle
        if _beyond_round(circle, solid, i, 0.5 * (begin + end)) <= slack_m:
            n_cuts = _noted(strand, begin, cuts, n_cuts)
    return n_cuts


@kernel
def _places_by_tube(circle: Circle, tube: Feature, flat_m: float, places: Rows[Place]) -> int:
    """Write the places of a circle where its distance from the one within a tube is stationary; none if the tube is
    farther away, or all of the circle is equally far.
    """
    if abs(beside_tube(tube, circle.centre).gap) > circle.radius:
        return 0
    core = circle_of(tube)
    near = circle_equation(circle, core, seen_along(circle, core.centre, core.axis), True)
    if is_whole_equally_near(near, flat_m / circle.radius):
        return 0
    return search(near, True, 0, places)


@kernel
def _beyond_round(circle: Circle, solid: Boundary, i: int, angle: float) -> float:
    """Return how far a place of a circle on a round side or a tube is beyond where that ends."""
    feature = solid.features[i]
    if feature.kind == CIRCLE:
        return beyond_tube(feature, beside_tube(feature, on_circle(circle, angle).point))
    side = round_of(feature)
    met = common_with_round(circle, side, angle)
    normal = scaled(met.normal, -1.0)
    foot = dot(side.direction, minus(met.point, side.point)) - side.taper * side.radius
    square = 1.0 - side.taper * side.taper
    beyond = max(-foot, foot - feature.length * square, beyond_trim(solid, i, normal, foot / square))
    return max(beyond, abs(side.radius) * beyond_cone(solid, i, normal))


@kernel
def _is_far(circle: Circle, side: Round, length: float, slack_m: float) -> bool:
    """Whether a circle's centre is farther from a round side than its radius, or the circle beyond the side's ends."""
    seen, square = minus(circle.centre, side.point), 1.0 - side.taper * side.taper
    level = dot(seen, side.direction)
    rho = norm(minus(seen, scaled(side.direction, level)))
    gap = math.copysign(math.sqrt(square), side.radius) * rho + side.taper * level - side.radius
    cosine = dot(circle.axis, side.direction)
    reach, foot = circle.radius * math.sqrt(max(0.0, 1.0 - cosine * cosine)), level - side.taper * side.radius
    return abs(gap) > circle.radius or foot + reach < -slack_m or foot - reach > square * length + slack_m


@kernel
def begin_of_next(places: Rows[Place], n_places: int, k: int) -> float:
    """Return the angle of the place that follows one, a turn on if it is the first; places are in no order."""
    angle, following = places[k].angle, places[k].angle + 2.0 * math.pi
    for j in range(n_places):
        if j != k:
            other = places[j].angle
            following = min(following, other if other > angle else other + 2.0 * math.pi)
    return following


@kernel
def _height(circle: Circle, feature: Feature, angle: float) -> float:
    """Return how far a place of a circle is above a round side or a tube."""
    if feature.kind == CIRCLE:
        return beside_tube(feature, on_circle(circle, angle).point).gap
    return common_with_round(circle, round_of(feature), angle).gap
