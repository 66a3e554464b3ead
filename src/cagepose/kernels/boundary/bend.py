"""How the gap of two features bends: its second derivative, equations (2.9) and (2.10).

With h_A and h_B the support functions of two convex bodies, their gap is the greatest over all unit normals n of
-h_A(n) - h_B(-n). So its second derivative follows from how the places of contact move when the normal turns: by C_A
and C_B, the radii of curvature of the two, across the normal. A vertex has zero, a plane infinite ones, an edge one of
each, a circle of radius r about the axis c has r / |n x c| along its tangent, below zero where its normals lead toward
its axis as at the mouth of a hole, and a radius adds itself. With v the
velocity of the object's material at the contact, and m = n x w for its angular velocity w, in the pose
(x + t, exp(w) R),

    gap'' = -n . (w x (w x a)) + v K v + 2 v L m - m P m,
    K = 1/(C_A + C_B),  L = K C_A,  P = C_A K C_B,

where a is the arm from the reference point. The normal turns by -(K v + L m). All three have limits where radii are
infinite: where C_A is finite P = C_A - C_A K C_A, where C_B is L = 1 - K C_B and P = C_B - C_B K C_B. What of the gap
is open counts to C_B. A face of the object over a point of the cage has K = 0, L = 1 across the normal and P = 0: what
a pair of features has beyond that is its bend.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.vector import (
    Matrix,
    Vector,
    cross,
    dot,
    matrix_from,
    minus,
    norm,
    plus,
    scaled,
    times,
    transposed_times,
    vector_from,
)
from cagepose.kernels.boundary.circle import outward_at
from cagepose.kernels.boundary.features import CIRCLE, FACE, LINE, PlacedBoundary
from cagepose.kernels.boundary.met import CENTRED, Meeting
from cagepose.kernels.boundary.on_circle import OnCircle
from cagepose.kernels.native.kernel import kernel

FLAT = 1e-9
"""Sine between a circle's axis and the normal: less, it is straight as an edge along its tangent."""
SIDE_BY_SIDE = 1e-6
"""Sine between edges: by less they do not cross."""
RANK_ONE = 1e-13
"""Fraction of the square of radii of curvature."""
NOTHING: Matrix = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


class Bend:
    """What two features have beyond a face over a point, in scaled twists; a record.

    Attributes
    ----------
    sliding
        Second derivative of their gap, (6, 6), metres.
    relative, share
        K and L, (3, 3): how the normal turns as they slide, radians for each metre, and as they roll.
    parallel
        P, (3, 3): how far the place where they touch moves as they roll, metres for each radian.
    has_twin, twin_sliding, twin_relative, twin_share, twin_parallel
        Whether features that bend more meet at the same place with the same normal, as where a face ends in a round
        edge; and theirs.
    on_circle
        See there.
    """

    sliding: Annotated[FloatArray, 6, 6]
    relative: Annotated[FloatArray, 3, 3]
    share: Annotated[FloatArray, 3, 3]
    parallel: Annotated[FloatArray, 3, 3]
    has_twin: bool
    twin_sliding: Annotated[FloatArray, 6, 6]
    twin_relative: Annotated[FloatArray, 3, 3]
    twin_share: Annotated[FloatArray, 3, 3]
    twin_parallel: Annotated[FloatArray, 3, 3]
    on_circle: OnCircle


class Curvatures(NamedTuple):
    """K, L and P across the normal, in the world: 1/m, no unit, m."""

    relative: Matrix
    share: Matrix
    parallel: Matrix


@kernel
def outer(a: Vector, b: Vector, factor: float) -> Matrix:
    """Return factor * a b^T."""
    return (scaled(b, factor * a[0]), scaled(b, factor * a[1]), scaled(b, factor * a[2]))


@kernel
def added(a: Matrix, b: Matrix) -> Matrix:
    return (plus(a[0], b[0]), plus(a[1], b[1]), plus(a[2], b[2]))


@kernel
def scaled_matrix(matrix: Matrix, factor: float) -> Matrix:
    return (scaled(matrix[0], factor), scaled(matrix[1], factor), scaled(matrix[2], factor))


@kernel
def across(normal: Vector, factor: float) -> Matrix:
    """Return factor times the identity across a unit normal."""
    n = outer(normal, normal, -factor)
    return (
        (n[0][0] + factor, n[0][1], n[0][2]),
        (n[1][0], n[1][1] + factor, n[1][2]),
        (n[2][0], n[2][1], n[2][2] + factor),
    )


class Side(NamedTuple):
    """Radii of curvature of one body across the normal: ``radius`` in all directions, ``arc`` more along the unit
    vector ``tangent``, and none that is finite along ``line``, if it is an edge.
    """

    radius: float
    arc: float
    tangent: Vector
    is_edge: bool
    line: Vector


