"""Cracks of a surface closed: corners that are near are one, and sides are divided where corners lie on them.

Programs leave cracks of rounding between faces, and corners in the middle of longer sides, where nothing is open.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.files.meshes.joined import joined
from cagepose.files.meshes.manifolds import Triangles
from cagepose.model.checks import FloatArray
from cagepose.model.near_pairs import near_pairs
from cagepose.model.sides import open_sides, starts_and_ends

MOST_DIVISIONS = 20
"""A side is halved so many times at most, which is enough for a million corners on it."""


class Closed(NamedTuple):
    """A surface, and how far cracks that were closed in it were open at most, in the unit of its lengths."""

    mesh: Triangles
    moved: float


def without_cracks(mesh: Triangles, width: float) -> Closed:
    """Return a surface whose cracks of up to a width are closed."""
    welded, moved = _welded(mesh, width)
    divided, off = _divided(welded, width)
    return Closed(divided, max(moved, off))


def _corners_of_open(faces: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the corners at which open sides end."""
    starts, ends = starts_and_ends(faces)
    sides = open_sides(faces)
    return np.unique(np.concatenate([starts[sides], ends[sides]]))


def _welded(mesh: Triangles, width: float) -> Closed:
    """Return a surface in which corners of open sides that are near each other are one; triangles without three
    different corners are left out.
    """
    corners = _corners_of_open(mesh.faces)
    places = mesh.vertices[corners]
    pairs = near_pairs(places - 0.5 * width, places + 0.5 * width)
    is_near = np.linalg.norm(places[pairs[:, 0]] - places[pairs[:, 1]], axis=1) <= width
    first = joined(len(corners), pairs[is_near].astype(np.int64))
    same = np.arange(len(mesh.vertices))
    same[corners] = corners[first]
    faces = same[mesh.faces]
    moved = float(np.linalg.norm(places - places[first], axis=1).max(initial=0.0))
    return Closed(Triangles(mesh.vertices, faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)]), moved)


def _divided(mesh: Triangles, width: float) -> Closed:
    """Return a surface whose open sides are divided at the corners of open sides that lie on them."""
    faces, moved = mesh.faces, 0.0
    for _ in range(MOST_DIVISIONS):
        sides = open_sides(faces)
        if len(sides) == 0:
            break
        starts, ends = starts_and_ends(faces)
        corners = _corners_of_open(faces)
        on_sides, off = _corners_on(mesh.vertices, starts[sides], ends[sides], corners, width)
        cut = dict[int, tuple[int, int]]()  # of each triangle one side, and the corner on it
        for side, corner, away in zip(sides.tolist(), on_sides.tolist(), off.tolist(), strict=True):
            if corner >= 0 and corner not in faces[side // 3] and side // 3 not in cut:
                cut[side // 3] = side % 3, corner
                moved = max(moved, away)
        if not cut:
            break
        halves = []
        for triangle, (k, corner) in cut.items():
            a, b, c = np.roll(faces[triangle], -k).tolist()
            halves += [(a, corner, c), (corner, b, c)]
        faces = np.concatenate([np.delete(faces, list(cut), axis=0), np.array(halves, np.int64)])
    return Closed(Triangles(mesh.vertices, faces), moved)


def _corners_on(
    vertices: FloatArray, starts: NDArray[np.int64], ends: NDArray[np.int64], corners: NDArray[np.int64], width: float
) -> tuple[NDArray[np.int64], FloatArray]:
    """Return the corner on each side that is nearest to its middle (-1: none is), and how far off the side it is."""
    begin, way = vertices[starts], vertices[ends] - vertices[starts]
    boxes = np.stack([np.minimum(begin, begin + way) - width, np.maximum(begin, begin + way) + width])
    places = vertices[corners]
    low, high = np.concatenate([boxes[0], places]), np.concatenate([boxes[1], places])
    pairs = near_pairs(low, high, between=len(starts))
    side, corner = pairs[:, 0], pairs[:, 1] - len(starts)
    squares = np.einsum("ij,ij->i", way, way)[side]
    arms = places[corner] - begin[side]
    share = np.einsum("ij,ij->i", arms, way[side]) / squares
    off = np.linalg.norm(arms - share[:, None] * way[side], axis=1)
    ends_apart = np.minimum(share, 1.0 - share) * np.sqrt(squares) > width
    is_on = (off <= width) & ends_apart
    order = np.argsort(-np.abs(share[is_on] - 0.5), kind="stable")
    found, away = np.full(len(starts), -1, np.int64), np.zeros(len(starts))
    found[side[is_on][order]] = corners[corner[is_on][order]]
    away[side[is_on][order]] = off[is_on][order]
    return found, away
