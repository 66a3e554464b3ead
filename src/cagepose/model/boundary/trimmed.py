"""The boundary of a union: convex vertices, convex edges and trimmed faces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from cagepose.model.checks import FloatArray

IntArray = NDArray[np.int64]
F = TypeVar("F", "Vertices", "Edges", "Faces")


@dataclass(frozen=True, eq=False)
class Vertices:
    """Places in which a body ends along the directions of a whole cone.

    Attributes
    ----------
    places_m
        (n, 3), metres.
    parts
        Of each, the first of the parts that have it, (n,).
    n_tangents
        How many bound its cone, (n,).
    tangents
        Unit vectors of all, one after the other: a normal n of the cone has n . tangent <= 0 with all of its own.
    shortest_m
        Of each, the length of the shortest edge there, (n,), metres; inf: there is none.
    """

    places_m: FloatArray
    parts: IntArray
    n_tangents: IntArray
    tangents: FloatArray
    shortest_m: FloatArray


@dataclass(frozen=True, eq=False)
class Edges:
    """Straight edges with less than half a turn of material, from vertex to vertex or wherever they end.

    Attributes
    ----------
    starts_m, ends_m
        (n, 3), metres.
    directions
        Unit vectors from the start to the end, (n, 3).
    normals
        Of the faces on both sides, outward, (n, 2, 3): the direction leads along the cross product of the two.
    planes, parts
        Of both faces, (n, 2), see `Faces`.
    """

    starts_m: FloatArray
    ends_m: FloatArray
    directions: FloatArray
    normals: FloatArray
    planes: IntArray
    parts: IntArray


@dataclass(frozen=True, eq=False)
class Faces:
    """Connected regions of planes, each of one part.

    Attributes
    ----------
    normals
        Outward unit vectors, (n, 3).
    offsets_m
        normal . x on the plane, (n,), metres.
    planes
        Faces with the same number lie on one plane and show to the same side, (n,).
    parts
        Of each, the first of the parts that it belongs to, (n,).
    is_convex
        Whether it is what lies inward of all its borders, (n,).
    n_borders
        How many bound it, (n,).
    borders
        Of all, one after the other, and of each loop in its order: records of `kernels.union.loops.Border`.
    """

    normals: FloatArray
    offsets_m: FloatArray
    planes: IntArray
    parts: IntArray
    is_convex: NDArray[np.bool_]
    n_borders: IntArray
    borders: NDArray[np.void]


@dataclass(frozen=True, eq=False)
class TrimmedUnion:
    """The boundary of a body in its frame.

    Attributes
    ----------
    n_open
        Borders without another that goes on where they end: none, unless edges are as short as what touches.
    """

    vertices: Vertices
    edges: Edges
    faces: Faces
    n_open: int


def joined(boundaries: Sequence[TrimmedUnion]) -> TrimmedUnion:
    """Return the boundaries of groups of parts that are apart as one."""
    if len(boundaries) == 1:
        return boundaries[0]
    first_plane = 0
    for boundary in boundaries:
        for planes in (boundary.edges.planes, boundary.faces.planes):
            planes += first_plane
        first_plane = int(boundary.faces.planes.max()) + 1
    return TrimmedUnion(
        _one_behind_the_other([boundary.vertices for boundary in boundaries]),
        _one_behind_the_other([boundary.edges for boundary in boundaries]),
        _one_behind_the_other([boundary.faces for boundary in boundaries]),
        sum(boundary.n_open for boundary in boundaries),
    )


def _one_behind_the_other(features: Sequence[F]) -> F:
    names = [field.name for field in fields(features[0])]
    return type(features[0])(*[np.concatenate([getattr(each, name) for each in features]) for name in names])
