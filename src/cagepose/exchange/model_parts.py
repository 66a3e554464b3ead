"""What the bodies of a model became, beside what MuJoCo says of them: `ModelSource.parts`, `ModelSource.weight`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from cagepose.exchange.imported_part import ImportedPart, Measures, measures_of_shapes, together
from cagepose.exchange.model_bodies import Inertial, ModelBodies
from cagepose.files.meshes.manifolds import Triangles
from cagepose.files.solid_names import is_of
from cagepose.model.box import Box
from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.model.shapes import Capsule, Cylinder, Shape, Sphere
from cagepose.model.surface import shape_mesh

Data = dict[str, Any]

CHORDS_OF_CIRCLE = 64
"""Chords of a full circle in pictures of what is round in the source."""


class Weight(NamedTuple):
    """What an object weighs as MuJoCo says, and in the scene, both in the frame of the object."""

    source: Inertial
    ours: Inertial


class ModelSource(NamedTuple):
    """The geoms of a model that are in a scene.

    Attributes
    ----------
    bodies
        Of the model.
    held
        The body whose frame is that of the object.
    of_object, of_cage
        Geoms, as `cagepose.exchange.compile_model` writes them, with the ``label`` by which their shapes are named.
    meshes
        Triangles by the names of meshes, in the frames of geoms, metres.
    off_m
        How far the shapes of a geom are from it at most, by its label, metres; of others nothing.
    """

    bodies: ModelBodies
    held: int
    of_object: Sequence[Data]
    of_cage: Sequence[Data]
    meshes: Mapping[str, Triangles]
    off_m: Mapping[str, float]

    def parts(self, scene: Scene) -> tuple[ImportedPart, ...]:
        """Return what each body of the model is in the scene that was made of them; planes, which have no volume, and
        what was left out are no parts of it.
        """
        held, cage = scene.object, scene.cage
        found = list[ImportedPart]()
        for body, geoms, frame, every in (
            ("object", self.of_object, self.bodies.pose(self.held), (*held.parts, *held.holes)),
            ("cage", self.of_cage, cage.pose_world_cage, (*cage.shapes, *cage.holes)),
        ):
            shapes = _shapes_of(geoms, every)
            there = [geom for geom in geoms if shapes[geom["label"]] and geom["measures"] is not None]
            for number in dict.fromkeys(geom["body"] for geom in there):
                own = [geom for geom in there if geom["body"] == number]
                found.append(self.part(body, number, own, [shapes[geom["label"]] for geom in own], frame))
        return tuple(found)

    def part(
        self, body: str, number: int, geoms: Sequence[Data], shapes: Sequence[Sequence[Shape]], frame: Pose
    ) -> ImportedPart:
        """Return what the geoms of one body are, which are some shapes each; ``frame``: where object or cage are in the
        world of the model.
        """
        place = frame.inverse() @ self.bodies.pose(number)
        sources = [self.source(geom, place @ Pose(geom["position"], geom["quaternion"])) for geom in geoms]
        return ImportedPart(
            body,
            self.bodies.name(number),
            tuple(shape for found in shapes for shape in found),
            _as_one([surface for surface, _ in sources]),
            together([measures for _, measures in sources]),
            together([measures_of_shapes(found) for found in shapes]),
            max(self.off_m.get(geom["label"], 0.0) for geom in geoms),
            (),
        )

    def source(self, geom: Data, place: Pose) -> tuple[Triangles, Measures]:
        """Return the surface of a geom at a place, and what it measures as MuJoCo says."""
        surface, limits = self.surface(geom, place)
        said, turn = geom["measures"], place.rotation
        center = place.transform(np.array(said["center"]))
        return surface, Measures(said["volume"], center, limits, turn @ np.array(said["gyration"]) @ turn.T)

    def surface(self, geom: Data, place: Pose) -> tuple[Triangles, FloatArray]:
        """Return triangles of a geom at a place, and its least and greatest coordinates, (2, 3)."""
        size = geom["size"]
        if geom["kind"] == "mesh":
            own = self.meshes[geom["mesh"]]
            corners = place.transform(own.vertices)
            return Triangles(corners, own.faces), np.array([corners.min(axis=0), corners.max(axis=0)])
        if geom["kind"] == "ellipsoid":
            ball = shape_mesh(Sphere(1.0), CHORDS_OF_CIRCLE)
            reach = np.linalg.norm(place.rotation * size, axis=1)
            limits = np.array([place.position_m - reach, place.position_m + reach])
            return Triangles(place.transform(ball.vertices_m * size), ball.triangles), limits
        shape: Shape
        if geom["kind"] == "box":
            shape = Box(2.0 * np.array(size), place)
        elif geom["kind"] == "sphere":
            shape = Sphere(size[0], place)
        else:
            shape = (Capsule if geom["kind"] == "capsule" else Cylinder)(size[0], 2.0 * size[1], place)
        mesh = shape_mesh(shape, CHORDS_OF_CIRCLE)
        return Triangles(mesh.vertices_m, mesh.triangles), shape.limits_m()

    def weight(self, scene: Scene) -> Weight | None:
        """Return what the object weighs; None: it has no mass, here or there."""
        held, said = scene.object, self.bodies.weight(self.held)
        if said is None or held.mass_kg is None or held.inertia_kg_m2 is None:
            return None
        return Weight(said, Inertial(held.mass_kg, np.array(held.center_of_gravity_m), np.array(held.inertia_kg_m2)))


def _shapes_of(geoms: Sequence[Data], every: Sequence[Shape]) -> dict[str, list[Shape]]:
    """Return which of some shapes each geom became, by labels: nothing of a plane or a point, or what was left out."""
    found: dict[str, list[Shape]] = {geom["label"]: [] for geom in geoms}
    for shape in every:
        labels = [label for label in found if is_of(str(shape.name), label)]
        if labels:
            found[max(labels, key=len)].append(shape)
    return found


def _as_one(surfaces: Sequence[Triangles]) -> Triangles:
    firsts = np.cumsum([0, *(len(surface.vertices) for surface in surfaces)])
    faces = [surface.faces + first for surface, first in zip(surfaces, firsts, strict=False)]
    return Triangles(np.concatenate([surface.vertices for surface in surfaces]), np.concatenate(faces))