@kernel
def side_at(body: PlacedBoundary, i: int, normal: Vector, core: Vector, is_around: bool) -> Side:
    """Return the radii of curvature of a feature that is no face, with this outward normal at a place of its core.

    ``is_around``: of a circle that is equally far along an arc, any place is one that touches by itself, as a vertex.
    """
    feature, none = body.features[i], (0.0, 0.0, 0.0)
    if feature.kind == LINE:
        u, taper = vector_from(feature.direction), feature.taper
        if taper == 0.0:
            return Side(feature.radius, 0.0, none, True, u)
        square = 1.0 - taper * taper
        radius = feature.radius - taper * dot(u, minus(core, vector_from(feature.point))) / square
        return Side(radius, 0.0, none, True, scaled(minus(u, scaled(normal, taper)), 1.0 / math.sqrt(square)))
    if feature.kind == CIRCLE and not is_around:
        axis, outward = vector_from(feature.direction), outward_at(feature, core)
        tangent, sine = cross(axis, outward), norm(cross(axis, normal))
        if sine <= FLAT:  # what bends along the normal's plane alone is straight across it
            return Side(feature.radius, 0.0, none, True, tangent)
        arc = math.copysign(feature.length / sine, dot(normal, outward))
        return Side(feature.radius, arc, tangent, False, none)
    return Side(feature.radius, 0.0, none, False, none)


@kernel
def of_crossing_edges(one: Side, other: Side, normal: Vector, gap: float) -> Curvatures:
    """Return those of edges that cross."""
    u, radius = one.line, one.radius
    cosine, distance = dot(u, other.line), gap + one.radius + other.radius
    dual = scaled(minus(u, scaled(other.line, cosine)), 1.0 / (1.0 - cosine * cosine))  # dual . u = 1, dual . line = 0
    parallel = added(across(normal, radius), outer(u, u, distance * dot(dual, dual)))
    parallel = added(parallel, added(outer(dual, u, -radius), outer(u, dual, -radius)))
    return Curvatures(NOTHING, outer(dual, u, 1.0), parallel)


@kernel
def finite(side: Side, normal: Vector) -> Matrix:
    """Return the radii of curvature that are finite, as a matrix across the normal."""
    return added(across(normal, side.radius), outer(side.tangent, side.tangent, side.arc))


@kernel
def inverse_across(matrix: Matrix, normal: Vector) -> Matrix:
    """Return the inverse of a symmetric matrix across a unit normal: its adjugate there over its determinant; of rank
    one, as of two sharp circles with one tangent, the pseudo-inverse.
    """
    trace = matrix[0][0] + matrix[1][1] + matrix[2][2]
    squares = dot(matrix[0], matrix[0]) + dot(matrix[1], matrix[1]) + dot(matrix[2], matrix[2])
    if abs(trace * trace - squares) <= RANK_ONE * squares:
        return scaled_matrix(matrix, 1.0 / squares)
    factor = 2.0 / (trace * trace - squares)
    whole = across(normal, trace * factor)
    return added(whole, scaled_matrix(matrix, -factor))


@kernel
def product(a: Matrix, b: Matrix) -> Matrix:
    """Return a b, of a symmetric b."""
    return (times(b, a[0]), times(b, a[1]), times(b, a[2]))


@kernel
def of_finite(one: Side, other: Side, normal: Vector, gap: float) -> Curvatures:
    """Return those of two features, one of them an edge at most: what the one without an edge moves by is finite.
    Of two edges side by side, as a flat disc's rim is along a roller, one counts.
    """
    c_one, c_other = finite(one, normal), added(finite(other, normal), across(normal, gap))
    both = added(c_one, c_other)
    if one.is_edge or other.is_edge:
        free = cross(normal, one.line if one.is_edge else other.line)
        radius = dot(free, times(both, free))
        is_around = abs(radius) <= CENTRED * max(abs(one.radius), abs(other.radius))  # a ball may touch anywhere there
        relative = NOTHING if is_around else outer(free, free, 1.0 / radius)
    else:
        relative = inverse_across(both, normal)
    moved = c_other if one.is_edge else c_one
    parallel = added(moved, scaled_matrix(product(product(moved, relative), moved), -1.0))
    share = product(relative, moved)
    if one.is_edge:
        share = added(across(normal, 1.0), scaled_matrix(share, -1.0))
    return Curvatures(relative, share, parallel)


