"""Pieces of a curve, which is a circle, a line or a vertex, and how points are beside the whole surface that it meets:
their gap, its gradient, and what is known of its second derivatives.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.boundary.features import CIRCLE, FACE, LINE, VERTEX, Feature
from cagepose.kernels.native.kernel import kernel

LEAST_ACROSS = 0.1
"""Of a normal; it is no normal of a line if less of it is across."""


class Piece(NamedTuple):
    """A point of a curve, and how far the curve reaches to both sides of it.

    Attributes
    ----------
    point, outward, tangent
        As in `CirclePoint`; of a line, nothing is outward.
    half
        Metres along the curve.
    bend
        Curvature, 1 / metres.
    radius, taper
        Added on all sides at the point, metres; and how much less it is a metre farther along.
    """

    point: Vector
    outward: Vector
    tangent: Vector
    half: float
    bend: float
    radius: float
    taper: float


class Beside(NamedTuple):
    """How a point is beside a surface.

    Attributes
    ----------
    gap
        Metres.
    normal
        Its gradient, a unit vector out of the surface; where it has none, nothing across.
    within
        The gap is smooth around the point nearer than this, metres; inf: everywhere. No second derivative along a unit
        vector exceeds ``curvature / r``, if what is not smooth stays farther away than r.
    curvature
        See there.
    is_convex, is_concave
        Whether no second derivative is below zero, also where the gap is not smooth, or above.
    """

    gap: float
    normal: Vector
    within: float
    curvature: float
    is_convex: bool
    is_concave: bool


@kernel
def piece_of(curve: Feature, first: float, last: float) -> Piece:
    """Return the piece of a circle between two angles, or of a line between two lengths; or a vertex."""
    middle, point, axis = 0.5 * (first + last), vector_from(curve.point), vector_from(curve.direction)
    if curve.kind == VERTEX:
        return Piece(point, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0, 0.0, curve.radius, 0.0)
    if curve.kind == LINE:
        here = plus(point, scaled(axis, middle))
        radius = curve.radius - curve.taper * middle
        return Piece(here, (0.0, 0.0, 0.0), axis, 0.5 * (last - first), 0.0, radius, curve.taper)
    toward = vector_from(curve.toward)
    aside, cosine, sine = cross(axis, toward), math.cos(middle), math.sin(middle)
    outward = plus(scaled(toward, cosine), scaled(aside, sine))
    tangent = minus(scaled(aside, cosine), scaled(toward, sine))
    here = plus(point, scaled(outward, curve.length))
    return Piece(here, outward, tangent, 0.5 * (last - first) * curve.length, 1.0 / curve.length, curve.radius, 0.0)


@kernel
def beside(surface: Feature, point: Vector, sharp: bool) -> Beside:
    """Return how a point is beside a whole plane, a point, a line without end, its round side, or a circle. ``sharp``:
    of a line its core counts, and a radius around it.
    """
    seen, axis, radius = minus(point, vector_from(surface.point)), vector_from(surface.direction), surface.radius
    if surface.kind == FACE:
        return Beside(dot(axis, seen) - radius, axis, math.inf, 0.0, True, True)
    if surface.kind == VERTEX:
        away = norm(seen)
        normal = scaled(seen, 1.0 / away) if away > 0.0 else seen
        return Beside(away - radius, normal, away, 1.0, True, False)
    height = dot(seen, axis)
    across = minus(seen, scaled(axis, height))
    rho = norm(across)
    out = scaled(across, 1.0 / rho) if rho > 0.0 else across
    if surface.kind == CIRCLE:
        away = math.hypot(height, rho - surface.length)
        normal = plus(scaled(out, rho - surface.length), scaled(axis, height))
        normal = scaled(normal, 1.0 / away) if away > 0.0 else out
        return Beside(away - radius, normal, min(away, rho), 1.0, False, False)
    if sharp:
        return Beside(rho - radius, out, rho, 1.0, True, False)
    slant = math.copysign(math.sqrt(1.0 - surface.taper * surface.taper), radius)
    normal = plus(scaled(out, slant), scaled(axis, surface.taper))
    gap = slant * rho + surface.taper * height - radius
    return Beside(gap, normal, rho, abs(slant), slant > 0.0, slant < 0.0)


@kernel
def over_support(surface: Feature, facing: Vector, point: Vector) -> Beside:
    """Return how a point is beside a plane with an outward normal that something convex is behind, and touches; as a
    plane, but that a contact need not be in it.
    """
    seen, beyond = minus(point, vector_from(surface.point)), surface.radius
    if surface.kind == CIRCLE:
        beyond += surface.length * norm(cross(facing, vector_from(surface.direction)))
    return Beside(dot(facing, seen) - beyond, facing, math.inf, 0.0, True, True)


@kernel
def facing_of(surface: Feature, normal: Vector, sharp: bool) -> Vector:
    """Return the normal of a support plane that is nearly a normal; zero: none is known."""
    if surface.kind == FACE or (surface.kind == LINE and not sharp and surface.radius < 0.0):
        return (0.0, 0.0, 0.0)
    if surface.kind != LINE:
        return normal
    axis = vector_from(surface.direction)
    across = minus(normal, scaled(axis, dot(normal, axis)))
    size, taper = norm(across), 0.0 if sharp else surface.taper
    if size < LEAST_ACROSS:
        return (0.0, 0.0, 0.0)
    return plus(scaled(across, math.sqrt(1.0 - taper * taper) / size), scaled(axis, taper))


@kernel
def is_curve(one: Feature, other: Feature) -> bool:
    """Whether the first of two features is the curve, and the other one the surface: a vertex, which has no other
    points; of two circles the smaller one, of two lines the one with less of a taper.
    """
    if one.kind == VERTEX or other.kind == VERTEX:
        return bool(one.kind == VERTEX)
    if one.kind == CIRCLE and other.kind == CIRCLE:
        return bool(one.length <= other.length)
    if one.kind == LINE and other.kind == LINE:
        return bool(abs(one.taper) <= abs(other.taper))
    return bool(one.kind == CIRCLE)
