"""What a solid of a file became, beside what its file says of it: `ImportedPart`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from cagepose.files.extra import files_library
from cagepose.files.meshes.manifolds import Triangles
from cagepose.model.boundary.inexact import exact_faces
from cagepose.model.checks import FloatArray
from cagepose.model.facets import Facets
from cagepose.model.hole import Hole
from cagepose.model.pose import Pose
from cagepose.model.shapes import Shape
from cagepose.model.union import body_moments
from cagepose.model.wording import counted

KINDS = {"box": ("box", "boxes"), "convex": ("convex hull", "convex hulls")}
"""Kinds of shapes that have other words, or more than an s in their plural."""


class Measures(NamedTuple):
    """What a body measures, in the frame of the object or of the cage.

    Attributes
    ----------
    volume_m3
        Cubic metres.
    center_m
        The middle of the volume, (3,), metres.
    limits_m
        The least and greatest coordinates, (2, 3), metres.
    gyration_m2
        Inertia by mass at uniform density, about the center, (3, 3), metres squared.
    """

    volume_m3: float
    center_m: FloatArray
    limits_m: FloatArray
    gyration_m2: FloatArray

    @property
    def size_m(self) -> FloatArray:
        """The sides of the box around it, (3,), metres."""
        sides: FloatArray = self.limits_m[1] - self.limits_m[0]
        return sides


class ImportedPart(NamedTuple):
    """A solid of a file, and the shapes that it is in the scene.

    Attributes
    ----------
    body, name
        "object" or "cage", and the name that its shapes begin with.
    shapes
        In the frame of their body, metres.
    surface
        Triangles of the solid as its file has it, or as Open CASCADE makes them, in that frame, metres.
    source, ours
        What the solid measures as Open CASCADE or trimesh says, and the shapes as cagepose does.
    off_m
        How far shapes and solid are apart at most, metres; of a mesh, what its own triangles may be off is not known.
    notes
        What is not in the shapes as it is in the solid, in sentences.
    """

    body: str
    name: str
    shapes: tuple[Shape, ...]
    surface: Triangles
    source: Measures
    ours: Measures
    off_m: float
    notes: tuple[str, ...]

    @property
    def volume_off(self) -> float:
        """How much more volume the shapes have than the solid, as a fraction of it."""
        return self.ours.volume_m3 / self.source.volume_m3 - 1.0

    @property
    def center_off_m(self) -> float:
        """How far the middles of the volumes are apart, metres."""
        return float(np.linalg.norm(self.ours.center_m - self.source.center_m))

    @property
    def size_off_m(self) -> float:
        """By how much the sides of the boxes around differ at most, metres."""
        return float(np.abs(self.ours.size_m - self.source.size_m).max())

    @property
    def gyration_off(self) -> float:
        """By how much inertia by mass differs at most, as a fraction of the greatest moment."""
        return float(np.abs(self.ours.gyration_m2 - self.source.gyration_m2).max() / self.source.gyration_m2.max())

    @property
    def became(self) -> str:
        """What the solid is here, such as "1 cylinder, 2 holes"; of facets how many of its faces are exact, such as
        "12 planes, 4 cylinders, 380 facets".
        """
        kinds = Counter(shape.kind for shape in self.shapes if not isinstance(shape, Facets))
        listed = [(number, *KINDS.get(kind, (kind, f"{kind}s"))) for kind, number in kinds.items()]
        faces = [exact_faces(shape.moved(Pose())) for shape in self.shapes if isinstance(shape, Facets)]
        exact = [found.in_words for found in faces if found.of_kinds]
        n_facets = sum(found.n_facets for found in faces)
        return ", ".join([*exact, *filter(None, [counted((n_facets, "facet", "facets"), *listed)])])


def measures_of_shapes(shapes: Sequence[Shape]) -> Measures:
    """Return what shapes measure together, less the holes in them."""
    solid, holes = (tuple(shape for shape in shapes if isinstance(shape, Hole) is is_hole) for is_hole in (False, True))
    found = body_moments(solid, [hole for hole in holes if isinstance(hole, Hole)])
    assert found is not None, "no solid is flat"
    limits = np.array([shape.limits_m() for shape in solid])
    second = found.second_moment_m2
    return Measures(
        found.volume_m3,
        found.centroid_m,
        np.array([limits[:, 0].min(axis=0), limits[:, 1].max(axis=0)]),
        np.trace(second) * np.eye(3) - second,
    )


def measures_of_mesh(surface: Triangles) -> Measures:
    """Return what a closed surface measures, as trimesh says. Lengths are metres.

    Raises
    ------
    MissingExtraError
        It is not installed.
    """
    trimesh = files_library("trimesh", "what a mesh measures is asked of trimesh")
    middle, size = surface.vertices.mean(axis=0), surface.size
    mesh = trimesh.Trimesh((surface.vertices - middle) / size, surface.faces, process=False)
    found = mesh.mass_properties
    return Measures(
        float(found["volume"]) * size**3,
        np.array(found["center_mass"]) * size + middle,
        np.array([surface.vertices.min(axis=0), surface.vertices.max(axis=0)]),
        np.array(found["inertia"]) / float(found["mass"]) * size**2,
    )


def together(parts: Sequence[Measures]) -> Measures:
    """Return what bodies measure as one; what some of them share counts for each."""
    volume = sum(part.volume_m3 for part in parts)
    center: FloatArray = np.sum([part.volume_m3 / volume * part.center_m for part in parts], axis=0)
    gyration = np.zeros((3, 3))
    for part in parts:
        arm = part.center_m - center
        about = part.gyration_m2 + float(arm @ arm) * np.eye(3) - np.outer(arm, arm)
        gyration += part.volume_m3 / volume * about
    limits = np.array([part.limits_m for part in parts])
    return Measures(volume, center, np.array([limits[:, 0].min(axis=0), limits[:, 1].max(axis=0)]), gyration)
