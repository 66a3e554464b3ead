"""How two features meet: their gap, its normal and its place, equation (2.8); and whether both reach there.

What two features are to each other depends on no other part of their bodies: a vertex is asked how far it is from the
plane of a face, an edge how far from the line of another. Whether they are the ones that can touch is told by their
fences: the normal must be one of both, and the place on both.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.shapes.features import EDGE, FACE, RIM, VERTEX, Feature, Shapes, beyond_fence
from cagepose.kernels.shapes.feet import foot_on
from cagepose.kernels.shapes.rims import beyond_normals, is_on_arc, nearest_on_edge, nearest_on_rim, outward_at

SAME_PLACE = 4.0
"""In touch tolerances: meetings nearer to each other are at one place."""
PARALLEL = 1e-7
"""Sine: edges that make a smaller angle lie side by side, and meet at their ends."""
SHARP = 1e-6
"""Fraction of the length of edges. Edges of a smaller radius, if any, are told by their faces which way is out, as
cores may be into each other by the touch tolerance. Edges of a greater one are told by where they are."""
TIP = 1e-9
"""Fraction of the radius of a circle that touches the side of a cone. Where the cone has a smaller radius, the circle
is at its tip."""
CENTRED = 1e-10
"""Fraction of radii. Nearer to the axis of a slanted wall, a ball touches it all around, in the middle of each sector.
"""
ROUNDING = 1e-13
"""Fraction of the radius of a circle. What is nearer to it is told by the bounds of its features which way is out."""


class Meeting(NamedTuple):
    """Two features, the first of the object.

    Attributes
    ----------
    is_one
        Whether features of these kinds can touch.
    gap
        Between the rounded features; below zero: how deep, metres; inf: an arc has no place that is nearest.
    normal, place
        Outward unit normal of the object; the object's point of contact, in the world.
    """

    is_one: bool
    gap: float
    normal: Vector
    place: Vector


@kernel
def apart() -> Meeting:
    """Return that two features do not meet."""
    return Meeting(False, math.inf, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


@kernel
def without_normal(gap: float) -> Meeting:
    """Return that two features do not meet where they are nearest to each other, so far apart."""
    return Meeting(False, gap, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


@kernel
def farthest_beyond(shapes: Shapes, i: int, normal: Vector, core: Vector) -> float:
    """Return how far a direction is beyond the outward normals of a vertex, an edge or, at a point of its core, a rim,
    a sine; -inf: all are.
    """
    feature = shapes.features[i]
    if feature.kind == RIM:
        return beyond_normals(feature, core, normal)
    farthest = -math.inf
    for f in range(feature.first_fence, feature.last_fence):
        farthest = max(farthest, beyond_fence(shapes.fences[f], normal))
    return farthest


@kernel
def reaches(shapes: Shapes, i: int, normal: Vector, core: Vector, slack: float, slack_m: float) -> bool:
    """Whether a feature has this outward normal at this point of its core, to a sine and a length beyond its end."""
    feature = shapes.features[i]
    seen = minus(core, vector_from(feature.point))
    if feature.kind == FACE:
        for f in range(feature.first_fence, feature.last_fence):
            if beyond_fence(shapes.fences[f], seen) > slack_m:
                return False
        return True
    if feature.kind == EDGE:
        along = dot(vector_from(feature.direction), seen) / (1.0 - feature.taper * feature.taper)
        if along < -slack_m or along > feature.length + slack_m:
            return False
    if feature.kind == RIM and not is_on_arc(feature, core, slack_m):
        return False
    return farthest_beyond(shapes, i, normal, core) <= slack


@kernel
def both_reach(a: Shapes, i: int, b: Shapes, j: int, met: Meeting, slack: float, slack_m: float) -> bool:
    """Whether two features can touch where they meet, equation (2.11)."""
    if not met.is_one:
        return False
    one = minus(met.place, scaled(met.normal, a.features[i].radius))
    other = plus(met.place, scaled(met.normal, met.gap + b.features[j].radius))
    back = scaled(met.normal, -1.0)
    return reaches(a, i, met.normal, one, slack, slack_m) and reaches(b, j, back, other, slack, slack_m)


@kernel
def vertex_and_face(a: Shapes, i: int, b: Shapes, j: int) -> Meeting:
    """A vertex of the object and a face of the cage."""
    vertex, radius = vector_from(a.features[i].point), a.features[i].radius
    normal = scaled(vector_from(b.features[j].direction), -1.0)
    gap = dot(normal, minus(vector_from(b.features[j].point), vertex)) - radius - b.features[j].radius
    return Meeting(True, gap, normal, plus(vertex, scaled(normal, radius)))


@kernel
def face_and_vertex(a: Shapes, i: int, b: Shapes, j: int) -> Meeting:
    """A face of the object and a vertex of the cage."""
    vertex, normal = vector_from(b.features[j].point), vector_from(a.features[i].direction)
    height = dot(normal, minus(vertex, vector_from(a.features[i].point))) - a.features[i].radius
    return Meeting(True, height - b.features[j].radius, normal, minus(vertex, scaled(normal, height)))


@kernel
def outward_side(shapes: Shapes, i: int, normal: Vector, core: Vector) -> float:
    """Return how much farther beyond its outward normals a feature has the opposite of a direction; zero: one without
    fences has all directions.
    """
    feature = shapes.features[i]
    if feature.kind != RIM and feature.first_fence == feature.last_fence:
        return 0.0
    return farthest_beyond(shapes, i, scaled(normal, -1.0), core) - farthest_beyond(shapes, i, normal, core)


@kernel
def edge_and_edge(a: Shapes, i: int, b: Shapes, j: int) -> Meeting:
    """Two edges that cross."""
    one, other = a.features[i], b.features[j]
    u, w = vector_from(one.direction), vector_from(other.direction)
    crossed = cross(u, w)
    sine = norm(crossed)
    if sine < PARALLEL or one.radius < 0.0 or other.radius < 0.0:
        return apart()
    start = minus(vector_from(other.point), vector_from(one.point))
    if one.taper != 0.0 or other.taper != 0.0:
        return tapered_edges(one, other, start, crossed, sine)
    s = dot(cross(start, w), crossed) / (sine * sine)  # start + t w - s u is along the normal
    normal = scaled(crossed, 1.0 / sine)
    distance = dot(start, normal)
    core = plus(vector_from(one.point), scaled(u, s))
    turned = distance < 0.0
    if one.radius + other.radius < SHARP * min(one.length, other.length):  # they may be a little into each other
        turned = is_turned(a, i, core, b, j, core, normal, turned)
    if turned:
        normal, distance = scaled(normal, -1.0), -distance
    return Meeting(True, distance - one.radius - other.radius, normal, plus(core, scaled(normal, one.radius)))


@kernel
def is_turned(
    a: Shapes, i: int, core: Vector, b: Shapes, j: int, other_core: Vector, normal: Vector, otherwise: bool
) -> bool:
    """Whether of two normals across sharp features the opposite one is out of the object, if their fences tell."""
    out = outward_side(a, i, normal, core) - outward_side(b, j, normal, other_core)
    return out < 0.0 if abs(out) > PARALLEL else otherwise


@kernel
def tapered_edges(one: Feature, other: Feature, start: Vector, crossed: Vector, sine: float) -> Meeting:
    """Two edges that cross, whose radii change along them: for tapers s and s' the normal has n.u = s, n.w = -s'."""
    u, w = vector_from(one.direction), vector_from(other.direction)
    cosine, square = dot(u, w), sine * sine
    along, other_along = (one.taper + other.taper * cosine) / square, (-other.taper - one.taper * cosine) / square
    beyond = 1.0 - along * one.taper + other_along * other.taper
    if beyond <= 0.0:
        return apart()
    across = math.copysign(math.sqrt(beyond), dot(start, crossed)) / sine
    normal = plus(plus(scaled(u, along), scaled(w, other_along)), scaled(crossed, across))
    gap = dot(normal, start) - one.radius - other.radius
    distance = dot(start, crossed) / (across * square)
    s = dot(cross(minus(start, scaled(normal, distance)), w), crossed) / square
    core = plus(vector_from(one.point), scaled(u, s))
    return Meeting(True, gap, normal, plus(core, scaled(normal, one.radius - one.taper * s)))


@kernel
def round_ones(a: Shapes, i: int, b: Shapes, j: int) -> Meeting:
    """A vertex and an edge, or two vertices, with a radius: their distance."""
    one, other = a.features[i], b.features[j]
    if one.radius + other.radius == 0.0:
        return apart()
    core, others = vector_from(one.point), vector_from(other.point)
    radius, other_radius, side = one.radius, other.radius, 1.0
    if one.kind == EDGE:
        nearest = nearest_on_edge(one, others)
        core, radius, side = nearest.place, nearest.radius, math.copysign(1.0, one.radius)
    elif other.kind == EDGE:
        nearest = nearest_on_edge(other, core)
        others, other_radius, side = nearest.place, nearest.radius, math.copysign(1.0, other.radius)
    between = minus(others, core)
    distance = side * norm(between)
    if abs(distance) <= CENTRED * max(abs(radius), abs(other_radius)):
        if one.kind == EDGE and one.taper != 0.0 and side < 0.0:
            normal = middle_of_wall(one)
        elif other.kind == EDGE and other.taper != 0.0 and side < 0.0:
            normal = scaled(middle_of_wall(other), -1.0)
        else:
            return apart()
    else:
        normal = scaled(between, 1.0 / distance)
    return Meeting(True, distance - radius - other_radius, normal, plus(core, scaled(normal, radius)))


@kernel
def is_centred(ball: Feature, wall: Feature) -> bool:
    """Whether a ball, as a vertex with a radius, is on the axis of a hole's slanted wall: it touches all around."""
    center = vector_from(ball.point)
    on_axis = nearest_on_edge(wall, center)
    if ball.length != 0.0 or ball.radius == 0.0 or wall.taper == 0.0 or wall.radius >= 0.0:
        return False
    return norm(minus(on_axis.place, center)) <= CENTRED * max(ball.radius, -on_axis.radius)


