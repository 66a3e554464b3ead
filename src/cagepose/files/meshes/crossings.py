"""Where and how deep a surface runs through itself: `deepest_crossing`."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cagepose.files.meshes.manifolds import Triangles
from cagepose.files.meshes.tolerances import LEAST_PYRAMID, ROUNDING_OF_MESH
from cagepose.model.checks import FloatArray
from cagepose.model.near_pairs import near_pairs
from cagepose.model.sides import IntArray

PAIRS_AT_ONCE = 200_000
"""Pairs of triangles that are asked together: arrays of more take much memory."""
MOST_PAIRS = 60
"""Pairs of triangles of which boxes overlap, for each triangle: a surface that folds more is asked no further."""


class Crossing(NamedTuple):
    """The deepest of the places where two triangles of a surface cross, how deep that is, and how many there are."""

    place: FloatArray
    depth: float
    n_crossings: int


def deepest_crossing(mesh: Triangles) -> Crossing | None:
    """Return where a closed surface runs through itself by the most; None: nowhere by more than rounding.

    Two triangles cross if each has corners on both sides of the other, and the parts of the line between their planes
    that are in them overlap (Moeller). How far the corners are off, and how long the overlap is: the least of these is
    the depth.
    """
    if len(mesh.faces) == 0 or _is_star(mesh):
        return None
    allowed = ROUNDING_OF_MESH * mesh.size
    corners = mesh.vertices[mesh.faces]
    pairs = near_pairs(corners.min(axis=1), corners.max(axis=1), MOST_PAIRS * len(corners))
    deepest, n_crossings = None, 0
    for rows in np.array_split(pairs, 1 + len(pairs) // PAIRS_AT_ONCE):
        depths, places = _crossed(mesh, rows[:, 0], rows[:, 1], allowed)
        n_crossings += len(depths)
        if len(depths) and (deepest is None or depths.max() > deepest[0]):
            deepest = float(depths.max()), places[int(depths.argmax())]
    return None if deepest is None else Crossing(deepest[1], deepest[0], n_crossings)


def _crossed(mesh: Triangles, one: IntArray, other: IntArray, allowed: float) -> tuple[FloatArray, FloatArray]:
    """Return how deep triangles cross, of those that do by more than ``allowed``, and where, (n, 3)."""
    for swapped in (False, True):
        heights = _heights(mesh, *((other, one) if swapped else (one, other)))
        is_across = (heights.min(axis=1) < -allowed) & (heights.max(axis=1) > allowed)
        one, other = one[is_across], other[is_across]
    line = np.cross(mesh.normals[one], mesh.normals[other])
    line /= np.maximum(np.linalg.norm(line, axis=1, keepdims=True), np.finfo(float).tiny)
    depths, begins, ends, origin = [], [], [], mesh.vertices[mesh.faces[one, 0]]
    for triangles, heights in ((one, _heights(mesh, one, other)), (other, _heights(mesh, other, one))):
        depths.append(np.minimum(-heights.min(axis=1), heights.max(axis=1)))
        along = np.einsum("ikj,ij->ik", mesh.vertices[mesh.faces[triangles]] - origin[:, None], line)
        after, along_after = np.roll(heights, -1, axis=1), np.roll(along, -1, axis=1)
        is_cut = (heights >= 0.0) != (after >= 0.0)  # two sides of three
        share = np.divide(heights, heights - after, out=np.zeros_like(heights), where=is_cut)
        at = along + share * (along_after - along)
        begins.append(np.where(is_cut, at, np.inf).min(axis=1))
        ends.append(np.where(is_cut, at, -np.inf).max(axis=1))
    begin, end = np.maximum(*begins), np.minimum(*ends)
    depth = np.minimum(np.minimum(*depths), end - begin)
    rows = np.flatnonzero(depth > allowed)
    # the line between the planes: where the plane of the other triangle cuts the first one
    middles = ((begin + end) / 2.0)[rows]
    return depth[rows], _on_line(mesh, one[rows], other[rows], origin[rows], line[rows], middles)


def _on_line(
    mesh: Triangles, one: IntArray, other: IntArray, origin: FloatArray, line: FloatArray, along: FloatArray
) -> FloatArray:
    """Return places on the lines between the planes of triangles, so far along from an origin in the first plane."""
    to_line = np.cross(line, mesh.normals[one])
    off = np.einsum("ij,ij->i", mesh.vertices[mesh.faces[other, 0]] - origin, mesh.normals[other])
    slope = np.einsum("ij,ij->i", to_line, mesh.normals[other])
    found: FloatArray = origin + along[:, None] * line + (off / slope)[:, None] * to_line
    return found


def _heights(mesh: Triangles, of: IntArray, above: IntArray) -> FloatArray:
    """Return how far the corners of triangles are above the planes of others, one each, (n, 3)."""
    arms = mesh.vertices[mesh.faces[of]] - mesh.vertices[mesh.faces[above, 0]][:, None]
    found: FloatArray = np.einsum("ikj,ij->ik", arms, mesh.normals[above])
    return found


def _is_star(mesh: Triangles) -> bool:
    """Whether all triangles of a surface are seen from within, from one place, and cover its view once: it cannot cross
    itself then. What is convex is a star, and so is what is round and a little hollow where its facets meet.
    """
    middle = mesh.vertices.mean(axis=0)
    a, b, c = np.moveaxis(mesh.vertices[mesh.faces] - middle, 1, 0)
    pyramids = np.einsum("ij,ij->i", a, np.cross(b, c))
    if pyramids.min() < -LEAST_PYRAMID * mesh.size**3:
        return False
    lengths = [np.linalg.norm(corner, axis=1) for corner in (a, b, c)]
    dots = [
        np.einsum("ij,ij->i", one, other) * third
        for one, other, third in ((a, b, lengths[2]), (b, c, lengths[0]), (c, a, lengths[1]))
    ]
    solid_angles = 2.0 * np.arctan2(pyramids, lengths[0] * lengths[1] * lengths[2] + sum(dots))
    return bool(abs(float(solid_angles.sum()) / (4.0 * np.pi) - 1.0) < 0.5)
