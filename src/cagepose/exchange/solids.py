"""A scene as other programs know bodies: boxes, balls, bars and sharp convex meshes, and what that changes.

One neutral description for all formats. What a format has no word for is made of what it has, and a note says by how
much that is off: a point becomes a tiny ball, a frustum a prism of many sides, a rounded hull slabs and bars (exactly),
a part with holes many wedges around them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from cagepose.errors import Problem, SceneError
from cagepose.exchange.facets_pieces import facets_pieces
from cagepose.exchange.pierced import SIDES_AROUND_HOLES, SIDES_OF_ROUND, pierced_pieces
from cagepose.model.box import Box
from cagepose.model.facets import Facets
from cagepose.model.hole import Hole
from cagepose.model.pose import Pose, turn_from_z
from cagepose.model.scene import Scene
from cagepose.model.shapes import Capsule, Cone, Convex, Cylinder, Disc, Rounded, Shape, Sphere, Turned
from cagepose.model.surface import shape_mesh
from cagepose.model.wording import few

POINT_OF_SIZE = 1e-8
"""Radius of the ball that stands for a cage point, as a fraction of the scene's size."""

Primitive = Box | Sphere | Capsule | Cylinder | Convex
"""Shapes that stay what they are; of convex ones, those without a radius."""


@dataclass(frozen=True, eq=False)
class Solid:
    """One convex solid of a body.

    Attributes
    ----------
    name
        Its own in its body.
    element
        Name of the point or shape of the scene that it stands for, alone or with others.
    shape
        In the frame of its body.
    """

    name: str
    element: str
    shape: Primitive


@dataclass(frozen=True, eq=False)
class Assembly:
    """The two bodies of a scene.

    Attributes
    ----------
    scene
        Where they come from, with poses, mass and loads.
    object, cage
        Their solids, in the frames of the object and of the cage.
    error_m
        By how much a surface is off at most, metres.
    notes
        What is not exactly as in the scene, in sentences.
    frictions_of_parts
        Holes with a friction of their own, by name, and the parts whose friction they have here in its place.
    """

    scene: Scene
    object: tuple[Solid, ...]
    cage: tuple[Solid, ...]
    error_m: float
    notes: tuple[str, ...]
    frictions_of_parts: Mapping[str, Sequence[str]]


def assembly_of(scene: Scene) -> Assembly:
    """Return the bodies of a scene.

    Raises
    ------
    SceneError
        Discs, which have no thickness, and holes that no wedges can be made for; each by its name.
    MissingExtraError
        Parts with holes need manifold3d.
    """
    notes: list[str] = []
    errors_m = [0.0]
    problems: list[Problem] = []
    replaced: dict[str, list[str]] = {}
    radius_m = POINT_OF_SIZE * scene.size_m
    cage_points = [
        Solid(name, name, Sphere(radius_m, Pose(point)))
        for name, point in zip(scene.cage.names, scene.cage.points_cage, strict=True)
    ]
    if cage_points:
        errors_m.append(radius_m)
        notes.append(
            f"cage points are balls of radius {radius_m:.3g} m, so each gap to one is smaller by that"
            f" ({POINT_OF_SIZE:g} of the scene's size)"
        )
    bodies = []
    for body, shapes, holes, reach_m in (
        ("object", scene.object.parts, scene.object.holes, scene.size_m),
        ("cage", scene.cage.shapes, scene.cage.holes, 2.0 * scene.object.reach_m),
    ):
        made = _Body(body, holes, reach_m, notes, errors_m, problems, scene.friction_of, replaced)
        bodies.append([solid for shape in (*shapes, *_alone(holes)) for solid in made.solids(shape)])
    if problems:
        raise SceneError(problems)
    held, cage = bodies
    return Assembly(scene, tuple(held), (*cage_points, *cage), max(errors_m), tuple(notes), replaced)


def _alone(holes: Sequence[Hole]) -> list[Hole]:
    return [hole for hole in holes if not hole.in_]