@kernel
def middle_of_wall(wall: Feature) -> Vector:
    """Return the outward normal in the middle of a sector of a hole's slanted wall."""
    toward = scaled(vector_from(wall.toward), math.sqrt(1.0 - wall.taper * wall.taper))
    return plus(toward, scaled(vector_from(wall.direction), wall.taper))


@kernel
def on_rim_of(a: Shapes, i: int, b: Shapes, j: int) -> Meeting:
    """A rim of the first body, seen as the object, and a feature of the second one."""
    rim, other = a.features[i], b.features[j]
    if other.kind == FACE and rim.length < 0.0:
        return apart()
    foot = foot_on(rim, other)
    if not foot.is_within:
        return apart()
    if other.kind == FACE:
        normal = scaled(vector_from(other.direction), -1.0)
        gap = dot(normal, minus(vector_from(other.point), foot.point)) - other.radius
        return Meeting(True, gap, normal, foot.point)
    nearest, radius, side, along = vector_from(other.point), other.radius, 1.0, vector_from(other.direction)
    if other.kind == EDGE:
        on_axis = nearest_on_edge(other, foot.point)
        nearest, radius, side = on_axis.place, on_axis.radius, math.copysign(1.0, other.radius)
    elif other.kind == RIM:
        nearest = nearest_on_rim(other, foot.point)
        along = cross(along, outward_at(other, nearest))
    between, is_slanted = minus(nearest, foot.point), other.kind == EDGE and other.taper != 0.0
    is_sharp = abs(radius) < (TIP if is_slanted else SHARP) * abs(rim.length)
    if is_sharp and is_slanted:  # at a tip, which is a vertex of its own
        return without_normal(side * norm(between) - radius)
    if other.kind == VERTEX or not is_sharp:
        distance = side * norm(between)
        if distance == 0.0 or radius == 0.0:
            return without_normal(distance - radius)
        normal = scaled(between, 1.0 / distance)
        if is_sharp and is_turned(a, i, foot.point, b, j, nearest, normal, False):
            normal, distance = scaled(normal, -1.0), -distance
        return Meeting(True, distance - radius, normal, foot.point)
    crossed = cross(foot.tangent, along)
    sine = norm(crossed)
    distance = norm(between)
    if sine >= PARALLEL:
        normal = scaled(crossed, 1.0 / sine)
    elif distance > ROUNDING * abs(rim.length):  # side by side, as where one axis leans toward the other
        normal = scaled(between, 1.0 / distance)
    else:
        normal = outward_at(rim, foot.point)
    gap = dot(between, normal)
    if is_turned(a, i, foot.point, b, j, nearest, normal, gap < 0.0):
        normal, gap = scaled(normal, -1.0), -gap
    return Meeting(True, gap - radius, normal, foot.point)


