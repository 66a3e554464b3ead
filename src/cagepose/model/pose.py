"""Where something is: `Pose`."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from cagepose.errors import Problem, SceneError
from cagepose.kernels.algebra import pose as kernel
from cagepose.kernels.algebra.vector import Vector
from cagepose.model.checks import FloatArray, as_vector, finite_array, unit_rows
from cagepose.model.wording import coordinates


@dataclass(frozen=True, init=False, eq=False)
class Pose:
    """A rigid placement: maps coordinates of a part's frame to those of the frame it stands in.

    Attributes
    ----------
    position_m
        Origin of the part's frame, (3,), metres.
    quaternion_wxyz
        Orientation, (4,), unit length, scalar first, ``w >= 0``.

    >>> Pose(euler_zyx=(np.pi / 2, 0.0, 0.0)).transform([1.0, 0.0, 0.0]).round(12).tolist()
    [0.0, 1.0, 0.0]
    """

    position_m: FloatArray
    quaternion_wxyz: Annotated[FloatArray, (4,)]

    def __init__(
        self,
        position_m: ArrayLike = (0.0, 0.0, 0.0),
        quaternion_wxyz: ArrayLike | None = None,
        *,
        euler_zyx: ArrayLike | None = None,
    ) -> None:
        """Give the orientation as a quaternion (of any length but zero), or as intrinsic ZYX angles in radians.

        Raises
        ------
        SceneError
            Wrong shape, NaN or infinite, a zero quaternion, or both forms of orientation at once.
        """
        if quaternion_wxyz is not None and euler_zyx is not None:
            raise SceneError([Problem((), "has both a quaternion and Euler angles; keep one of them")])
        if euler_zyx is not None:
            quaternion = quaternions_of(finite_array(euler_zyx, (3,), "euler_zyx")[None])[0]
        elif quaternion_wxyz is not None:
            given = finite_array(quaternion_wxyz, (4,), "quat_wxyz")
            largest = float(np.abs(given).max())
            if largest == 0.0:
                raise SceneError([Problem(("quat_wxyz",), "is zero; no rotation is: use [1, 0, 0, 0]")])
            # A quaternion that is unit to rounding is kept to the last digit, so that saved poses come back unchanged.
            is_unit = largest <= 1.0 and abs(float(np.linalg.norm(given)) - 1.0) < 1e-15
            scaled = given / largest  # so that the squares of tiny or huge components neither vanish nor overflow
            quaternion = given.copy() if is_unit else scaled / np.linalg.norm(scaled)
        else:
            quaternion = np.array([1.0, 0.0, 0.0, 0.0])
        if quaternion[0] < 0.0:
            quaternion = -quaternion
        object.__setattr__(self, "position_m", finite_array(position_m, (3,), "position"))
        object.__setattr__(self, "quaternion_wxyz", _fixed(quaternion))

    def __repr__(self) -> str:
        turned = (
            f", yaw pitch roll {coordinates(np.degrees(self.euler_zyx))} deg" if self.quaternion_wxyz[0] < 1.0 else ""
        )
        return f"<Pose {coordinates(self.position_m)} m{turned}>"

    @classmethod
    def from_unit(cls, position_m: FloatArray, quaternion_wxyz: FloatArray) -> Pose:
        """Return the pose of arrays that cannot be written to, the quaternion being unit with w >= 0: unchecked, as
        results have thousands of them.
        """
        pose = object.__new__(cls)
        object.__setattr__(pose, "__dict__", {"position_m": position_m, "quaternion_wxyz": quaternion_wxyz})
        return pose

    @cached_property
    def rotation(self) -> FloatArray:
        """Rotation matrix, (3, 3): the part's axes are its columns."""
        return _fixed(np.array(kernel.matrix_from_quaternion(self.as_tuples()[1])))

    @property
    def euler_zyx(self) -> tuple[float, float, float]:
        """Intrinsic ZYX angles (yaw about z, pitch about y, roll about x) in radians: R = Rz Ry Rx."""
        return kernel.euler_zyx_from_quaternion(self.as_tuples()[1])

    @property
    def key(self) -> tuple[bytes, bytes]:
        """What poses have in common that are the same to the last digit."""
        return self.position_m.tobytes(), self.quaternion_wxyz.tobytes()

    def as_tuples(self) -> tuple[Vector, kernel.Quaternion]:
        """Return (position in metres, quaternion), as kernels take them."""
        w, x, y, z = self.quaternion_wxyz.tolist()
        return as_vector(self.position_m), (w, x, y, z)

    def transform(self, points: ArrayLike) -> FloatArray:
        """Map points, (3,) or (n, 3) in metres, from the part's frame to the outer one."""
        array: FloatArray = np.asarray(points, dtype=np.float64) @ self.rotation.T + self.position_m
        return array

    def inverse_transform(self, points: ArrayLike) -> FloatArray:
        """Map points, (3,) or (n, 3) in metres, from the outer frame to the part's."""
        array: FloatArray = (np.asarray(points, dtype=np.float64) - self.position_m) @ self.rotation
        return array

    def __matmul__(self, inner: Pose) -> Pose:
        """Compose: ``pose_a_b @ pose_b_c`` is ``pose_a_c``."""
        product = np.array(kernel.quaternion_product(self.as_tuples()[1], inner.as_tuples()[1]))
        upright = -product if product[0] < 0.0 else product
        return Pose.from_unit(_fixed(self.transform(inner.position_m)), _fixed(upright))

    def inverse(self) -> Pose:
        """Return the pose that undoes this one."""
        conjugate = self.quaternion_wxyz * (1.0, -1.0, -1.0, -1.0)
        return Pose.from_unit(_fixed(-(self.rotation.T @ self.position_m)), _fixed(conjugate))


def _fixed(numbers: FloatArray) -> FloatArray:
    numbers.setflags(write=False)
    return numbers


def quaternions_of(angles_zyx: FloatArray) -> FloatArray:
    """Return the quaternions (n, 4), w >= 0, of rows of intrinsic ZYX angles (n, 3) in radians."""
    found = np.empty((len(angles_zyx), 4))
    kernel.write_quaternions(angles_zyx, found)
    return found


def placed(points: FloatArray, position_m: FloatArray, quaternion_wxyz: FloatArray) -> FloatArray:
    """Map points by many poses at once, (..., 3), (..., 3) and (..., 4), which broadcast; quaternions of length one."""
    scalar, vector = quaternion_wxyz[..., :1], quaternion_wxyz[..., 1:]
    across = 2.0 * np.cross(vector, points)
    found: FloatArray = points + scalar * across + np.cross(vector, across) + position_m
    return found


def turn_from_z(axis: FloatArray) -> FloatArray:
    """Return a quaternion that turns z to the direction of ``axis``, (3,), which is not zero."""
    along = unit_rows(axis[None])[0]
    halfway = along + np.array((0.0, 0.0, 1.0))
    if float(np.linalg.norm(halfway)) < 1e-8:
        return np.array((0.0, 1.0, 0.0, 0.0))
    x, y, z = unit_rows(halfway[None])[0].tolist()
    return np.array((z, -y, x, 0.0))  # half a turn about the line between them, after half a turn about z
