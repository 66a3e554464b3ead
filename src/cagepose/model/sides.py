"""Which triangles of a closed surface lie beside each other: `twins_of`, `beside`."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from cagepose.model.checks import FloatArray

IntArray = NDArray[np.int64]


def starts_and_ends(triangles: IntArray) -> tuple[IntArray, IntArray]:
    """Return the vertices at which each side of triangles (m, 3) starts and ends, (3 m,): side k of triangle t is
    3 t + k.
    """
    return triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()


def open_sides(triangles: IntArray) -> IntArray:
    """Return the sides that are not as often a side of others the other way round."""
    starts, ends = starts_and_ends(triangles)
    n_vertices = int(triangles.max(initial=0)) + 1
    keys, balance = np.minimum(starts, ends) * n_vertices + np.maximum(starts, ends), np.where(starts < ends, 1, -1)
    _, at, n_sides = np.unique(keys, return_inverse=True, return_counts=True)
    total = np.bincount(at.ravel(), balance, minlength=len(n_sides))
    found: IntArray = np.flatnonzero(total[at.ravel()] != 0.0)
    return found


def twins_of(vertices: FloatArray, triangles: IntArray) -> IntArray:
    """Return the side of another triangle, the other way round, that each side of a closed surface goes on at, (3 m,).

    Where more than two triangles have a side, as where two bodies touch along an edge, the two are twins that bound
    material together, without another one between them.

    Parameters
    ----------
    vertices
        (n, 3).
    triangles
        Of a closed surface, counter-clockwise seen from outside, (m, 3).
    """
    starts, ends = starts_and_ends(triangles)
    low, high, is_back = np.minimum(starts, ends), np.maximum(starts, ends), starts > ends
    order = np.lexsort((is_back, high, low))
    keys = low[order] * (int(triangles.max()) + 1) + high[order]
    firsts = np.flatnonzero(np.append(True, keys[1:] != keys[:-1]))
    counts = np.diff(firsts, append=len(keys))
    twins = np.empty(len(starts), np.int64)
    pairs = firsts[counts == 2]
    one, other = order[pairs], order[pairs + 1]
    twins[one], twins[other] = other, one
    for first, count in zip(firsts[counts != 2].tolist(), counts[counts != 2].tolist(), strict=True):
        _pair_around(vertices, triangles, order[first : first + count], twins)
    return twins


def _pair_around(vertices: FloatArray, triangles: IntArray, sides: IntArray, twins: IntArray) -> None:
    """Write the twins of sides that are all at one place: triangles are sorted by their angles around it."""
    starts, ends = starts_and_ends(triangles[sides // 3])
    k = 3 * np.arange(len(sides)) + sides % 3
    begin, end, third = starts[k], ends[k], np.roll(triangles[sides // 3], 1, axis=1).ravel()[k]
    axis = vertices[max(begin[0], end[0])] - vertices[min(begin[0], end[0])]
    arms = vertices[third] - vertices[begin]
    arms = arms - np.outer(arms @ axis, axis) / (axis @ axis)
    first = arms[0] / np.linalg.norm(arms[0])
    second = np.cross(axis, first) / np.linalg.norm(axis)
    angles = np.arctan2(arms @ second, arms @ first)
    is_back = begin > end  # material lies at greater angles of what leads back
    around, free = np.lexsort((is_back, angles)).tolist(), set(range(len(sides)))
    for one, other in pairwise([*around, *around]):
        if is_back[one] and not is_back[other] and {one, other} <= free:
            twins[sides[one]], twins[sides[other]] = sides[other], sides[one]
            free -= {one, other}
    for one, other in zip(*([k for k in free if is_back[k] == back] for back in (True, False)), strict=True):
        twins[sides[one]], twins[sides[other]] = sides[other], sides[one]  # of a surface that crosses itself
