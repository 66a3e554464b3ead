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
from cagepose.kernels.shapes.features import EDGE, FACE, VERTEX, Shapes

PARALLEL = 1e-7
"""Sine: edges that make a smaller angle lie side by side, and meet at their ends."""

SHARP = 1e-6
"""Of the length of edges: those of a smaller radius, if any, are told by their faces which way is out, as cores may be
into each other by the touch tolerance; those of a greater one by where they are."""


class Meeting(NamedTuple):
    """Two features, the first of the object.

    Attributes
    ----------
    is_one
        Whether features of these kinds can touch.
    gap
        Between the rounded features; below zero: how deep, metres.
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
def farthest_beyond(shapes: Shapes, i: int, normal: Vector) -> float:
    """Return how far a direction is beyond the outward normals of a vertex or an edge, a sine; -inf: all are."""
    farthest = -math.inf
    for f in range(shapes.features[i].first_fence, shapes.features[i].last_fence):
        farthest = max(farthest, dot(vector_from(shapes.fences[f].direction), normal))
    return farthest


@kernel
def reaches(shapes: Shapes, i: int, normal: Vector, core: Vector, slack: float, slack_m: float) -> bool:
    """Whether a feature has this outward normal at this point of its core, to a sine and a length beyond its end."""
    feature = shapes.features[i]
    seen = minus(core, vector_from(feature.point))
    if feature.kind == FACE:
        for f in range(feature.first_fence, feature.last_fence):
            if dot(vector_from(shapes.fences[f].direction), seen) > shapes.fences[f].bound + slack_m:
                return False
        return True
    if feature.kind == EDGE:
        along = dot(vector_from(feature.direction), seen)
        if along < -slack_m or along > feature.length + slack_m:
            return False
    return farthest_beyond(shapes, i, normal) <= slack


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
def outward_side(shapes: Shapes, i: int, normal: Vector) -> float:
    """Return how much farther beyond its outward normals an edge has the opposite of a direction; zero: an edge without
    faces has all directions.
    """
    feature = shapes.features[i]
    if feature.first_fence == feature.last_fence:
        return 0.0
    return farthest_beyond(shapes, i, scaled(normal, -1.0)) - farthest_beyond(shapes, i, normal)


@kernel
def edge_and_edge(a: Shapes, i: int, b: Shapes, j: int) -> Meeting:
    """Two edges that cross."""
    u, w = vector_from(a.features[i].direction), vector_from(b.features[j].direction)
    crossed = cross(u, w)
    sine = norm(crossed)
    if sine < PARALLEL:
        return apart()
    start = minus(vector_from(b.features[j].point), vector_from(a.features[i].point))
    s = dot(cross(start, w), crossed) / (sine * sine)  # start + t w - s u is along the normal
    normal = scaled(crossed, 1.0 / sine)
    distance = dot(start, normal)
    radius, others = a.features[i].radius, b.features[j].radius
    turned = distance < 0.0
    if radius + others < SHARP * min(
        a.features[i].length, b.features[j].length
    ):  # they may be a little into each other
        out = outward_side(a, i, normal) - outward_side(b, j, normal)
        turned = out < 0.0 if abs(out) > PARALLEL else turned
    if turned:
        normal, distance = scaled(normal, -1.0), -distance
    place = plus(plus(vector_from(a.features[i].point), scaled(u, s)), scaled(normal, radius))
    return Meeting(True, distance - radius - others, normal, place)


@kernel
def round_ones(a: Shapes, i: int, b: Shapes, j: int) -> Meeting:
    """A vertex and an edge, or two vertices, with a radius: their distance."""
    radius, others = a.features[i].radius, b.features[j].radius
    if radius + others == 0.0:
        return apart()
    one, other = vector_from(a.features[i].point), vector_from(b.features[j].point)
    if a.features[i].kind == EDGE:
        along = vector_from(a.features[i].direction)
        one = plus(one, scaled(along, dot(minus(other, one), along)))
    elif b.features[j].kind == EDGE:
        along = vector_from(b.features[j].direction)
        other = plus(other, scaled(along, dot(minus(one, other), along)))
    between = minus(other, one)
    distance = norm(between)
    if distance == 0.0:
        return apart()
    normal = scaled(between, 1.0 / distance)
    return Meeting(True, distance - radius - others, normal, plus(one, scaled(normal, radius)))


@kernel
def meeting(a: Shapes, i: int, b: Shapes, j: int) -> Meeting:
    """Return how feature i of the object and feature j of the cage meet, both placed in the world."""
    one, other = a.features[i].kind, b.features[j].kind
    if one == VERTEX and other == FACE:
        return vertex_and_face(a, i, b, j)
    if one == FACE and other == VERTEX:
        return face_and_vertex(a, i, b, j)
    if one == EDGE and other == EDGE:
        return edge_and_edge(a, i, b, j)
    if one == FACE or other == FACE:
        return apart()
    return round_ones(a, i, b, j)
