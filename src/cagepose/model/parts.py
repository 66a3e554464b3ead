"""What is held: `Object`."""

from __future__ import annotations

import copy
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from cagepose.errors import Key, Problem, SceneError
from cagepose.model.box import Box
from cagepose.model.checks import FloatArray, ProblemList, check_kind, check_kinds, finite_array, is_finite
from cagepose.model.facets import Facets
from cagepose.model.hole import Hole, check_holes
from cagepose.model.naming import check_names, names_of, placed
from cagepose.model.near_pairs import near_pairs
from cagepose.model.pose import Pose
from cagepose.model.shapes import AnyShape, Disc, Shape
from cagepose.model.tolerances import ROUNDING_OF_INERTIA
from cagepose.model.union import body_moments
from cagepose.model.volume import VolumeMoments
from cagepose.model.wording import counted

MOST_PAIRS = 200_000
"""Pairs of parts that overlap or touch, at most: minutes of work. Of flush cubes in a block each has 13."""


@dataclass(frozen=True, init=False, eq=False)
class Object:
    """One rigid body: a union of boxes and other shapes, a centre of gravity and the pose it starts from.

    Attributes
    ----------
    boxes
        The boxes, every one with a name, those that were given among the shapes last.
    shapes
        The other shapes, every one with a name.
    holes
        What is cut out of them, and what stands alone; every one with a name.
    center_of_gravity_m
        In the object's frame, (3,), metres. Left out: the centroid of the union's volume.
    mass_kg
        None: results are per unit load.
    inertia_kg_m2
        About the centre of gravity, in the object's axes, (3, 3); only together with a mass. None: uniform density of
        the union.
    pose_world_object
        Where the run starts.
    part_paths
        For each of `parts`, then of `holes`, where its numbers were given: ``("boxes", 0)``, ``("shapes", 2, "cone")``.
    """

    boxes: tuple[Box, ...]
    shapes: tuple[AnyShape | Facets, ...]
    holes: tuple[Hole, ...]
    center_of_gravity_m: FloatArray
    mass_kg: float | None
    inertia_kg_m2: Annotated[FloatArray, (3, 3)] | None
    pose_world_object: Pose
    part_paths: tuple[tuple[Key, ...], ...]

    def __init__(
        self,
        boxes: Iterable[Box] = (),
        center_of_gravity_m: ArrayLike | None = None,
        *,
        shapes: Iterable[Shape] = (),
        holes: Iterable[Hole] = (),
        pose: Pose | None = None,
        mass_kg: float | None = None,
        inertia_kg_m2: ArrayLike | None = None,
    ) -> None:
        """
        Raises
        ------
        SceneError
            Arguments of other classes, neither boxes nor shapes, a hole that is not in its parts, a name used twice, a
            mass that is not above zero, an inertia that no body has or without a mass.
        """
        problems = ProblemList()
        given = {
            "boxes": check_kinds(boxes, Box, "boxes", problems),
            "shapes": check_kinds(shapes, Shape, "shapes", problems),
            "holes": check_kinds(holes, Hole, "holes", problems),
        }
        pose = Pose() if pose is None else pose
        check_kind(pose, Pose, ("pose",), problems)
        problems.raise_if_any()
        paths, everything = placed(given, lambda part: 2 if isinstance(part, Hole) else not isinstance(part, Box))
        parts = tuple(part for part in everything if not isinstance(part, Hole))
        if not everything:
            problems.add((), "has neither boxes nor shapes; give at least one of them")
        check_names(names_of(everything), [path[:2] for path in paths], problems)
        holes = tuple(hole for hole in everything if isinstance(hole, Hole))
        _check_crowd(parts, problems)
        check_holes(holes, paths[len(parts) :], parts, problems)
        if mass_kg is not None and not (is_finite(mass_kg) and mass_kg > 0.0):
            problems.add(("mass",), f"is {mass_kg!r}; a mass must be a finite number above zero")
        inertia = None
        try:
            inertia = None if inertia_kg_m2 is None else _checked_inertia(inertia_kg_m2)
        except SceneError as error:
            problems.problems.extend(error.problems)
        if inertia_kg_m2 is not None and mass_kg is None:
            problems.add(("inertia",), "is given without a mass; give object.mass too, or leave the inertia out")
        problems.raise_if_any()
        object.__setattr__(self, "boxes", tuple(part for part in parts if isinstance(part, Box)))
        object.__setattr__(self, "shapes", tuple(part for part in parts if not isinstance(part, Box)))
        object.__setattr__(self, "holes", holes)
        object.__setattr__(self, "part_paths", paths)
        if center_of_gravity_m is None:
            center = self._union_moments.centroid_m
        else:
            center = finite_array(center_of_gravity_m, (3,), "center_of_gravity")
        object.__setattr__(self, "center_of_gravity_m", center)
        if inertia is None and all(isinstance(part, Disc) for part in parts):
            _ = self._union_moments  # says what is missing
        object.__setattr__(self, "mass_kg", None if mass_kg is None else float(mass_kg))
        object.__setattr__(self, "inertia_kg_m2", inertia)
        object.__setattr__(self, "pose_world_object", pose)

    def starting_at(self, pose: Pose) -> Object:
        """Return the same object with another start pose."""
        moved = copy.copy(self)
        object.__setattr__(moved, "pose_world_object", pose)
        return moved

    def __repr__(self) -> str:
        mass = "" if self.mass_kg is None else f", {self.mass_kg:.6g} kg"
        return f"<Object: {self._contents}{mass}>"

    @property
    def _contents(self) -> str:
        boxes, shapes = (len(self.boxes), "box", "boxes"), (len(self.shapes), "shape", "shapes")
        return counted(boxes, shapes, (len(self.holes), "hole", "holes"))

    @cached_property
    def parts(self) -> tuple[Box | AnyShape | Facets, ...]:
        """All boxes, then all other shapes; no holes."""
        return (*self.boxes, *self.shapes)

    @property
    def element_names(self) -> tuple[str, ...]:
        """The names of all boxes, then of all other shapes, then of all holes."""
        return names_of((*self.parts, *self.holes))

    @property
    def reach_m(self) -> float:
        """The distance of the object's farthest point from its centre of gravity, metres."""
        return max(part.farthest_m(self.center_of_gravity_m) for part in (*self.parts, *self.holes))

    @cached_property
    def gyration_m2(self) -> FloatArray:
        """Inertia for each unit of mass, about the centre of gravity, in the object's axes, (3, 3), metres squared.

        The given inertia by the given mass; without one, that of the union at uniform density: the mean of
        (d.d) 1 - d d^T over its volume, d from the centre of gravity, be that the centroid or not.
        """
        if self.inertia_kg_m2 is not None and self.mass_kg is not None:
            gyration = self.inertia_kg_m2 / self.mass_kg
        else:
            offset = self._union_moments.centroid_m - self.center_of_gravity_m
            second = self._union_moments.second_moment_m2 + np.outer(offset, offset)
            squares = second.diagonal()
            # Not from the trace: about the axis of a thin rod, it would leave little but rounding.
            gyration = np.diag(squares[[1, 2, 0]] + squares[[2, 0, 1]]) - (second - np.diag(squares))
        gyration.setflags(write=False)
        return gyration

    @cached_property
    def _union_moments(self) -> VolumeMoments:
        """Taken once, and only where needed: 40 boxes that are turned in all ways take 0.6 s."""
        moments = body_moments(self.parts, self.holes)
        if moments is None:
            remedy = "give its center_of_gravity, mass and inertia, or add a part with a volume"
            raise SceneError([Problem((), f"has no volume, as discs and holes have none; {remedy}")])
        return moments


