"""How two features meet: their gap, its normal and its place, equation (2.8); and whether both reach there.

What two features are to each other depends on nothing else of their bodies: a vertex is asked how far it is from the
plane of a face, a line how far from another. Whether they are the ones that can touch is told by their bounds: the
normal must be one of both, and the place on both.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.boundary.covered import is_covered
from cagepose.kernels.boundary.features import CIRCLE, FACE, LINE, VERTEX, Feature, PlacedBoundary
from cagepose.kernels.boundary.met import CENTRED, PARALLEL, SHARP, Meeting, apart, swapped, without_normal
from cagepose.kernels.boundary.reach import beyond_normals, reaches
from cagepose.kernels.boundary.tapered import nearest_on_axis, tapered_lines
from cagepose.kernels.native.kernel import kernel


@kernel
def both_reach(
    a: PlacedBoundary, i: int, b: PlacedBoundary, j: int, met: Meeting, slack: float, slack_m: float
) -> bool:
    """Whether two features can touch where they meet, equation (2.11): both reach there, and neither is covered."""
    if not met.is_one:
        return False
    one = minus(met.place, scaled(met.normal, a.features[i].radius))
    other = plus(met.place, scaled(met.normal, met.gap + b.features[j].radius))
    back = scaled(met.normal, -1.0)
    if not (reaches(a, i, met.normal, one, slack, slack_m) and reaches(b, j, back, other, slack, slack_m)):
        return False
    return not (is_covered(a, i, met.normal, one) or is_covered(b, j, back, other))


@kernel
def vertex_over_face(vertex: Feature, face: Feature) -> Meeting:
    """Return how a vertex of the object meets a face of the cage."""
    point, normal = vector_from(vertex.point), scaled(vector_from(face.direction), -1.0)
    gap = dot(normal, minus(vector_from(face.point), point)) - vertex.radius - face.radius
    return Meeting(True, gap, normal, plus(point, scaled(normal, vertex.radius)))


@kernel
def outward_share(body: PlacedBoundary, i: int, normal: Vector, core: Vector) -> float:
    """Return how much farther beyond its outward normals a feature has the opposite of a direction; zero: one without
    bounds has all directions.
    """
    feature = body.features[i]
    if feature.kind != CIRCLE and feature.first_bound == feature.last_bound:
        return 0.0
    return beyond_normals(body, i, scaled(normal, -1.0), core) - beyond_normals(body, i, normal, core)


@kernel
def is_turned(
    a: PlacedBoundary,
    i: int,
    core: Vector,
    b: PlacedBoundary,
    j: int,
    other_core: Vector,
    normal: Vector,
    otherwise: bool,
) -> bool:
    """Whether of two normals across sharp features the opposite one is out of the object, if their bounds tell."""
    out = outward_share(a, i, normal, core) + outward_share(b, j, scaled(normal, -1.0), other_core)
    return out < 0.0 if abs(out) > PARALLEL else otherwise


@kernel
def line_across_line(a: PlacedBoundary, i: int, b: PlacedBoundary, j: int) -> Meeting:
    """Return how two lines meet that cross."""
    one, other = a.features[i], b.features[j]
    u, w = vector_from(one.direction), vector_from(other.direction)
    crossed = cross(u, w)
    sine = norm(crossed)
    if sine < PARALLEL or one.radius < 0.0 or other.radius < 0.0:
        return apart()
    start = minus(vector_from(other.point), vector_from(one.point))
    if one.taper != 0.0 or other.taper != 0.0:
        return tapered_lines(one, other, start, crossed, sine)
    s = dot(cross(start, w), crossed) / (sine * sine)  # start + t w - s u is along the normal
    normal = scaled(crossed, 1.0 / sine)
    distance = dot(start, normal)
    core = plus(vector_from(one.point), scaled(u, s))
    turned = distance < 0.0
    if one.radius + other.radius < SHARP * min(one.length, other.length):
        turned = is_turned(a, i, core, b, j, core, normal, turned)
    if turned:
        normal, distance = scaled(normal, -1.0), -distance
    return Meeting(True, distance - one.radius - other.radius, normal, plus(core, scaled(normal, one.radius)))


@kernel
def between_cores(core: Vector, radius: float, others: Vector, other_radius: float, side: float) -> Meeting:
    """Return how round features meet whose cores are nearest to each other at two places."""
    between = minus(others, core)
    distance = side * norm(between)
    if abs(distance) <= CENTRED * max(abs(radius), abs(other_radius)):
        return without_normal(distance - radius - other_radius)
    normal = scaled(between, 1.0 / distance)
    return Meeting(True, distance - radius - other_radius, normal, plus(core, scaled(normal, radius)))


@kernel
def is_seated(ball: Feature, wall: Feature) -> bool:
    """Whether a vertex with a radius is on the axis of a hole's slanted wall: it is equally far from it all around."""
    if ball.kind != VERTEX or wall.kind != LINE or ball.radius == 0.0 or wall.radius >= 0.0 or wall.taper == 0.0:
        return False
    center = vector_from(ball.point)
    on_axis = nearest_on_axis(wall, center)
    return norm(minus(on_axis.place, center)) <= CENTRED * max(ball.radius, -on_axis.radius)


@kernel
def seated(ball: Feature, wall: Feature, angle: float) -> Meeting:
    """Return how a ball of the object and a hole's wall meet at an angle around the wall's axis: the gap to the plane
    that touches the wall there. A ball on the axis is as far from the wall itself, all around.
    """
    axis, toward, center = vector_from(wall.direction), vector_from(wall.toward), vector_from(ball.point)
    out = plus(scaled(toward, math.cos(angle)), scaled(cross(axis, toward), math.sin(angle)))
    slant = math.sqrt(1.0 - wall.taper * wall.taper)
    normal = minus(scaled(out, slant), scaled(axis, wall.taper))  # out of the ball, into the wall
    seen = minus(center, vector_from(wall.point))
    gap = -dot(normal, seen) - wall.radius - ball.radius
    return Meeting(True, gap, normal, plus(center, scaled(normal, ball.radius)))


@kernel
def vertex_beside_line(vertex: Feature, line: Feature) -> Meeting:
    """Return how a vertex of the object and a line of the cage meet, one of which has a radius."""
    if vertex.radius + line.radius == 0.0:
        return apart()
    nearest = nearest_on_axis(line, vector_from(vertex.point))
    if is_seated(vertex, line):
        return seated(vertex, line, 0.0)
    side = math.copysign(1.0, line.radius)
    return between_cores(vector_from(vertex.point), vertex.radius, nearest.place, nearest.radius, side)


@kernel
def meeting(a: PlacedBoundary, i: int, b: PlacedBoundary, j: int) -> Meeting:
    """Return how feature i of the object and feature j of the cage meet, none of which is a circle."""
    one, other = a.features[i], b.features[j]
    if one.kind == VERTEX and other.kind == FACE:
        return vertex_over_face(one, other)
    if one.kind == FACE and other.kind == VERTEX:
        return swapped(vertex_over_face(other, one))
    if one.kind == LINE and other.kind == LINE:
        return line_across_line(a, i, b, j)
    if one.kind == FACE or other.kind == FACE:
        return apart()
    if other.kind == LINE:
        return vertex_beside_line(one, other)
    if one.kind == LINE:
        return swapped(vertex_beside_line(other, one))
    if one.radius + other.radius == 0.0:
        return apart()
    return between_cores(vector_from(one.point), one.radius, vector_from(other.point), other.radius, 1.0)
