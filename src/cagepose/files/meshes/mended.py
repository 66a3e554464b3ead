"""Cracks of a surface closed: corners that are near are one, and sides are divided where corners lie on them.

Programs leave cracks of rounding between faces, and corners in the middle of longer sides, where nothing is open.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.files.meshes.manifolds import Triangles
from cagepose.files.meshes.tolerances import ROUNDING_OF_MESH, WIDEST_CRACK
from cagepose.model.checks import FloatArray
from cagepose.model.near_pairs import near_pairs
from cagepose.model.sides import open_sides, starts_and_ends

STEP = 4.0
"""Cracks are looked for that are so many times wider each time."""
MOST_DIVISIONS = 20
"""A side is divided so many times at most, at one corner each time."""


class Mended(NamedTuple):
    """A surface, and how far corners were moved at most, in the unit of its lengths; zero: it was closed."""

    mesh: Triangles
    moved: float


def mended(mesh: Triangles) -> Mended:
    """Return a surface whose cracks are closed, the narrowest way that closes all; else as it was.

    Cracks are no wider than `WIDEST_CRACK` of the size; missing triangles stay missing.
    """
    if len(mesh.faces) == 0 or mesh.size == 0.0 or len(open_sides(mesh.faces)) == 0:
        return Mended(mesh, 0.0)
    width = ROUNDING_OF_MESH
    while width <= WIDEST_CRACK:
        found = _divided(_welded(mesh, width * mesh.size), width * mesh.size)
        if len(found.faces) > 0 and len(open_sides(found.faces)) == 0:
            return Mended(found, _farthest_moved(mesh, found, width * mesh.size))
        width *= STEP
    return Mended(mesh, 0.0)


def _corners_of_open(faces: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the corners at which open sides end."""
    starts, ends = starts_and_ends(faces)
    sides = open_sides(faces)
    return np.unique(np.concatenate([starts[sides], ends[sides]]))


def _welded(mesh: Triangles, width: float) -> Triangles:
    """Return a surface in which corners of open sides that are near each other are one; triangles without three
    different corners are left out.
    """
    corners = _corners_of_open(mesh.faces)
    places = mesh.vertices[corners]
    pairs = near_pairs(places - 0.5 * width, places + 0.5 * width)
    is_near = np.linalg.norm(places[pairs[:, 0]] - places[pairs[:, 1]], axis=1) <= width
    first = list(range(len(corners)))
    for one, other in pairs[is_near].tolist():
        first[other] = min(first[other], first[one])
    same = np.arange(len(mesh.vertices))
    same[corners] = corners[first]
    same = same[same]  # pairs come in order: what another one is at is known by then
    faces = same[mesh.faces]
    return Triangles(mesh.vertices, faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)])


def _divided(mesh: Triangles, width: float) -> Triangles:
    """Return a surface whose open sides are divided at the corners of open sides that lie on them."""
    faces = mesh.faces
    for _ in range(MOST_DIVISIONS):
        sides = open_sides(faces)
        if len(sides) == 0:
            break
        starts, ends = starts_and_ends(faces)
        corners = _corners_of_open(faces)
        on_sides = _corners_on(mesh.vertices, starts[sides], ends[sides], corners, width)
        cut = dict[int, tuple[int, int]]()  # of each triangle one side, and the corner on it
        for side, corner in zip(sides.tolist(), on_sides.tolist(), strict=True):
            if corner >= 0 and corner not in faces[side // 3]:
                cut.setdefault(side // 3, (side % 3, corner))
        if not cut:
            break
        halves = []
        for triangle, (k, corner) in cut.items():
            a, b, c = np.roll(faces[triangle], -k).tolist()
            halves += [(a, corner, c), (corner, b, c)]
        faces = np.concatenate([np.delete(faces, list(cut), axis=0), np.array(halves, np.int64)])
    return Triangles(mesh.vertices, faces)


def _corners_on(
    vertices: FloatArray, starts: NDArray[np.int64], ends: NDArray[np.int64], corners: NDArray[np.int64], width: float
) -> NDArray[np.int64]:
    """Return the corner nearest to the start of each side that lies on it between its ends; -1: none does."""
    begin, way = vertices[starts], vertices[ends] - vertices[starts]
    boxes = np.stack([np.minimum(begin, begin + way) - width, np.maximum(begin, begin + way) + width])
    places = vertices[corners]
    pairs = near_pairs(np.concatenate([boxes[0], places]), np.concatenate([boxes[1], places]))
    pairs = pairs[(pairs[:, 0] < len(starts)) & (pairs[:, 1] >= len(starts))]
    side, corner = pairs[:, 0], pairs[:, 1] - len(starts)
    squares = np.einsum("ij,ij->i", way, way)[side]
    arms = places[corner] - begin[side]
    share = np.einsum("ij,ij->i", arms, way[side]) / squares
    off = np.linalg.norm(arms - share[:, None] * way[side], axis=1)
    ends_apart = np.minimum(share, 1.0 - share) * np.sqrt(squares) > width
    is_on = (off <= width) & ends_apart
    order = np.argsort(-share[is_on], kind="stable")
    found = np.full(len(starts), -1, np.int64)
    found[side[is_on][order]] = corners[corner[is_on][order]]
    return found


def _farthest_moved(mesh: Triangles, found: Triangles, width: float) -> float:
    """Return how far a crack that was closed was open at most: no more than its width, and less where only corners in
    the middle of sides were.
    """
    gone = np.setdiff1d(_corners_of_open(mesh.faces), found.faces.ravel())
    left = np.unique(found.faces)
    if len(gone) == 0:
        return 0.0
    apart = [float(np.linalg.norm(mesh.vertices[left] - place, axis=1).min()) for place in mesh.vertices[gone]]
    return min(max(apart), width)