@kernel
def toward_vertex(a: Shapes, i: int, b: Shapes, j: int) -> Meeting:
    """A sharp rim and a sharp vertex, which cannot touch, but be nearest to each other: the way between them."""
    if b.features[j].kind == RIM:
        return swapped(toward_vertex_from_rim(b.features[j], a.features[i]))
    return toward_vertex_from_rim(a.features[i], b.features[j])


@kernel
def toward_vertex_from_rim(rim: Feature, vertex: Feature) -> Meeting:
    foot = foot_on(rim, vertex)
    between = minus(vector_from(vertex.point), foot.point)
    distance = norm(between)
    if not foot.is_within or distance == 0.0:
        return apart()
    return Meeting(True, distance, scaled(between, 1.0 / distance), foot.point)


@kernel
def common_normal(a: Shapes, i: int, b: Shapes, j: int, met: Meeting) -> Vector:
    """Return, of a sharp rim and a sharp vertex at one place, an outward normal of the first body that is opposite to
    one of the second, if there is such a one: that of the rim which leads most out of what ends in the vertex.
    """
    if a.features[i].kind == RIM:
        return rim_normal(a.features[i], met.place, scaled(out_of_vertex(b, j), -1.0))
    there = plus(met.place, scaled(met.normal, met.gap))
    return scaled(rim_normal(b.features[j], there, scaled(out_of_vertex(a, i), -1.0)), -1.0)


