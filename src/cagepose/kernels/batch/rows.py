"""Many runs of one object: what differs from run to run, and where each run ends."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.pose import Quaternion, rotated
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.tolerances import KernelTolerances
from cagepose.kernels.algebra.vector import Vector, minus, norm, plus, row, scaled
from cagepose.kernels.collision.geometry import Geometry, Placement, place_object
from cagepose.kernels.native.kernel import kernel

NOT_RUN = -1
"""Verdict code of a phase that was not reached."""
INVALID = 100
"""Verdict code of a first phase that has no valid start; the others are those of `cagepose.kernels.trace`."""


class Starts(NamedTuple):
    """What differs: each array has one row for each run, or one for all.

    Attributes
    ----------
    cage_positions, cage_quaternions
        The cage's pose in the world, (n, 3) metres and (n, 4).
    points_cage
        (n, n_points, 3), metres.
    object_positions, object_quaternions
        The object's pose in the world at the start.
    sizes_m
        The scene's size, (n,).
    frictions
        Coefficient of friction, (n,).
    farthest
        In sizes of the scene: an object that starts farther from the middle of the cage has no valid start.
    """

    cage_positions: FloatArray
    cage_quaternions: FloatArray
    points_cage: FloatArray
    object_positions: FloatArray
    object_quaternions: FloatArray
    sizes_m: FloatArray
    frictions: FloatArray
    farthest: float


class Endings(NamedTuple):
    """Where each phase of each run ended.

    Attributes
    ----------
    verdicts, n_events
        Codes, and how many events (stepwise) or steps (quasistatic) it took, (n, n_phases).
    proofs
        Code where a quasistatic phase comes to rest, (n, n_phases).
    positions, quaternions
        The object's pose in the world, (n, n_phases, 3) metres and (n, n_phases, 4).
    touching
        Which cage points touch, (n, n_phases, n_points).
    """

    verdicts: NDArray[np.int64]
    proofs: NDArray[np.int64]
    n_events: NDArray[np.int64]
    positions: FloatArray
    quaternions: FloatArray
    touching: NDArray[np.bool_]


def empty_endings(n_runs: int, n_phases: int, n_points: int) -> Endings:
    """Return room for the ends of many runs (plain Python)."""
    return Endings(
        np.full((n_runs, n_phases), NOT_RUN),
        np.full((n_runs, n_phases), NOT_RUN),
        np.zeros((n_runs, n_phases), np.int64),
        np.full((n_runs, n_phases, 3), np.nan),
        np.full((n_runs, n_phases, 4), np.nan),
        np.zeros((n_runs, n_phases, n_points), np.bool_),
    )


@kernel
def at_run(n_rows: int, run: int) -> int:
    """Return the row of a run in an array with one row for each run, or one for all."""
    return run if n_rows > 1 else 0


@kernel
def quaternion_row(quaternions: FloatArray, index: int) -> Quaternion:
    q = quaternions[index]
    return (q[0], q[1], q[2], q[3])


@kernel
def scaled_tolerances(of_size: KernelTolerances, size_m: float) -> KernelTolerances:
    """Scale tolerances that are given for a scene of size 1."""
    return KernelTolerances(
        of_size.touch_m * size_m, of_size.resolution_m * size_m, of_size.rounding_m * size_m, of_size.tie
    )


@kernel
def place_cage(starts: Starts, run: int, geometry: Geometry) -> Vector:
    """Write the cage points as seen from their middle; return the middle in the world."""
    points = starts.points_cage[at_run(len(starts.points_cage), run)]
    position = row(starts.cage_positions, at_run(len(starts.cage_positions), run))
    quaternion = quaternion_row(starts.cage_quaternions, at_run(len(starts.cage_quaternions), run))
    middle = (0.0, 0.0, 0.0)
    for point in range(len(points)):
        middle = plus(middle, row(points, point))
    middle = scaled(middle, 1.0 / len(points))
    for point in range(len(points)):
        placed = rotated(quaternion, minus(row(points, point), middle))
        for k in range(3):
            geometry.points_world[point, k] = placed[k]
    return plus(position, rotated(quaternion, middle))


@kernel
def object_start(starts: Starts, run: int, middle_object: Vector, origin_world: Vector) -> tuple[Vector, Quaternion]:
    """Return where the middle of the object starts, seen from the middle of the cage, and its orientation."""
    quaternion = quaternion_row(starts.object_quaternions, at_run(len(starts.object_quaternions), run))
    position = row(starts.object_positions, at_run(len(starts.object_positions), run))
    return plus(minus(position, origin_world), rotated(quaternion, middle_object)), quaternion


@kernel
def is_valid_start(
    geometry: Geometry,
    starts: Starts,
    position: Vector,
    quaternion: Quaternion,
    size_m: float,
    touch_m: float,
    placement: Placement,
) -> bool:
    """Whether the object starts near the cage, no point is inside it, and no two points that vary are one.

    The placement is that of the start afterwards.
    """
    if norm(position) > starts.farthest * size_m:
        return False
    place_object(geometry, position, quaternion, placement)
    n_points = len(geometry.points_world)
    for point in range(n_points):
        if placement.depths[point] > touch_m:
            return False
        if len(starts.points_cage) > 1:
            here = row(geometry.points_world, point)
            for other in range(point):
                if norm(minus(row(geometry.points_world, other), here)) <= touch_m:
                    return False
    return True


@kernel
def write_ending(
    endings: Endings,
    run: int,
    phase: int,
    verdict: int,
    n_events: int,
    position: Vector,
    quaternion: Quaternion,
    middle_object: Vector,
    origin_world: Vector,
) -> None:
    """Write how a phase ended, the pose in the world; `Endings.touching` is left to the method."""
    placed = plus(origin_world, minus(position, rotated(quaternion, middle_object)))
    endings.verdicts[run, phase] = verdict
    endings.n_events[run, phase] = n_events
    for k in range(3):
        endings.positions[run, phase, k] = placed[k]
    for k in range(4):
        endings.quaternions[run, phase, k] = quaternion[k]
