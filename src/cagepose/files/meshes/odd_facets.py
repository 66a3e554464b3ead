"""Triangles that are no part of a surface, or are turned over in it: `without_doubled`, `turned_alike`,
`without_strays`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cagepose.files.meshes.joined import joined
from cagepose.files.meshes.manifolds import Triangles
from cagepose.model.checks import FloatArray
from cagepose.model.sides import IntArray, open_sides, starts_and_ends

MOST_STRAY = 0.01
"""Fraction of the area of all triangles. Where strays have more, something is missing beside them."""


class Tidied(NamedTuple):
    """A surface, and the middles, (n, 3), of triangles that were changed or left out."""

    mesh: Triangles
    places: FloatArray


def without_doubled(mesh: Triangles) -> Tidied:
    """Return a surface that has each triangle once, and none of two that lie on each other and face opposite ways, as
    between two bodies that share a face.
    """
    ordered = np.sort(mesh.faces, axis=1)
    low = mesh.faces.argmin(axis=1)
    nexts = mesh.faces[np.arange(len(low)), (low + 1) % 3]
    way = np.where(nexts == ordered[:, 1], 1, -1)
    n_corners = len(mesh.vertices)
    _, pair = np.unique(ordered[:, 0] * n_corners + ordered[:, 1], return_inverse=True)
    _, first, same = np.unique(pair * n_corners + ordered[:, 2], return_index=True, return_inverse=True)
    if len(first) == len(ordered):
        return Tidied(mesh, np.zeros((0, 3)))
    net = np.sign(np.bincount(same, way)).astype(np.int64)
    kept_way = net[same]
    rows = np.flatnonzero(way == kept_way)
    _, once = np.unique(same[rows], return_index=True)
    kept = np.sort(rows[once])
    gone = np.setdiff1d(np.arange(len(ordered)), kept)
    return Tidied(Triangles(mesh.vertices, mesh.faces[kept]), _middles(mesh, gone))


def turned_alike(mesh: Triangles) -> Tidied:
    """Return a surface whose triangles face one way where they hang together: that of most of them."""
    sides, one, other, is_back = _two_at_sides(mesh.faces)
    if len(sides) == 0 or is_back.all():
        return Tidied(mesh, np.zeros((0, 3)))
    n_faces = len(mesh.faces)  # each triangle is there twice: as it is, and turned over from `n_faces` on
    here = np.stack([one, np.where(is_back, other, other + n_faces)], axis=1)
    turned = np.stack([one + n_faces, np.where(is_back, other + n_faces, other)], axis=1)
    least = joined(2 * n_faces, np.concatenate([here, turned]))
    as_it_is, over = least[:n_faces], least[n_faces:]
    if (as_it_is == over).any():  # it has one side alone
        return Tidied(mesh, np.zeros((0, 3)))
    is_over = over < as_it_is
    shell = np.minimum(as_it_is, over)
    most = np.bincount(shell, np.where(is_over, 1, -1), n_faces)[shell] > 0.0
    is_turned = is_over ^ most
    faces = np.where(is_turned[:, None], mesh.faces[:, ::-1], mesh.faces)
    return Tidied(Triangles(mesh.vertices, faces), _middles(mesh, np.flatnonzero(is_turned)))


def without_strays(mesh: Triangles) -> Tidied:
    """Return a surface without triangles that have a side alone, as long as these are few; else as it is."""
    left, areas = np.ones(len(mesh.faces), bool), np.linalg.norm(mesh.areas, axis=1)
    while True:
        rows = np.flatnonzero(left)
        starts, ends = starts_and_ends(mesh.faces[rows])
        keys = np.minimum(starts, ends) * len(mesh.vertices) + np.maximum(starts, ends)
        _, at, counts = np.unique(keys, return_inverse=True, return_counts=True)
        alone = rows[np.unique(np.flatnonzero(counts[at] == 1) // 3)]
        if len(alone) == 0:
            break
        left[alone] = False
        if areas[~left].sum() > MOST_STRAY * areas.sum():
            return Tidied(mesh, np.zeros((0, 3)))
    return Tidied(Triangles(mesh.vertices, mesh.faces[left]), _middles(mesh, np.flatnonzero(~left)))


def _two_at_sides(faces: IntArray) -> tuple[IntArray, IntArray, IntArray, np.ndarray[tuple[int], np.dtype[np.bool_]]]:
    """Return sides that two triangles have, these two, and whether the other one has it the other way round."""
    starts, ends = starts_and_ends(faces)
    keys = np.minimum(starts, ends) * (int(faces.max(initial=0)) + 1) + np.maximum(starts, ends)
    order = np.argsort(keys, kind="stable")
    firsts = np.flatnonzero(np.append(True, np.diff(keys[order]) != 0))
    firsts = firsts[np.diff(firsts, append=len(keys)) == 2]
    one, other = order[firsts], order[firsts + 1]
    return one, one // 3, other // 3, starts[one] != starts[other]


def _middles(mesh: Triangles, rows: IntArray) -> FloatArray:
    found: FloatArray = mesh.vertices[mesh.faces[rows]].mean(axis=1)
    return found


def is_closed(mesh: Triangles) -> bool:
    """Whether a surface has triangles, and each of their sides is as often one the other way round."""
    return len(mesh.faces) > 0 and len(open_sides(mesh.faces)) == 0
