"""Whether two boundaries have the same features, in whatever order."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cagepose.model.boundary.trimmed import TrimmedUnion

FloatArray = NDArray[np.float64]
ANGLE = 1e-7


def differences(one: TrimmedUnion, other: TrimmedUnion, tolerance_m: float) -> list[str]:
    faults = []
    pairs = [
        ("vertices", _vertices(one), _vertices(other)),
        ("edges", _edges(one), _edges(other, is_swapped=False), _edges(other, is_swapped=True)),
        ("faces", _faces(one), _faces(other)),
        ("borders", _borders(one), _borders(other)),
    ]
    for name, rows, *ways in pairs:
        if len(rows) != len(ways[0]):
            faults.append(f"{len(rows)} {name} and {len(ways[0])}")
        elif len(rows):
            scale = np.where(np.abs(rows[0]) >= 0.0, _scale(name, rows.shape[1], tolerance_m), 0.0)
            apart = np.min([np.abs((rows[:, None] - way) / scale).max(axis=2) for way in ways], axis=0)
            if max(apart.min(axis=0).max(), apart.min(axis=1).max()) > 1.0:
                faults.append(f"other {name}")
    return faults


def _scale(name: str, n: int, tolerance_m: float) -> FloatArray:
    n_lengths = {"vertices": 3, "edges": 6, "faces": 1, "borders": 6}[name]
    return np.array([tolerance_m] * n_lengths + [ANGLE] * (n - n_lengths))


def _vertices(boundary: TrimmedUnion) -> FloatArray:
    """Place and part with each of the tangents of a vertex, that one after the other."""
    vertices = boundary.vertices
    places = np.repeat(vertices.places_m, vertices.n_tangents, axis=0)
    return np.hstack([places, vertices.tangents, np.repeat(vertices.parts, vertices.n_tangents)[:, None]])


def _edges(boundary: TrimmedUnion, *, is_swapped: bool = False) -> FloatArray:
    edges = boundary.edges
    ends = [edges.starts_m, edges.ends_m]
    sides = np.concatenate([edges.normals, edges.parts[..., None]], axis=2)
    if is_swapped:
        ends, sides = ends[::-1], sides[:, ::-1]
    return np.hstack([*ends, sides.reshape(len(sides), -1)])


def _faces(boundary: TrimmedUnion) -> FloatArray:
    faces = boundary.faces
    return np.column_stack([faces.offsets_m, faces.normals, faces.parts, faces.is_convex, faces.n_borders])


def _borders(boundary: TrimmedUnion) -> FloatArray:
    faces = boundary.faces
    of_face = np.column_stack([faces.normals, faces.parts])
    borders = faces.borders
    return np.hstack([borders["start"], borders["end"], borders["inward"], np.repeat(of_face, faces.n_borders, axis=0)])
