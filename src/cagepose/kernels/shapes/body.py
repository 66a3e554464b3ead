"""The object's shapes at one pose: each part is placed when it is asked for, as most are far from everything."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.pose import Quaternion, matrix_from_quaternion
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.vector import Matrix, Vector, row
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.shapes.features import Shapes, copied, place_features, place_part


class PlacedBody(NamedTuple):
    """Shapes of the object and the pose that they are at.

    Attributes
    ----------
    world
        In the world: the balls around all parts, and the features of those that have been asked for.
    is_placed
        Whose have been, (n_parts,).
    pose
        Position, and rows of the rotation matrix, (4, 3).
    """

    world: Shapes
    is_placed: NDArray[np.bool_]
    pose: FloatArray


def empty_body(shapes: Shapes) -> PlacedBody:
    """Return memory for shapes at a pose (plain Python)."""
    return PlacedBody(copied(shapes), np.zeros(len(shapes.parts), np.bool_), np.zeros((4, 3)))


@kernel
def place_body(own: Shapes, position: Vector, quaternion: Quaternion, body: PlacedBody) -> None:
    """Place the balls around all parts at a pose."""
    rotation = matrix_from_quaternion(quaternion)
    for k in range(3):
        body.pose[0, k] = position[k]
        for j in range(3):
            body.pose[1 + j, k] = rotation[j][k]
    for which in range(len(own.parts)):
        body.is_placed[which] = False
        place_part(own, which, position, rotation, body.world)


@kernel
def rotation_of(body: PlacedBody) -> Matrix:
    return (row(body.pose, 1), row(body.pose, 2), row(body.pose, 3))


@kernel
def place_asked(own: Shapes, which: int, body: PlacedBody) -> None:
    """Place the features of a part, if they are not."""
    if not body.is_placed[which]:
        body.is_placed[which] = True
        place_features(own, which, row(body.pose, 0), rotation_of(body), body.world)
