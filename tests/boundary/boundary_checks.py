"""What every boundary must fulfil, and questions to one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

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
    _, faces, is_in = faces_near(boundary, place[None], normal[None], tolerance_m)
    found: list[int] = faces[is_in].tolist()
    return found


def n_faces_at(boundary: TrimmedUnion, places: FloatArray, normals: FloatArray, tolerance_m: float) -> FloatArray:
    """Say in how many faces with its outward normal each place (n, 3) lies, (n,)."""
    which, _, is_in = faces_near(boundary, places, normals, tolerance_m)
    return np.bincount(which, is_in, len(places))


def faces_near(
    boundary: TrimmedUnion, places: FloatArray, normals: FloatArray, tolerance_m: float
) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.bool_]]:
    """Return (place, face, whether it lies in it) for each place (n, 3) and each face whose plane it is on, with its
    outward normal: a ray crosses the face's borders an odd number of times, or one of them is within the tolerance.
    """
    faces, borders = boundary.faces, boundary.faces.borders
    along, above = normals @ faces.normals.T, places @ faces.normals.T - faces.offsets_m
    which, face = np.nonzero((along > 1.0 - 1e-9) & (np.abs(above) <= tolerance_m))
    n_borders = faces.n_borders[face]
    pair = np.repeat(np.arange(len(face)), n_borders)
    border = np.arange(len(pair)) + np.repeat(np.cumsum(faces.n_borders)[face] - np.cumsum(n_borders), n_borders)
    starts, ends = (borders[end][border] - places[which[pair]] for end in ("start", "end"))
    ways = ends - starts
    shares = np.clip(-np.einsum("ij,ij->i", starts, ways) / np.einsum("ij,ij->i", ways, ways), 0.0, 1.0)
    is_on = np.linalg.norm(starts + shares[:, None] * ways, axis=1) <= tolerance_m
    across = np.abs(faces.normals[face]).argmax(axis=1)[pair]
    row = np.arange(len(pair))
    (x, y), (end_x, end_y) = ((at[row, (across + 1) % 3], at[row, (across + 2) % 3]) for at in (starts, ends))
    is_passed = (x > 0.0) != (end_x > 0.0)
    heights = y - x / np.where(is_passed, end_x - x, 1.0) * (end_y - y)
    n_crossings = np.bincount(pair, is_passed & (heights > 0.0), len(face))
    return which, face, (np.bincount(pair, is_on, len(face)) > 0.0) | (n_crossings % 2.0 == 1.0)


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
    owners = np.repeat(np.arange(len(vertices.places_m)), vertices.n_tangents)
    leads = np.zeros((len(owners), len(edges.starts_m)), np.bool_)
    for ends, sense in ((edges.starts_m, 1.0), (edges.ends_m, -1.0)):
        is_there = np.linalg.norm(vertices.places_m[:, None] - ends, axis=2) <= 2 * tolerance_m
        apart = np.abs(vertices.tangents[:, None] - sense * edges.directions).max(axis=2, initial=0.0)
        leads |= is_there[owners] & (apart <= 1e-7)
    faults += [f"no edge leads from a vertex along its tangent {way}" for way in vertices.tangents[~leads.any(axis=1)]]
    return faults


def _senses_beside(starts: FloatArray, ends: FloatArray, directions: FloatArray, tolerance_m: float) -> FloatArray:
    """Of a place on each border, where none is likely to end: how many pass in its sense, less those in the other."""
    asked = starts + 0.4142 * (ends - starts)
    one, other = _near_lines(asked, starts, directions)
    arms = asked[one] - starts[other]
    along = np.einsum("ij,ij->i", arms, directions[other])
    off = np.linalg.norm(arms - along[:, None] * directions[other], axis=1)
    lengths = np.linalg.norm(ends - starts, axis=1)[other]
    passes = (off <= 10 * tolerance_m) & (along > 0.0) & (along < lengths)
    senses = np.round(np.einsum("ij,ij->i", directions[one], directions[other]))
    return np.bincount(one, passes * senses, len(starts))


def _near_lines(places: FloatArray, starts: FloatArray, directions: FloatArray) -> tuple[np.ndarray, ...]:
    """Which places are near which lines: within a thousandth of how large all is, as far as rounding tells."""
    middle = starts.mean(axis=0)
    places, starts = places - middle, starts - middle
    along = places @ directions.T - np.einsum("ij,ij->i", starts, directions)
    squares = np.einsum("ij,ij->i", places, places)[:, None] + np.einsum("ij,ij->i", starts, starts)
    off = squares - 2.0 * (places @ starts.T) - along**2
    return np.nonzero(off <= 1e-6 * squares.max())
