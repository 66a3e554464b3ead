"""The contacts at the present pose, in the order in which they were made, with their angles to the load (R4)."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.tolerances import KernelTolerances
from cagepose.kernels.algebra.vector import Vector, cross, dot, norm
from cagepose.kernels.collision.boxes import BoxesAndPoints, PlacedBoxes
from cagepose.kernels.collision.contacts import steepest_contact
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.stepwise.support import PointLoad


class Touching(NamedTuple):
    """The contacts at the present pose.

    Attributes
    ----------
    order
        Indices of the points that touch, the longest touching first, (n_points,), of which `n_touching` are used.
    n_touching
        How many points touch, (1,).
    is_touching, was_touching
        Which points touch now, and which touched before the last motion, (n_points,).
    alphas
        Angle between each touching point's normal and the load, (n_points,), radians.
    normals
        Normal of each touching point, (n_points, 3).
    is_tie
        Whether the point lies on an edge whose faces make the same angle with the load, (n_points,).
    chosen
        Memory for the contacts that a rule works on, (n_points,).
    """

    order: NDArray[np.int64]
    n_touching: NDArray[np.int64]
    is_touching: NDArray[np.bool_]
    was_touching: NDArray[np.bool_]
    alphas: FloatArray
    normals: FloatArray
    is_tie: NDArray[np.bool_]
    chosen: NDArray[np.int64]


def empty_touching(n_points: int) -> Touching:
    """Return a workspace for the contacts of one pose, none of them touching yet (plain Python)."""
    return Touching(
        np.empty(n_points, np.int64),
        np.zeros(1, np.int64),
        np.zeros(n_points, np.bool_),
        np.zeros(n_points, np.bool_),
        np.empty(n_points),
        np.empty((n_points, 3)),
        np.zeros(n_points, np.bool_),
        np.empty(n_points, np.int64),
    )


@kernel
def load_angle(normal: Vector, direction: Vector) -> float:
    """Return the angle between a normal and a direction, right to the last digits at both ends of its range."""
    return math.atan2(norm(cross(normal, direction)), dot(normal, direction))


@kernel
def find_touching(
    geometry: BoxesAndPoints, placement: PlacedBoxes, load: PointLoad, tolerances: KernelTolerances, touching: Touching
) -> None:
    """Step (*): find all contacts again. Points that still touch keep their place in the order, new ones come after."""
    for point in range(len(geometry.points_world)):
        touching.was_touching[point] = touching.is_touching[point]
        touching.is_touching[point] = touching.is_tie[point] = False
        if placement.depths[point] < -tolerances.touch_m:
            continue  # before the call: passing all arrays costs more than many a kernel
        touches, normal, is_tie = steepest_contact(geometry, placement, point, load.direction, tolerances)
        touching.is_touching[point] = touches
        touching.is_tie[point] = is_tie
        if not touches:
            continue
        touching.alphas[point] = load_angle(normal, load.direction)
        for k in range(3):
            touching.normals[point, k] = normal[k]
    n_listed = 0
    for i in range(touching.n_touching[0]):
        point = touching.order[i]
        if touching.is_touching[point]:
            touching.order[n_listed] = point
            n_listed += 1
    for point in range(len(geometry.points_world)):
        if touching.is_touching[point] and not touching.was_touching[point]:
            touching.order[n_listed] = point
            n_listed += 1
    touching.n_touching[0] = n_listed


@kernel
def choose_below(touching: Touching, angle_rad: float) -> int:
    """Write the contacts whose angle to the load is at most ``angle_rad`` into ``chosen``; return how many."""
    n_chosen = 0
    for i in range(touching.n_touching[0]):
        point = touching.order[i]
        if touching.alphas[point] <= angle_rad:
            touching.chosen[n_chosen] = point
            n_chosen += 1
    return n_chosen


@kernel
def has_face_tie(touching: Touching) -> bool:
    """Whether a touching point lies on an edge whose faces make the same angle with the load."""
    found = False
    for i in range(touching.n_touching[0]):
        found = found or touching.is_tie[touching.order[i]]
    return found
