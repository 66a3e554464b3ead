"""What holds it: `Cage`."""

from __future__ import annotations

import copy
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from cagepose.errors import Key
from cagepose.model.box import Box
from cagepose.model.cage_body import CageBody
from cagepose.model.cage_elements import Elements, elements_of
from cagepose.model.checks import FloatArray, ProblemList, check_kind, check_kinds, duplicates
from cagepose.model.facets import Facets
from cagepose.model.hole import Hole
from cagepose.model.naming import check_names, names_of, place_of
from cagepose.model.pose import Pose
from cagepose.model.shapes import AnyShape, Shape
from cagepose.model.spring import Spring
from cagepose.model.wording import counted


@dataclass(frozen=True, init=False, eq=False)
class Cage:
    """Points and shapes in the world that stand still, and bodies of such that can be driven.

    Points, names, shapes and holes are those of the whole cage as it is at the start: first what stands still, then
    what is of each body, in their order.

    Attributes
    ----------
    points_cage
        The points in the cage's own frame, (n, 3), metres; n may be zero.
    names
        One name for each point; left out: "C1", "C2", ...
    shapes
        Boxes and other shapes in the cage's own frame, every one with a name.
    holes
        What is cut out of them, and what stands alone; every one with a name.
    pose_world_cage
        Moves all points and shapes at once: the misaligned mechanism.
    bodies
        What can be driven, each in its own frame.
    shape_paths
        For each of the shapes, then of the holes, where its numbers were given: ``("shapes", 2, "cylinder")``, or
        ``("bodies", "mate", "shapes", 0, "box")``.
    standing
        What stands still, alone.
    """

    points_cage: Annotated[FloatArray, (-1, 3)]
    names: tuple[str, ...]
    shapes: tuple[Box | AnyShape | Facets, ...]
    holes: tuple[Hole, ...]
    pose_world_cage: Pose
    bodies: tuple[CageBody, ...]
    shape_paths: tuple[tuple[Key, ...], ...]
    standing: Elements

    def __init__(
        self,
        points: ArrayLike = (),
        names: Sequence[str] | None = None,
        pose: Pose | None = None,
        shapes: Iterable[Shape] = (),
        holes: Iterable[Hole] = (),
        bodies: Iterable[CageBody] = (),
    ) -> None:
        """
        Raises
        ------
        SceneError
            Neither points nor shapes nor bodies, points that are not n x 3 finite numbers, a name used twice, not one
            name for each point, or a hole that is not in its shapes.
        """
        problems = ProblemList()
        pose = Pose() if pose is None else pose
        check_kind(pose, Pose, ("pose",), problems)
        bodies = check_kinds(bodies, CageBody, "bodies", problems)
        standing = elements_of(points, names, shapes, holes, problems)
        every = (standing, *(body.in_cage() for body in bodies))
        if all(found.is_empty for found in every):
            problems.add((), "has neither points nor shapes; give at least one of them")
        for name, indices in duplicates([body.name for body in bodies]).items():
            problems.add(("bodies", name), f"is the name of {len(indices)} bodies; rename all but one")
        problems.raise_if_any()
        of_shapes = (path for found in every for path in found.shape_paths)
        of_holes = (path for found in every for path in found.hole_paths)
        points = np.concatenate([found.points_m for found in every])
        points.setflags(write=False)
        for field, value in (
            ("points_cage", points),
            ("names", tuple(name for found in every for name in found.names)),
            ("shapes", tuple(shape for found in every for shape in found.shapes)),
            ("holes", tuple(hole for found in every for hole in found.holes)),
            ("pose_world_cage", pose),
            ("bodies", bodies),
            ("shape_paths", (*of_shapes, *of_holes)),
            ("standing", standing),
        ):
            object.__setattr__(self, field, value)
        own_names, own_places = [body.name for body in bodies], [("bodies", body.name) for body in bodies]
        check_names([*own_names, *self.element_names], [*own_places, *self.element_paths], problems)
        problems.raise_if_any()

    def placed_at(self, pose: Pose) -> Cage:
        """Return the same cage at another pose in the world."""
        moved = copy.copy(self)
        object.__setattr__(moved, "pose_world_cage", pose)
        return moved

    def with_points(self, points_cage: FloatArray) -> Cage:
        """Return the same cage, which has no bodies, with its points elsewhere, (n, 3)."""
        moved = copy.copy(self)
        object.__setattr__(moved, "points_cage", points_cage)
        object.__setattr__(moved, "standing", self.standing._replace(points_m=points_cage))
        return moved

    def __repr__(self) -> str:
        return f"<Cage: {self._contents}>"

    @property
    def _contents(self) -> str:
        points, shapes = (len(self.names), "point", "points"), (len(self.shapes), "shape", "shapes")
        holes, bodies = (len(self.holes), "hole", "holes"), (len(self.bodies), "body", "bodies")
        return counted(points, shapes, holes, bodies)

    @cached_property
    def element_names(self) -> tuple[str, ...]:
        """The names of all points, then of all shapes, then of all holes."""
        return (*self.names, *names_of(self.shapes), *names_of(self.holes))

    @cached_property
    def element_bodies(self) -> tuple[int, ...]:
        """Of which body each of `element_names` is: 0 stands still, k is of ``bodies[k - 1]``."""
        every = (self.standing, *(body.own for body in self.bodies))
        counts = [(len(found.names), len(found.shapes), len(found.holes)) for found in every]
        return tuple(body for kind in range(3) for body, count in enumerate(counts) for _ in range(count[kind]))

    @cached_property
    def element_paths(self) -> tuple[tuple[Key, ...], ...]:
        """Where each of `element_names` stands in the cage."""
        bodies = self.element_bodies[: len(self.names)]
        of_bodies: list[tuple[Key, ...]] = [(), *(("bodies", body.name) for body in self.bodies)]
        points = ((*of_bodies[body], "points", name) for body, name in zip(bodies, self.names, strict=True))
        return (*points, *map(place_of, self.shape_paths))

    def points_world(self) -> FloatArray:
        """The points in the world, (n, 3), metres."""
        return self.pose_world_cage.transform(self.points_cage)

    def nodes_cage(self) -> FloatArray:
        """The points and those that tell where the shapes lie, in the cage's own frame, (n, 3), metres."""
        return np.concatenate([self.points_cage, *(shape.nodes_body() for shape in (*self.shapes, *self.holes))])

    def spring_end_world(self, spring: Spring) -> FloatArray:
        """Where a spring is held at the start, in the world, (3,), metres; the body it rides on is one of these."""
        if spring.of is None:
            return spring.to_m
        (body,) = (body for body in self.bodies if body.name == spring.of)
        return self.pose_world_cage.transform(body.pose_cage_body.transform(spring.to_m))

    def spring_length_m(self, spring: Spring, pose_world_object: Pose) -> float:
        """How long a spring is where the cage is as at the start and the object at a pose, metres."""
        return float(np.linalg.norm(self.spring_end_world(spring) - pose_world_object.transform(spring.at_object_m)))
