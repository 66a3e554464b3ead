"""What is held: `Box` and `Object`."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from cagepose.errors import SceneError
from cagepose.model.checks import FloatArray, ProblemList, check_kind, check_kinds, duplicates, finite_array
from cagepose.model.pose import Pose
from cagepose.model.volume import BOX_SIGNS, VolumeMoments, union_moments


@dataclass(frozen=True, init=False, eq=False)
class Box:
    """A rectangular block of the object.

    Attributes
    ----------
    size_m
        Full edge lengths, (3,), metres.
    pose_object_box
        Places the box's centre and axes in the object's frame.
    name
        Shown with its contacts; None becomes "box1", "box2", ... inside an `Object`.
    """

    size_m: FloatArray
    pose_object_box: Pose
    name: str | None

    def __init__(self, size_m: ArrayLike, pose_object_box: Pose | None = None, name: str | None = None) -> None:
        """
        Raises
        ------
        SceneError
            A size that is not three finite numbers above zero.
        """
        size = finite_array(size_m, (3,), "size")
        problems = ProblemList()
        check_kind(pose_object_box or Pose(), Pose, ("pose",), problems)
        for axis, length in enumerate(size.tolist()):
            if length <= 0.0:
                problems.add(("size", axis), f"is {length!r} m; a box's edge lengths must be above zero")
        problems.raise_if_any()
        object.__setattr__(self, "size_m", size)
        object.__setattr__(self, "pose_object_box", pose_object_box or Pose())
        object.__setattr__(self, "name", name)

    def corners_object(self) -> FloatArray:
        """The eight corners in the object's frame, (8, 3), metres."""
        return self.pose_object_box.transform(BOX_SIGNS * self.size_m / 2.0)


@dataclass(frozen=True, init=False, eq=False)
class Object:
    """One rigid body: a union of boxes, a centre of gravity and the pose it starts from.

    Attributes
    ----------
    boxes
        The boxes, every one with a name.
    center_of_gravity_m
        In the object's frame, (3,), metres. Left out: the centroid of the union's volume.
    mass_kg
        None: results are per unit load.
    inertia_kg_m2
        About the centre of gravity, in the object's axes, (3, 3); only together with a mass. None: uniform density of
        the union.
    pose_world_object
        Where the run starts.
    """

    boxes: tuple[Box, ...]
    center_of_gravity_m: FloatArray
    mass_kg: float | None
    inertia_kg_m2: Annotated[FloatArray, (3, 3)] | None
    pose_world_object: Pose

    def __init__(
        self,
        boxes: Iterable[Box],
        center_of_gravity_m: ArrayLike | None = None,
        *,
        pose: Pose | None = None,
        mass_kg: float | None = None,
        inertia_kg_m2: ArrayLike | None = None,
    ) -> None:
        """
        Raises
        ------
        SceneError
            Arguments of other classes, no boxes, a name used twice, a mass that is not above zero, an inertia that no
            body has or without a mass.
        """
        problems = ProblemList()
        boxes = check_kinds(boxes, Box, "boxes", problems)
        check_kind(pose or Pose(), Pose, ("pose",), problems)
        problems.raise_if_any()
        named = tuple(
            box if box.name is not None else Box(box.size_m, box.pose_object_box, f"box{index + 1}")
            for index, box in enumerate(boxes)
        )
        if not named:
            problems.add(("boxes",), "is empty; an object needs at least one box")
        for name, indices in duplicates([str(box.name) for box in named]).items():
            problems.add(
                ("boxes", indices[1], "name"), f"{name!r} is already the name of boxes[{indices[0]}]; rename one"
            )
        if mass_kg is not None and not (np.isfinite(mass_kg) and mass_kg > 0.0):
            problems.add(("mass",), f"is {mass_kg!r}; a mass must be a finite number above zero")
        inertia = None
        try:
            inertia = None if inertia_kg_m2 is None else _checked_inertia(inertia_kg_m2)
        except SceneError as error:
            problems.problems.extend(error.problems)
        if inertia_kg_m2 is not None and mass_kg is None:
            problems.add(("inertia",), "is given without a mass; give object.mass too, or leave the inertia out")
        problems.raise_if_any()
        object.__setattr__(self, "boxes", named)
        if center_of_gravity_m is None:
            center = self._union_moments.centroid_m
        else:
            center = finite_array(center_of_gravity_m, (3,), "center_of_gravity")
        object.__setattr__(self, "center_of_gravity_m", center)
        object.__setattr__(self, "mass_kg", None if mass_kg is None else float(mass_kg))
        object.__setattr__(self, "inertia_kg_m2", inertia)
        object.__setattr__(self, "pose_world_object", pose or Pose())

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
        return union_moments(
            np.array([box.size_m for box in self.boxes]) / 2.0,
            np.array([box.pose_object_box.position_m for box in self.boxes]),
            np.array([box.pose_object_box.rotation for box in self.boxes]),
        )


def _checked_inertia(value: ArrayLike) -> FloatArray:
    """A matrix that some body has: symmetric, positive, no principal moment above the sum of the others."""
    inertia = finite_array(value, (3, 3), "inertia")
    problems = ProblemList()
    scale = float(np.abs(inertia).max())
    if not np.allclose(inertia, inertia.T, rtol=0.0, atol=1e-9 * scale):
        problems.add(("inertia",), "is not symmetric; give the same number on both sides of the diagonal")
    else:
        low, middle, high = np.linalg.eigvalsh(inertia).tolist()
        if low <= 0.0 or high > (low + middle) * (1.0 + 1e-9):
            found = f"{low:.6g}, {middle:.6g}, {high:.6g}"
            problems.add(
                ("inertia",),
                f"has principal moments {found}, which no body has: each must be above zero and at most the sum of the"
                " others",
            )
    problems.raise_if_any()
    return inertia
