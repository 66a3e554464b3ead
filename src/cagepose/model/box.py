"""A rectangular block: `Box`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cagepose.errors import Key
from cagepose.model.checks import FloatArray, ProblemList, finite_array
from cagepose.model.pose import Pose
from cagepose.model.shapes import Shape, worked_out_once
from cagepose.model.tolerances import DISTANCE_OUTSIDE
from cagepose.model.volume import BOX_SIGNS


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Box(Shape):
    """A rectangular block of the object, or of the cage.

    Attributes
    ----------
    size_m
        Full edge lengths, (3,), metres.
    pose_object_box
        Places the box's centre and axes in the frame of its body: ``pose_body_shape`` by the name it has in an object.
    name
        Shown with its contacts; None becomes "box1", "box2", ... inside an `Object` or a `Cage`.
    """

    kind: ClassVar[str] = "box"
    size_m: FloatArray
    pose_object_box: Pose

    def __init__(self, size_m: ArrayLike, pose_object_box: Pose | None = None, name: str | None = None) -> None:
        """
        Raises
        ------
        SceneError
            A size that is not three finite numbers above zero.
        """
        size = finite_array(size_m, (3,), "size")
        problems = ProblemList()
        for axis, length in enumerate(size.tolist()):
            if length <= 0.0:
                problems.add(("size", axis), f"is {length!r} m; a box's edge lengths must be above zero")
        self._place(pose_object_box, name, problems)
        object.__setattr__(self, "size_m", size)
        object.__setattr__(self, "pose_object_box", self.pose_body_shape)

    def moved(self, pose_body_shape: Pose) -> Self:
        return self._with(pose_body_shape=pose_body_shape, pose_object_box=pose_body_shape)

    def _measures(self) -> str:
        return " x ".join(f"{length:.6g}" for length in self.size_m.tolist()) + " m"

    @worked_out_once
    def corners_object(self) -> FloatArray:
        """The eight corners in the object's frame, (8, 3), metres."""
        return self.pose_object_box.transform(BOX_SIGNS * self.size_m / 2.0)

    def nodes_body(self) -> FloatArray:
        return self.corners_object()

    @worked_out_once
    def limits_m(self) -> FloatArray:
        corners = self.corners_object()
        return np.array([corners.min(axis=0), corners.max(axis=0)])

    def farthest_m(self, point_body: FloatArray) -> float:
        return float(np.linalg.norm(self.corners_object() - point_body, axis=1).max())

    def holds(self, points_body: FloatArray) -> NDArray[np.bool_]:
        local = self.pose_body_shape.inverse_transform(points_body)
        within: NDArray[np.bool_] = (np.abs(local) <= self.size_m / 2.0 + DISTANCE_OUTSIDE * self.size_m.max()).all(
            axis=1
        )
        return within

    def thickness(self) -> list[tuple[tuple[Key, ...], float]]:
        return [(("size", axis), length) for axis, length in enumerate(self.size_m.tolist())]
