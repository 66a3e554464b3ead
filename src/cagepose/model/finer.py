"""A surface of triangles that stand for others, with each triangle divided into four: `finer`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cagepose.model.checks import FloatArray, unit_rows
from cagepose.model.sides import IntArray
from cagepose.model.surfaces import TORUS, Surface

NEWTON_STEPS = 4
"""A place near two surfaces is moved onto both so many times; each squares what is left."""
LEAST_SINE_SQUARE = 1e-5
"""Of the angle between two surfaces: with less they touch there, and a place is moved onto both half by each."""

ON_CIRCLE = 1e-7
"""Of the circle in a torus: ends of a side that differ by no more in height and distance from the axis are on one."""


def finer(
    vertices_m: FloatArray, triangles: IntArray, surfaces: Sequence[Surface], on: IntArray
) -> tuple[FloatArray, IntArray, IntArray]:
    """Return vertices, triangles and their surfaces of one that has the middles of all sides as vertices, too, each
    moved onto the surfaces beside it; parameters as of `cagepose.model.facets.Facets`, in one frame.
    """
    starts, ends = triangles, np.roll(triangles, -1, axis=1)
    pairs = np.sort(np.stack([starts, ends], axis=2).reshape(-1, 2), axis=1)
    sides, which = np.unique(pairs, axis=0, return_inverse=True)
    which = which.reshape(-1, 3)
    middles = vertices_m[sides].mean(axis=1)
    one, other = np.full(len(sides), -1), np.full(len(sides), len(surfaces))
    for k in range(3):
        np.maximum.at(one, which[:, k], on)
        np.minimum.at(other, which[:, k], on)
    for first, second in np.unique(np.stack([one, other], axis=1), axis=0).tolist():
        mine = (one == first) & (other == second)
        known = list(dict.fromkeys(surfaces[k] for k in {first, second} if k >= 0))
        if any(surface.is_round for surface in known):
            middles[mine] = onto(middles[mine], known)
            for torus in known if len(known) == 2 else ():
                if torus.kind == TORUS:
                    level = _level(vertices_m[sides[mine]], torus)
                    middles[np.flatnonzero(mine)[level]] = _around(vertices_m[sides[mine][level]], torus)
    n = len(vertices_m)
    a, b, c = triangles.T
    ab, bc, ca = n + which.T
    divided = np.stack([(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)], axis=0)
    return np.concatenate([vertices_m, middles]), divided.transpose(2, 0, 1).reshape(-1, 3), np.repeat(on, 4)


def _level(ends_m: FloatArray, torus: Surface) -> NDArray[np.bool_]:
    """Return which sides have both ends on one circle about the axis of a torus, (n,); ``ends_m`` are (n, 2, 3)."""
    seen = ends_m - np.array(torus.point_m)
    along = seen @ np.array(torus.axis)
    away = np.linalg.norm(seen - along[..., None] * np.array(torus.axis), axis=-1)
    found: NDArray[np.bool_] = np.hypot(np.ptp(along, axis=1), np.ptp(away, axis=1)) <= ON_CIRCLE * torus.core_m
    return found


def _around(ends_m: FloatArray, torus: Surface) -> FloatArray:
    """Return the places midway between ends on circles about the axis of a torus, on these circles. Another face often
    touches the torus along such a circle, and places beside it are as near to both.
    """
    origin, axis = np.array(torus.point_m), np.array(torus.axis)
    seen = ends_m - origin
    along = (seen @ axis).mean(axis=1)[:, None] * axis
    across = seen - (seen @ axis)[..., None] * axis
    radii = np.linalg.norm(across, axis=-1).mean(axis=1)
    found: FloatArray = origin + along + radii[:, None] * unit_rows(across.sum(axis=1))
    return found


def beside_round(triangles: IntArray, surfaces: Sequence[Surface], on: IntArray) -> NDArray[np.bool_]:
    """Return which triangles stand for what is round, or have a side in common with one that does, (m,)."""
    is_round: NDArray[np.bool_] = np.array([*(surface.is_round for surface in surfaces), False])[on]
    sides = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2), axis=2)
    keys = sides[..., 0] * (int(triangles.max(initial=0)) + 1) + sides[..., 1]
    is_side: NDArray[np.bool_] = np.isin(keys, keys[is_round])
    return is_side[:, 0] | is_side[:, 1] | is_side[:, 2]


def onto(places: FloatArray, surfaces: Sequence[Surface]) -> FloatArray:
    """Return places moved the shortest way onto one or two surfaces, by Newton's method."""
    if len(surfaces) == 1:
        (surface,) = surfaces
        moved: FloatArray = places - surface.heights(places)[:, None] * surface.normals(places)
        return moved
    for _ in range(NEWTON_STEPS):
        normals = np.stack([surface.normals(places) for surface in surfaces], axis=1)
        heights = np.stack([surface.heights(places) for surface in surfaces], axis=1)
        cosines = np.einsum("ij,ij->i", normals[:, 0], normals[:, 1])
        squares = (1.0 - cosines**2)[:, None]
        crossing = (heights - cosines[:, None] * heights[:, ::-1]) / np.maximum(squares, LEAST_SINE_SQUARE)
        shares = np.where(squares > LEAST_SINE_SQUARE, crossing, 0.5 * heights)
        places = places - np.einsum("ij,ijk->ik", shares, normals)
    return places
