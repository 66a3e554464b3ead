"""What every boundary must fulfil, and questions to one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.boundary.inside import is_in_face
from cagepose.model.boundary.trimmed import TrimmedUnion

FloatArray = NDArray[np.float64]


def areas(boundary: TrimmedUnion) -> FloatArray:
    """Area of each face, (n,), by Stokes: of all its loops."""
    faces, last = boundary.faces, np.cumsum(boundary.faces.n_borders)
    arms = faces.borders["start"] - np.repeat(faces.borders["start"][last - faces.n_borders], faces.n_borders, axis=0)
    beyond = arms + faces.borders["end"] - faces.borders["start"]
    normals = np.repeat(faces.normals, faces.n_borders, axis=0)
    return np.add.reduceat(np.einsum("ij,ij->i", np.cross(arms, beyond), normals) / 2.0, last - faces.n_borders)


def volume(boundary: TrimmedUnion) -> float:
    """By Gauss, of the distances of all faces from the origin."""
    return float(areas(boundary) @ boundary.faces.offsets_m) / 3.0


def faces_at(boundary: TrimmedUnion, place: FloatArray, normal: FloatArray, tolerance_m: float) -> list[int]:
    """Return the faces with this outward normal that a place on their plane lies in."""
    faces, last = boundary.faces, np.cumsum(boundary.faces.n_borders)
    near = (faces.normals @ normal > 1.0 - 1e-9) & (np.abs(faces.normals @ place - faces.offsets_m) <= tolerance_m)
    found = []
    for f in np.flatnonzero(near).tolist():
        outward = tuple(faces.normals[f].tolist())
        span = int(last[f] - faces.n_borders[f]), int(last[f])
        if is_in_face(tuple(place.tolist()), outward, faces.borders, *span, tolerance_m):
            found.append(f)
    return found


def faults_of_surface(boundary: TrimmedUnion, tolerance_m: float) -> list[str]:
    """Say where a boundary is not closed, or its rows do not fit each other."""
    faces, edges, vertices = boundary.faces, boundary.edges, boundary.vertices
    faults = [f"{boundary.n_open} open borders"] if boundary.n_open else []
    found = areas(boundary)
    extent = float(np.ptp(faces.borders["start"], axis=0).max())
    if np.abs(found @ faces.normals).max() > 1e-9 * found.sum():
        faults.append("areas do not add up to zero")
    if (found <= 0.0).any():
        faults.append("a face has no area")
    normals = np.repeat(faces.normals, faces.n_borders, axis=0)
    offsets = np.repeat(faces.offsets_m, faces.n_borders)
    for end in ("start", "end"):
        if np.abs(np.einsum("ij,ij->i", faces.borders[end], normals) - offsets).max() > 10 * tolerance_m:
            faults.append("a border is not on its plane")
    if np.abs(np.cross(normals, faces.borders["direction"]) - faces.borders["inward"]).max() > 1e-8:
        faults.append("a face is not to the left of its border")
    senses = _senses_beside(faces.borders["start"], faces.borders["end"], faces.borders["direction"], tolerance_m)
    if senses.any():
        faults.append("a border has none of another face along it")
    if len(edges.starts_m):
        across = np.cross(edges.normals[:, 0], edges.normals[:, 1])
        sines = np.linalg.norm(across, axis=1)
        if np.abs(across - sines[:, None] * edges.directions).max() > 1e-9:
            faults.append("an edge is not along the cross product of its normals")
        if np.abs(np.cross(edges.ends_m - edges.starts_m, edges.directions)).max() > 10 * tolerance_m * max(extent, 1):
            faults.append("an edge does not lead from its start to its end")
    last = np.cumsum(vertices.n_tangents)
    for place, first, end in zip(vertices.places_m, last - vertices.n_tangents, last, strict=True):
        starts = np.linalg.norm(edges.starts_m - place, axis=1) <= 2 * tolerance_m
        ends = np.linalg.norm(edges.ends_m - place, axis=1) <= 2 * tolerance_m
        leading = np.concatenate([edges.directions[starts], -edges.directions[ends]])
        for tangent in vertices.tangents[first:end]:
            if not len(leading) or np.abs(leading - tangent).max(axis=1).min() > 1e-7:
                faults.append(f"no edge leads from a vertex along its tangent {tangent}")
    return faults


def _senses_beside(starts: FloatArray, ends: FloatArray, directions: FloatArray, tolerance_m: float) -> FloatArray:
    """Of a place on each border, where none is likely to end: how many pass in its sense, less those in the other."""
    asked = starts + 0.4142 * (ends - starts)
    arms = asked[:, None] - starts
    along = np.einsum("ijk,jk->ij", arms, directions)
    off = np.linalg.norm(arms - along[..., None] * directions, axis=2)
    lengths = np.linalg.norm(ends - starts, axis=1)
    passes = (off <= 10 * tolerance_m) & (along > 0.0) & (along < lengths)
    return np.sum(passes * np.round(directions @ directions.T), axis=1)
