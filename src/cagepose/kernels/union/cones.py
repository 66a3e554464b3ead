"""The cones of outward normals at corners of a surface: which edges bound them, and whether there are any normals.

The cone is the polar of all directions along which edges lead away from a corner, hollow edges too. It is cut out of
that of three edges by the other ones, one after the other.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.record import FloatArray, IntArray
from cagepose.kernels.algebra.vector import Vector, cross, dot, norm, plus, row, scaled
from cagepose.kernels.native.kernel import entry, kernel

WITHIN = 1e-9
"""Sine by which a normal may make less than a right angle with an edge."""
NARROW = 1e-8
"""A cone of normals none of which is farther within than this (a sine) has no interior."""


@entry
def find_cones(
    lasts: IntArray, tangents: FloatArray, rays: FloatArray, sides: IntArray, is_bound: NDArray[np.bool_]
) -> None:
    """Write which tangents bound the cone of normals at their corner: none, if it has no interior.

    Parameters
    ----------
    lasts
        Of each corner the last of its tangents, not included.
    tangents
        Unit vectors away from corners, (n, 3), those of one corner after those of another.
    rays, sides
        Memory for the edges of a cone, (2, n, 3), and for the tangents across its sides, (2, n); with room for three
        more than a corner has tangents.
    """
    is_bound[:] = False
    first = 0
    for last in lasts:
        _find_cone(first, last, tangents, rays, sides, is_bound)
        first = last


@kernel
def _find_cone(
    first: int, last: int, tangents: FloatArray, rays: FloatArray, sides: IntArray, is_bound: NDArray[np.bool_]
) -> None:
    one, other, third = _three(first, last, tangents)
    if third < 0:
        return
    now, n_rays = 0, 3
    three = (one, other, third)
    for k in range(3):
        across = cross(row(tangents, three[(k + 2) % 3]), row(tangents, three[k]))
        sign = -1.0 if dot(across, row(tangents, three[(k + 1) % 3])) > 0.0 else 1.0
        _write(rays[0], k, scaled(across, sign / norm(across)))
        sides[0, k] = three[k]
    for t in range(first, last):
        n_cut = _cut(t, n_rays, tangents, rays[now], sides[now], rays[1 - now], sides[1 - now])
        if n_cut < 3:
            return
        now, n_rays = 1 - now, n_cut
    inside = (0.0, 0.0, 0.0)
    for k in range(n_rays):
        inside = plus(inside, row(rays[now], k))
    size = norm(inside)
    if size == 0.0:
        return
    for t in range(first, last):
        if dot(row(tangents, t), inside) > -NARROW * size:
            return
    for k in range(n_rays):
        is_bound[sides[now, k]] = True


@kernel
def _three(first: int, last: int, tangents: FloatArray) -> tuple[int, int, int]:
    """Return three tangents that lead far out of one plane; -1: there are none."""
    other, third, widest = -1, -1, NARROW
    for t in range(first + 1, last):
        sine = norm(cross(row(tangents, first), row(tangents, t)))
        if sine > widest:
            other, widest = t, sine
    if other < 0:
        return -1, -1, -1
    across, widest = cross(row(tangents, first), row(tangents, other)), NARROW
    for t in range(first + 1, last):
        height = abs(dot(row(tangents, t), across))
        if height > widest:
            third, widest = t, height
    return first, other, third


@kernel
def _write(rays: FloatArray, k: int, ray: Vector) -> None:
    rays[k, 0], rays[k, 1], rays[k, 2] = ray


@kernel
def _cut(
    t: int, n_rays: int, tangents: FloatArray, rays: FloatArray, sides: IntArray, left: FloatArray, of_left: IntArray
) -> int:
    """Write what is left of a cone that a tangent cuts; return of how many edges, in their order around."""
    n_left = 0
    for k in range(n_rays):
        ray, following = row(rays, k), row(rays, (k + 1) % n_rays)
        beyond, next_beyond = dot(ray, row(tangents, t)), dot(following, row(tangents, t))
        if beyond <= WITHIN:
            _write(left, n_left, ray)
            of_left[n_left] = sides[k]
            n_left += 1
        if (beyond <= WITHIN) != (next_beyond <= WITHIN):
            between = plus(scaled(ray, next_beyond), scaled(following, -beyond))
            size = norm(between)
            if size == 0.0:
                return 0
            _write(left, n_left, scaled(between, 1.0 / (size if next_beyond > beyond else -size)))
            of_left[n_left] = t if beyond <= WITHIN else sides[k]
            n_left += 1
    return n_left