@kernel
def curvatures(a: PlacedBoundary, i: int, b: PlacedBoundary, j: int, met: Meeting, is_around: bool) -> Curvatures:
    """Return K, L and P where feature i of the object and feature j of the cage meet.

    ``is_around`` as in `touching.is_around`: a circle is equally far there along an arc.
    """
    one, other, normal, back = a.features[i], b.features[j], met.normal, scaled(met.normal, -1.0)
    there = plus(met.place, scaled(normal, met.gap + other.radius))
    core = minus(met.place, scaled(normal, one.radius))
    if other.kind == FACE:
        return Curvatures(NOTHING, NOTHING, finite(side_at(a, i, normal, core, is_around), normal))
    side = side_at(b, j, back, there, is_around and one.kind != CIRCLE)  # of two circles one touches by itself
    if one.kind == FACE:
        parallel = added(finite(side, normal), across(normal, met.gap))
        return Curvatures(NOTHING, across(normal, 1.0), parallel)
    own = side_at(a, i, normal, core, is_around)
    if own.is_edge and side.is_edge and norm(cross(own.line, side.line)) > SIDE_BY_SIDE:
        return of_crossing_edges(own, side, normal, met.gap)
    return of_finite(own, side, normal, met.gap)


@kernel
def write_bend(found: Curvatures, normal: Vector, arm: Vector, axes: Matrix, radii: Vector, out: Bend) -> None:
    """Write the bend of a pair of features that touch at an arm from the reference point, for travels along the axes of
    the world and turns about the rows of ``axes`` in units of one over ``radii``. It has no twin.
    """
    out.has_twin = False
    write_sliding(found, normal, arm, axes, radii, out.sliding)
    write_rows(found.relative, out.relative)
    write_rows(found.share, out.share)
    write_rows(found.parallel, out.parallel)


@kernel
def write_twin(found: Curvatures, normal: Vector, arm: Vector, axes: Matrix, radii: Vector, out: Bend) -> None:
    """Write the bend of the features that bend more; see `write_bend`."""
    out.has_twin = True
    write_sliding(found, normal, arm, axes, radii, out.twin_sliding)
    write_rows(found.relative, out.twin_relative)
    write_rows(found.share, out.twin_share)
    write_rows(found.parallel, out.twin_parallel)


@kernel
def turned(matrix: Matrix, by: Matrix) -> Matrix:
    """Return R m R^T."""
    return (
        times(by, transposed_times(matrix, by[0])),
        times(by, transposed_times(matrix, by[1])),
        times(by, transposed_times(matrix, by[2])),
    )


@kernel
def write_turned(bend: Bend, by: Matrix, normal: Vector, arm: Vector, axes: Matrix, radii: Vector, out: Bend) -> None:
    """Write the bend of a pair of features at another place of a circle, from that at one of its places: both features
    are round about its axis, and ``by`` turns the one place into the other. See `write_bend`.
    """
    there = Curvatures(
        turned(matrix_from(bend.relative), by),
        turned(matrix_from(bend.share), by),
        turned(matrix_from(bend.parallel), by),
    )
    write_bend(there, normal, arm, axes, radii, out)
    if bend.has_twin:
        there = Curvatures(
            turned(matrix_from(bend.twin_relative), by),
            turned(matrix_from(bend.twin_share), by),
            turned(matrix_from(bend.twin_parallel), by),
        )
        write_twin(there, normal, arm, axes, radii, out)


@kernel
def write_rows(matrix: Matrix, out: FloatArray) -> None:
    for j in range(3):
        for k in range(3):
            out[j, k] = matrix[j][k]


@kernel
def write_sliding(found: Curvatures, normal: Vector, arm: Vector, axes: Matrix, radii: Vector, out: FloatArray) -> None:
    share = added(found.share, across(normal, -1.0))
    for j in range(6):
        one, turned = ways(j, normal, arm, axes, radii)
        drawn, shared, kept = times(found.relative, one), times(share, turned), times(found.parallel, turned)
        for k in range(j + 1):
            other, other_turned = ways(k, normal, arm, axes, radii)
            value = dot(other, drawn) + dot(other, shared) + dot(one, times(share, other_turned))
            out[j, k] = out[k, j] = value - dot(other_turned, kept)


@kernel
def bends_by(found: Curvatures) -> float:
    """Return how much features bend away from each other: the sum of K's principal values, 1/m."""
    return found.relative[0][0] + found.relative[1][1] + found.relative[2][2]


@kernel
def ways(component: int, normal: Vector, arm: Vector, axes: Matrix, radii: Vector) -> tuple[Vector, Vector]:
    """Return v and m of one component of a scaled twist."""
    if component < 3:
        along = (
            1.0 if component == 0 else 0.0,
            1.0 if component == 1 else 0.0,
            1.0 if component == 2 else 0.0,
        )
        return along, (0.0, 0.0, 0.0)
    spin = scaled(axes[component - 3], 1.0 / radii[component - 3])
    return cross(spin, arm), cross(normal, spin)