@kernel
def out_of_vertex(shapes: Shapes, i: int) -> Vector:
    """Return the direction in the middle of the outward normals of a vertex, of any length."""
    out = (0.0, 0.0, 0.0)
    for f in range(shapes.features[i].first_fence, shapes.features[i].last_fence):
        out = minus(out, vector_from(shapes.fences[f].direction))
    return out


@kernel
def rim_normal(rim: Feature, point: Vector, way: Vector) -> Vector:
    """Return the outward normal of a rim at one of its points that is nearest to a direction."""
    out, axis = outward_at(rim, point), vector_from(rim.direction)
    angle = math.atan2(dot(axis, way), dot(out, way))
    angle = min(max(angle, math.asin(rim.taper)), math.asin(rim.end_taper))
    return plus(scaled(out, math.cos(angle)), scaled(axis, math.sin(angle)))


@kernel
def swapped(met: Meeting) -> Meeting:
    """Return a meeting as the other body has it."""
    return Meeting(met.is_one, met.gap, scaled(met.normal, -1.0), plus(met.place, scaled(met.normal, met.gap)))


@kernel
def twin_pair(a: Shapes, i: int, b: Shapes, j: int) -> tuple[int, int]:
    """Return the features that meet at the other place on an arc to which an edge or another rim is nearest; (-1, -1):
    there is one place.
    """
    one, other = a.features[i], b.features[j]
    if one.kind == RIM and (other.kind == EDGE or other.kind == RIM):
        return (one.twin_arc, j) if one.twin_arc >= 0 else (-1, -1)
    if one.kind == EDGE and other.kind == RIM:
        return (i, other.twin_arc) if other.twin_arc >= 0 else (-1, -1)
    return -1, -1


@kernel
def meeting_kept(moved: Shapes, i: int, b: Shapes, j: int, gap: float) -> Meeting:
    """Return how two features meet that had a gap before a motion: of two places on an arc, that with the gap nearer to
    it. Which of them is the first may have changed, as another one came in over the arc's end.

    Features of ``moved`` are placed: this one, and the other one that it is.
    """
    met, (one, other) = meeting(moved, i, b, j), twin_pair(moved, i, b, j)
    if one < 0:
        return met
    at_twin = meeting(moved, one, b, other)
    is_at_twin = not met.is_one or abs(at_twin.gap - gap) < abs(met.gap - gap)
    return at_twin if at_twin.is_one and is_at_twin else met


@kernel
def meeting(a: Shapes, i: int, b: Shapes, j: int) -> Meeting:
    """Return how feature i of the object and feature j of the cage meet, both placed in the world."""
    one, other = a.features[i].kind, b.features[j].kind
    if one == RIM:
        return on_rim_of(a, i, b, j)
    if other == RIM:
        return swapped(on_rim_of(b, j, a, i))
    if one == VERTEX and other == FACE:
        return vertex_and_face(a, i, b, j)
    if one == FACE and other == VERTEX:
        return face_and_vertex(a, i, b, j)
    if one == EDGE and other == EDGE:
        return edge_and_edge(a, i, b, j)
    if one == FACE or other == FACE:
        return apart()
    return round_ones(a, i, b, j)
