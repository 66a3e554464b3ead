"""Triangles that hang together and stand for one surface, or lie in one plane: `regions_on`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from cagepose.model.boundary.surface_union import flat_regions
from cagepose.model.checks import FloatArray
from cagepose.model.sides import IntArray
from cagepose.model.surfaces import PLANE, Surface


class Regions(NamedTuple):
    """Which region each triangle is in, (m,), on which surface each region lies, and whether its triangles stand for
    that: else they are flat facets in one plane.
    """

    of_triangles: IntArray
    surfaces: list[Surface]
    is_exact: list[bool]


def regions_on(
    vertices_m: FloatArray,
    triangles: IntArray,
    twins: IntArray,
    surfaces: Sequence[Surface],
    on: IntArray,
    flat_m: float,
) -> Regions:
    """Return the regions of a closed surface; triangles that stand for none lie in planes of their own.

    Parameters
    ----------
    on
        Which surface each triangle stands for, -1: none.
    flat_m
        What is this near to a plane is in it, metres.
    """
    flat = flat_regions(vertices_m, triangles, on, twins, flat_m)
    labels = np.where(on >= 0, on, len(surfaces) + flat.of_triangles)
    region = _connected(labels, twins)
    _, first, of_triangles = np.unique(region, return_index=True, return_inverse=True)
    found = list[Surface]()
    for triangle in first.tolist():
        if on[triangle] >= 0:
            found.append(surfaces[on[triangle]])
            continue
        which = int(flat.of_triangles[triangle])
        normal = flat.normals[which]
        point = flat.offsets[which] * normal
        found.append(Surface(PLANE, tuple(point.tolist()), tuple(normal.tolist())))
    return Regions(of_triangles.reshape(-1), found, (on[first] >= 0).tolist())


def _connected(labels: IntArray, twins: IntArray) -> IntArray:
    """Return of each triangle the lowest one that it hangs together with through others of its label."""
    one, other = np.arange(len(twins)) // 3, twins // 3
    joined = labels[one] == labels[other]
    one, other, lowest = one[joined], other[joined], np.arange(len(labels))
    while True:
        least = np.minimum(lowest[one], lowest[other])
        before = lowest.copy()
        np.minimum.at(lowest, lowest[one], least)
        np.minimum.at(lowest, lowest[other], least)
        lowest = lowest[lowest]
        if (lowest == before).all():
            return lowest
