"""A body of triangles that is none of our shapes as one shape of flat facets: `facets_of`."""

from __future__ import annotations

import math

import numpy as np

from cagepose.files.meshes.edges import edges_of
from cagepose.files.meshes.manifolds import Triangles
from cagepose.files.meshes.tolerances import ROUNDING_OF_MESH
from cagepose.model.boundary.surface_union import FlatRegions, flat_regions
from cagepose.model.checks import FloatArray
from cagepose.model.facets import FLAT, Facets
from cagepose.model.sides import IntArray, twins_of

DIGITS_OF_SINGLE = 7
"""Coordinates with no more digits than these of the size are as those in single precision."""
FARTHEST_MOVE = 4.0
"""In what is flat: corners are moved no farther onto the planes of their faces."""
LEAST_SINE = 1e-3
"""Planes that make a smaller angle with others at a corner do not tell where it is between them."""
LEAST_ANGLE, MOST_ANGLE = 1e-4, math.radians(23.0)
"""Between facets of what is round, which has at least 16 sides."""


def facets_of(mesh: Triangles, *, coarse: bool) -> Facets:
    """Return a closed surface as a shape.

    In single precision (``coarse``) corners are off the planes of their faces; they are moved onto them, as far as all
    of their planes have a place in common.
    """
    if not coarse:
        return Facets(mesh.vertices, mesh.faces, FLAT * mesh.size)
    flat = ROUNDING_OF_MESH * mesh.size
    parts = np.zeros(len(mesh.faces), np.int64)
    regions = flat_regions(mesh.vertices, mesh.faces, parts, twins_of(mesh.vertices, mesh.faces), flat)
    n_triangles = np.bincount(regions.of_triangles, minlength=len(regions.normals))
    is_whole = (n_triangles > 1)[regions.of_triangles]
    pairs = np.stack([mesh.faces[is_whole].ravel(), np.repeat(regions.of_triangles[is_whole], 3)], axis=1)
    return Facets(_onto_planes(mesh.vertices, np.unique(pairs, axis=0), regions, flat), mesh.faces, flat)


def round_error(mesh: Triangles) -> float:
    """Return about how far facets are within what they stand for at most, if several of them in a row with blunt edges
    between stand for something round, as in a fillet; zero: none do.
    """
    edges = edges_of(mesh)
    one, other = np.moveaxis(mesh.normals[edges.faces], 1, 0)
    angles = np.arctan2(np.linalg.norm(np.cross(one, other), axis=1), np.einsum("ij,ij->i", one, other))
    is_blunt = (angles > LEAST_ANGLE) & (angles < MOST_ANGLE)
    n_blunt = np.bincount(edges.faces[is_blunt].ravel(), minlength=len(mesh.faces))
    flat = np.flatnonzero((angles <= LEAST_ANGLE) & ~is_blunt)
    for k, m in ((0, 1), (1, 0)):  # a strip is two triangles
        np.add.at(n_blunt, edges.faces[flat, k], np.minimum(n_blunt[edges.faces[flat, m]], 1))
    in_row = is_blunt & (n_blunt[edges.faces] > 1).all(axis=1)
    if not in_row.any():
        return 0.0
    ways = mesh.vertices[edges.corners[in_row, 1]] - mesh.vertices[edges.corners[in_row, 0]]
    heights = np.linalg.norm(mesh.areas[edges.faces[in_row]], axis=2) / np.linalg.norm(ways, axis=1)[:, None]
    return float((0.5 * heights.min(axis=1) * np.tan(0.25 * angles[in_row])).max())


def is_coarse(mesh: Triangles) -> bool:
    """Whether corners have no more digits than single precision has."""
    in_single = mesh.vertices.astype(np.float32).astype(np.float64)
    decimals = DIGITS_OF_SINGLE - math.ceil(math.log10(mesh.size))
    return bool((in_single == mesh.vertices).all() or (np.round(mesh.vertices, decimals) == mesh.vertices).all())


def _onto_planes(vertices: FloatArray, pairs: IntArray, regions: FlatRegions, flat: float) -> FloatArray:
    """Return vertices moved the shortest way onto their planes; ``pairs`` of a vertex and a region, in order."""
    moved = vertices.copy()
    corners, first, counts = np.unique(pairs[:, 0], return_index=True, return_counts=True)
    for count in np.unique(counts).tolist():
        mine = counts == count
        planes = pairs[first[mine][:, None] + np.arange(count), 1]
        across, places = regions.normals[planes], vertices[corners[mine]]
        heights = np.einsum("ijk,ik->ij", across, places) - regions.offsets[planes]
        steps = np.einsum("ijk,ik->ij", np.linalg.pinv(across, rcond=LEAST_SINE), heights)
        is_small = np.linalg.norm(steps, axis=1) <= FARTHEST_MOVE * flat
        moved[corners[mine][is_small]] -= steps[is_small]
    return moved