def _check_crowd(parts: Sequence[Shape], problems: ProblemList) -> None:
    """What each part shares with others is found pair by pair."""
    limits = np.array([part.limits_m() for part in parts]).reshape(-1, 2, 3)
    if len(near_pairs(limits[:, 0], limits[:, 1], MOST_PAIRS)) > MOST_PAIRS:
        found = f"has more than {MOST_PAIRS:,} pairs of parts that overlap or touch, of its {len(parts):,} parts"
        problems.add((), f"{found}; leave out what lies inside others, and make one of what is one")


def _checked_inertia(value: ArrayLike) -> FloatArray:
    """A matrix that some body has: symmetric, positive, no principal moment above the sum of the others."""
    inertia = finite_array(value, (3, 3), "inertia")
    problems = ProblemList()
    scale = float(np.abs(inertia).max())
    if not np.allclose(inertia, inertia.T, rtol=0.0, atol=ROUNDING_OF_INERTIA * scale):
        problems.add(("inertia",), "is not symmetric; give the same number on both sides of the diagonal")
    else:
        low, middle, high = np.linalg.eigvalsh(inertia).tolist()
        if low <= 0.0 or high > (low + middle) * (1.0 + ROUNDING_OF_INERTIA):
            found = f"{low:.6g}, {middle:.6g}, {high:.6g}"
            problems.add(
                ("inertia",),
                f"has principal moments {found}, which no body has: each must be above zero and at most the sum of the"
                " others",
            )
    problems.raise_if_any()
    return inertia
