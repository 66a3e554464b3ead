"""How the gap of two features bends: its second derivative, equations (2.9) and (2.10).

With h_A and h_B the support functions of two convex bodies, their gap is the greatest over all unit normals n of
-h_A(n) - h_B(-n). So its second derivative follows from how the places of contact move when the normal turns: by C_A
and C_B, the radii of curvature of the two, across the normal. A vertex has zero, a plane infinite ones, an edge one of
each, and a radius adds itself. With v the velocity of the object's material at the contact, and m = n x w for its
angular velocity w, in the pose (x + t, exp(w) R),

    gap'' = -n . (w x (w x a)) + v K v + 2 v L m - m P m,
    K = 1/(C_A + C_B),  L = K C_A,  P = C_A K C_B,

where a is the arm from the reference point. All three have limits where radii are infinite. What of the gap is open
counts to C_B. A face of the object over a point of the cage has K = 0, L = 1 across the normal and P = 0: what a pair
of features has beyond that is its bend.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.vector import Matrix, Vector, cross, dot, minus, plus, scaled, times, vector_from
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.shapes.features import EDGE, FACE, VERTEX, Shapes
from cagepose.kernels.shapes.meeting import Meeting

NOTHING: Matrix = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


class Bend:
    """What two features have beyond a face over a point, in scaled twists; a record.

    Attributes
    ----------
    sliding
        Second derivative of their gap, (6, 6), metres.
    relative
        K, (3, 3): how the normal turns as they slide, radians for each metre.
    parallel
        P, (3, 3): how far the place where they touch moves as they roll, metres for each radian.
    has_twin, twin_sliding, twin_parallel
        Whether features that bend more meet at the same place with the same normal, as where a face ends in a round
        edge; and theirs.
    """

    sliding: Annotated[FloatArray, 6, 6]
    relative: Annotated[FloatArray, 3, 3]
    parallel: Annotated[FloatArray, 3, 3]
    has_twin: bool
    twin_sliding: Annotated[FloatArray, 6, 6]
    twin_parallel: Annotated[FloatArray, 3, 3]


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
def across(normal: Vector, factor: float) -> Matrix:
    """Return factor times the identity across a unit normal."""
    n = outer(normal, normal, -factor)
    return (
        (n[0][0] + factor, n[0][1], n[0][2]),
        (n[1][0], n[1][1] + factor, n[1][2]),
        (n[2][0], n[2][1], n[2][2] + factor),
    )


@kernel
def of_crossing_edges(u: Vector, w: Vector, normal: Vector, radius: float, distance: float) -> Curvatures:
    """Return those of edges along u and w, so far apart."""
    cosine = dot(u, w)
    dual = scaled(minus(u, scaled(w, cosine)), 1.0 / (1.0 - cosine * cosine))  # dual . u = 1, dual . w = 0
    parallel = added(across(normal, radius), outer(u, u, distance * dot(dual, dual)))
    parallel = added(parallel, added(outer(dual, u, -radius), outer(u, dual, -radius)))
    return Curvatures(NOTHING, outer(dual, u, 1.0), parallel)


@kernel
def of_round_ones(a: Shapes, i: int, b: Shapes, j: int, normal: Vector, distance: float) -> Curvatures:
    """Return those of a vertex and an edge, or of two vertices, with a radius, so far apart."""
    radius = a.features[i].radius
    rest = distance - radius
    along = (0.0, 0.0, 0.0)
    if a.features[i].kind == EDGE:
        along = vector_from(a.features[i].direction)
    elif b.features[j].kind == EDGE:
        along = vector_from(b.features[j].direction)
    share = radius / distance
    relative = added(across(normal, 1.0 / distance), outer(along, along, -1.0 / distance))
    shared = added(across(normal, share), outer(along, along, -share))
    parallel = added(across(normal, share * rest), outer(along, along, -share * rest))
    if a.features[i].kind == EDGE:
        return Curvatures(relative, added(shared, outer(along, along, 1.0)), added(parallel, outer(along, along, rest)))
    return Curvatures(relative, shared, added(parallel, outer(along, along, radius)))


@kernel
def curvatures(a: Shapes, i: int, b: Shapes, j: int, met: Meeting) -> Curvatures:
    """Return K, L and P where feature i of the object and feature j of the cage meet."""
    one, other = a.features[i].kind, b.features[j].kind
    radius = a.features[i].radius
    if one == VERTEX and other == FACE:
        return Curvatures(NOTHING, NOTHING, across(met.normal, radius))
    if one == FACE and other == VERTEX:
        return Curvatures(NOTHING, across(met.normal, 1.0), across(met.normal, met.gap + b.features[j].radius))
    distance = met.gap + radius + b.features[j].radius
    if one == EDGE and other == EDGE:
        u, w = vector_from(a.features[i].direction), vector_from(b.features[j].direction)
        return of_crossing_edges(u, w, met.normal, radius, distance)
    return of_round_ones(a, i, b, j, met.normal, distance)


@kernel
def write_bend(found: Curvatures, normal: Vector, arm: Vector, axes: Matrix, radii: Vector, out: Bend) -> None:
    """Write the bend of a pair of features that touch at an arm from the reference point, for travels along the axes of
    the world and turns about the rows of ``axes`` in units of one over ``radii``. It has no twin.
    """
    out.has_twin = False
    write_sliding(found, normal, arm, axes, radii, out.sliding)
    write_rows(found.relative, out.relative)
    write_rows(found.parallel, out.parallel)


@kernel
def write_twin(found: Curvatures, normal: Vector, arm: Vector, axes: Matrix, radii: Vector, out: Bend) -> None:
    """Write the bend of the features that bend more; see `write_bend`."""
    out.has_twin = True
    write_sliding(found, normal, arm, axes, radii, out.twin_sliding)
    write_rows(found.parallel, out.twin_parallel)


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