@dataclass(frozen=True)
class _Body:
    """Makes the solids of one body."""

    name: str
    holes: Sequence[Hole]
    reach_m: float
    notes: list[str]
    errors_m: list[float]
    problems: list[Problem]
    friction_of: Mapping[str, float]
    replaced: dict[str, list[str]]

    def solids(self, shape: Shape) -> list[Solid]:
        name = str(shape.name)
        if isinstance(shape, Disc):
            message = "is a disc, which has no thickness, as every solid of these formats has; make it a flat cylinder"
            self.problems.append(Problem((self.name, name), message))
            return []
        if isinstance(shape, Hole):
            half = shape.rims[-1][1] + self.reach_m
            size, place = (2.0 * half, 2.0 * half, shape.depth_m), Pose((0.0, 0.0, -shape.depth_m / 2.0))
            self.notes.append(
                f"{name!r} stands alone in the scene, solid all around; here, in a block {2 * half:.3g} m wide"
            )
            return self.pierced(Box(size, shape.pose_body_shape @ place, name), [shape])
        cuts = [hole for hole in self.holes if name in hole.in_]
        if cuts:
            return self.pierced(shape, cuts)
        pieces = list(self.pieces(shape))
        names = [name] if len(pieces) == 1 else [f"{name}/{index + 1}" for index in range(len(pieces))]
        return [Solid(one, name, piece) for one, piece in zip(names, pieces, strict=True)]

    def pieces(self, shape: Shape) -> Iterator[Primitive]:
        if isinstance(shape, Cone):
            within_m = _sagitta_m(shape, SIDES_OF_ROUND)
            self.errors_m.append(within_m)
            self.notes.append(
                f"{shape.name!r} is a frustum; here it has {SIDES_OF_ROUND} sides, up to {within_m:.3g} m within it"
            )
            yield Convex(shape_mesh(shape, SIDES_OF_ROUND).vertices_m)
        elif isinstance(shape, Convex) and shape.radius_m > 0.0:
            yield from rounded_pieces(shape)
        elif isinstance(shape, Facets):
            yield from self.convex_pieces(shape)
        elif isinstance(shape, Box | Sphere | Capsule | Cylinder | Convex):
            yield shape

    def convex_pieces(self, shape: Facets) -> list[Convex]:
        found = facets_pieces(shape)
        if found is None:
            message = f"is a mesh of {len(shape.triangles):,} facets that few cuts do not make convex, as these formats"
            self.problems.append(Problem((self.name, str(shape.name)), f"{message} need it; export STEP or STL"))
        return found or []

    def pierced(self, part: Shape, holes: Sequence[Hole]) -> list[Solid]:
        name = str(part.name)
        if isinstance(part, Facets):
            message = f"is a mesh of facets with a hole ({holes[0].name!r}), which no wedges can stand for"
            self.problems.append(Problem((self.name, name), f"{message}; export STEP or STL"))
            return []
        if isinstance(part, Rounded) and part.radius_m > 0.0:
            message = f"has a hole and round sides, which no flat wedges can stand for; leave {holes[0].name!r} out"
            self.problems.append(Problem((self.name, name), message))
            return []
        axes = [hole.pose_body_shape.rotation[:, 2] for hole in holes]
        if any(abs(float(axis @ axes[0])) < 1.0 - 1e-9 for axis in axes):
            names = ", ".join(repr(hole.name) for hole in holes)
            message = f"has holes that are not parallel ({names}), between which no wedges can be made"
            self.problems.append(Problem((self.name, name), f"{message}; make them parts of their own"))
            return []
        radius_m = max(radius for hole in holes for _, radius in hole.rims)
        around_m = radius_m * (1.0 / math.cos(math.pi / SIDES_OF_ROUND) - 1.0)
        within_m = _sagitta_m(part, SIDES_AROUND_HOLES) if isinstance(part, Turned) else 0.0
        self.errors_m.extend((around_m, within_m))
        self.notes.append(
            f"{name!r} has holes; here it is made of wedges around them, so that a hole has {SIDES_OF_ROUND} flat"
            f" sides, up to {around_m:.3g} m outside of it"
            + (
                ""
                if isinstance(part, Box | Convex)
                else f", and the part {SIDES_AROUND_HOLES} sides, up to {within_m:.3g} m within it"
            )
        )
        rough = [str(hole.name) for hole in holes if hole.name in self.friction_of and hole.name != name]
        if rough:
            for one in rough:
                self.replaced.setdefault(one, []).append(name)
            self.notes.append(f"{few(rough)}, a hole with a friction of its own, has that of {name!r} here")
        return [Solid(f"{name}/{index + 1}", name, piece) for index, piece in enumerate(pierced_pieces(part, holes))]


def _sagitta_m(shape: Turned, sides: int) -> float:
    """Return how far flat sides are within a shape at most, metres."""
    return max(radius for _, radius in shape.rims) * (1.0 - math.cos(math.pi / sides))


def rounded_pieces(shape: Convex) -> Iterator[Primitive]:
    """A hull blown up by a radius is exactly its core, a slab on each face, a bar along each edge and a ball at each
    corner, which the bars have at their ends.
    """
    hull, radius, place = shape.hull, shape.radius_m, shape.pose_body_shape
    if hull.dimension == 0:
        yield Sphere(radius, Pose(place.transform(hull.vertices_m[0])))
        return
    if hull.dimension == 3:
        yield Convex(place.transform(hull.vertices_m))
    for loop, normal in zip(hull.faces, hull.normals, strict=True):
        face = hull.vertices_m[list(loop)]
        yield Convex(place.transform(np.concatenate([face, face + radius * normal])))
    for start, end in place.transform(hull.vertices_m)[hull.edges]:
        yield Capsule(radius, float(np.linalg.norm(end - start)), Pose((start + end) / 2.0, turn_from_z(end - start)))
