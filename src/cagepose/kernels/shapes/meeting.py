"""How two features meet: gap, normal and place, and the two matrices of second order, equations (2.8) to (2.10).

With h_A and h_B the support functions of two convex bodies, their gap is the greatest over all unit normals n of
-h_A(n) - h_B(-n). So its second derivative follows from how the places of contact move when the normal turns: by C_A and
C_B, the radii of curvature of the two, across the normal. A vertex has zero, a plane infinite ones, an edge one of each,
and a radius adds itself. With v the velocity of the object's material at the contact, and m = n x w for its angular
velocity w,

    gap'' = -n . (w x (w x a)) + v K v + 2 v L m - m P m,
    K = 1/(C_A + C_B),  L = K C_A,  P = C_A K C_B,

where a is the arm from the reference point. All three have limits where radii are infinite. What of the gap is open
counts to C_B.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.vector import Matrix, Vector, cross, dot, minus, norm, plus, row, scaled
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.shapes.features import EDGE, FACE, VERTEX, Features

PARALLEL = 1e-9
"""Sine: edges that make a smaller angle lie side by side, and meet at their ends."""

NOTHING: Matrix = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


class Meeting(NamedTuple):
    """Two features, the first of the object.

    Attributes
    ----------
    is_there
        Whether their closest points lie on both, and the normal is one of both: they can touch here.
    gap
        Between the rounded features; below zero: how deep.
    normal, place
        Outward unit normal of the object; the object's point of contact, in the world.
    relative, share, parallel
        K, L and P, across the normal, in the world.
    """

    is_there: bool
    gap: float
    normal: Vector
    place: Vector
    relative: Matrix
    share: Matrix
    parallel: Matrix


@kernel
def apart() -> Meeting:
    """Return that two features do not meet."""
    zero = (0.0, 0.0, 0.0)
    return Meeting(False, math.inf, zero, zero, NOTHING, NOTHING, NOTHING)


@kernel
def outer(a: Vector, b: Vector, factor: float) -> Matrix:
    """Return factor * a b^T."""
    return (scaled(b, factor * a[0]), scaled(b, factor * a[1]), scaled(b, factor * a[2]))


@kernel
def added(a: Matrix, b: Matrix) -> Matrix:
    return (plus(a[0], b[0]), plus(a[1], b[1]), plus(a[2], b[2]))


@kernel
def across(normal: Vector, factor: float) -> Matrix:
    """Return factor times the identity across a unit normal."""
    n = outer(normal, normal, -factor)
    return ((n[0][0] + factor, n[0][1], n[0][2]), (n[1][0], n[1][1] + factor, n[1][2]), (n[2][0], n[2][1], n[2][2] + factor))


@kernel
def has_normal(features: Features, i: int, normal: Vector, slack: float) -> bool:
    """Whether a vertex or an edge has this outward normal, to the sine ``slack``."""
    for f in range(features.first_fences[i], features.first_fences[i + 1]):
        if dot(row(features.fences, f), normal) > slack:
            return False
    return True


@kernel
def holds_point(features: Features, i: int, point: Vector, slack_m: float) -> bool:
    """Whether a point, as far as it lies along a face, lies in it."""
    seen = minus(point, row(features.points, i))
    for f in range(features.first_fences[i], features.first_fences[i + 1]):
        if dot(row(features.fences, f), seen) > features.bounds[f] + slack_m:
            return False
    return True


@kernel
def vertex_and_face(a: Features, i: int, b: Features, j: int, slack: float, slack_m: float) -> Meeting:
    """A vertex of the object and a face of the cage."""
    vertex, radius = row(a.points, i), a.radii[i]
    normal = scaled(row(b.directions, j), -1.0)
    if not has_normal(a, i, normal, slack) or not holds_point(b, j, vertex, slack_m):
        return apart()
    gap = dot(normal, minus(row(b.points, j), vertex)) - radius - b.radii[j]
    return Meeting(
        True, gap, normal, plus(vertex, scaled(normal, radius)), NOTHING, NOTHING, across(normal, radius)
    )


@kernel
def face_and_vertex(a: Features, i: int, b: Features, j: int, slack: float, slack_m: float) -> Meeting:
    """A face of the object and a vertex of the cage."""
    vertex, normal = row(b.points, j), row(a.directions, i)
    if not has_normal(b, j, scaled(normal, -1.0), slack) or not holds_point(a, i, vertex, slack_m):
        return apart()
    height = dot(normal, minus(vertex, row(a.points, i))) - a.radii[i]
    place = minus(vertex, scaled(normal, height))
    return Meeting(True, height - b.radii[j], normal, place, NOTHING, across(normal, 1.0), across(normal, height))


@kernel
def edges_cross(a: Features, i: int, b: Features, j: int, slack: float, slack_m: float) -> Meeting:
    """Two edges that cross."""
    u, w = row(a.directions, i), row(b.directions, j)
    crossed = cross(u, w)
    sine = norm(crossed)
    if sine < PARALLEL:
        return apart()
    start = minus(row(b.points, j), row(a.points, i))
    # start + t w - s u is along the normal
    s = dot(cross(start, w), crossed) / (sine * sine)
    t = dot(cross(start, u), crossed) / (sine * sine)
    if s < -slack_m or s > a.lengths[i] + slack_m or t < -slack_m or t > b.lengths[j] + slack_m:
        return apart()
    normal = scaled(crossed, 1.0 / sine)
    distance = dot(start, normal)
    if distance < 0.0:
        normal, distance = scaled(normal, -1.0), -distance
    radius, others = a.radii[i], b.radii[j]
    if not has_normal(a, i, normal, slack) or not has_normal(b, j, scaled(normal, -1.0), slack):
        # edges without a radius may be a little into each other
        normal, distance = scaled(normal, -1.0), -distance
        if radius + others > 0.0 or distance < -slack_m or not has_normal(a, i, normal, slack):
            return apart()
        if not has_normal(b, j, scaled(normal, -1.0), slack):
            return apart()
    place = plus(plus(row(a.points, i), scaled(u, s)), scaled(normal, radius))
    cosine = dot(u, w)
    dual = scaled(minus(u, scaled(w, cosine)), 1.0 / (sine * sine))  # u* . u = 1, u* . w = 0
    parallel = added(across(normal, radius), outer(u, u, distance * dot(dual, dual)))
    parallel = added(parallel, added(outer(dual, u, -radius), outer(u, dual, -radius)))
    return Meeting(True, distance - radius - others, normal, place, NOTHING, outer(dual, u, 1.0), parallel)


@kernel
def round_ones(a: Features, i: int, b: Features, j: int, slack: float, slack_m: float) -> Meeting:
    """A vertex and an edge, or two vertices, with a radius: their distance."""
    radius, others = a.radii[i], b.radii[j]
    if radius + others == 0.0:
        return apart()
    on_object, on_cage, along = row(a.points, i), row(b.points, j), (0.0, 0.0, 0.0)
    if a.kinds[i] == EDGE:
        along = row(a.directions, i)
        s = dot(minus(on_cage, on_object), along)
        if s < -slack_m or s > a.lengths[i] + slack_m:
            return apart()
        on_object = plus(on_object, scaled(along, s))
    elif b.kinds[j] == EDGE:
        along = row(b.directions, j)
        s = dot(minus(on_object, on_cage), along)
        if s < -slack_m or s > b.lengths[j] + slack_m:
            return apart()
        on_cage = plus(on_cage, scaled(along, s))
    between = minus(on_cage, on_object)
    distance = norm(between)
    if distance == 0.0:
        return apart()
    normal = scaled(between, 1.0 / distance)
    if not has_normal(a, i, normal, slack) or not has_normal(b, j, scaled(normal, -1.0), slack):
        return apart()
    share = radius / distance
    rest = distance - radius
    relative = added(across(normal, 1.0 / distance), outer(along, along, -1.0 / distance))
    shared = added(across(normal, share), outer(along, along, -share))
    parallel = added(across(normal, share * rest), outer(along, along, -share * rest))
    if a.kinds[i] == EDGE:
        shared, parallel = added(shared, outer(along, along, 1.0)), added(parallel, outer(along, along, rest))
    elif b.kinds[j] == EDGE:
        parallel = added(parallel, outer(along, along, radius))
    place = plus(on_object, scaled(normal, radius))
    return Meeting(True, distance - radius - others, normal, place, relative, shared, parallel)


@kernel
def meeting(a: Features, i: int, b: Features, j: int, slack: float, slack_m: float) -> Meeting:
    """Return how feature i of the object and feature j of the cage meet, both placed in the world.

    Parameters
    ----------
    a, i, b, j
        The features.
    slack, slack_m
        How far beyond its end a feature still counts: the sine of an angle, and metres.
    """
    one, other = a.kinds[i], b.kinds[j]
    if one == VERTEX and other == FACE:
        return vertex_and_face(a, i, b, j, slack, slack_m)
    if one == FACE and other == VERTEX:
        return face_and_vertex(a, i, b, j, slack, slack_m)
    if one == EDGE and other == EDGE:
        return edges_cross(a, i, b, j, slack, slack_m)
    if one == FACE or other == FACE:
        return apart()
    return round_ones(a, i, b, j, slack, slack_m)
