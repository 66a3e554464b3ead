"""The search for a way out of the cage: a tree of travels and turns, each free of collision along its whole way.

A travel that meets nothing is the way out. What is random comes from outside, so a search is the same each time.
"""

from __future__ import annotations

import math
from typing import Annotated

from cagepose.kernels.algebra.pose import Quaternion, moved_pose, rotated
from cagepose.kernels.algebra.record import FloatArray, Rows
from cagepose.kernels.algebra.tolerances import KernelTolerances
from cagepose.kernels.algebra.vector import Vector, minus, norm, plus, row, scaled, vector_from
from cagepose.kernels.collision.boxes import BoxesAndPoints, PlacedBoxes, place_boxes_at
from cagepose.kernels.collision.first_contact import first_contact_travel, first_contact_turn
from cagepose.kernels.native.kernel import entry, kernel

N_RANDOM = 12
"""Random numbers for each motion that is tried."""
LENGTH_OF_WAY_OUT = 4.0
"""Lengths of the scene. The way out is followed so far."""


class Station:
    """A pose of the tree and the motion that leads to it; a record.

    Attributes
    ----------
    parent
        The station before; -1: the start.
    position, quaternion
        The pose; lengths of the scene.
    along, through
        Unit vector of the motion and, for a turn, a point on its axis.
    distance, angle
        How far it goes, lengths of the scene and radians; one of them is zero.
    from_start
        Distance of the pose from the start, lengths of the scene and radians.
    """

    parent: int
    position: Annotated[FloatArray, 3]
    quaternion: Annotated[FloatArray, 4]
    along: Annotated[FloatArray, 3]
    through: Annotated[FloatArray, 3]
    distance: float
    angle: float
    from_start: float


@kernel
def random_direction(samples: FloatArray, placement: PlacedBoxes) -> Vector:
    """Return a unit vector from four numbers in [0, 1): any one, an axis of the cage, or one of a box."""
    kind = samples[0]
    if kind < 0.5:
        height = 2.0 * samples[1] - 1.0
        radius = math.sqrt(max(0.0, 1.0 - height * height))
        angle = 2.0 * math.pi * samples[2]
        return (radius * math.cos(angle), radius * math.sin(angle), height)
    axis = int(3.0 * samples[1])
    sign = 1.0 if samples[2] < 0.5 else -1.0
    if kind < 0.7:
        return (sign if axis == 0 else 0.0, sign if axis == 1 else 0.0, sign if axis == 2 else 0.0)
    columns = placement.box_rotations[int(samples[3] * len(placement.box_rotations))]
    return (sign * columns[0, axis], sign * columns[1, axis], sign * columns[2, axis])


@kernel
def random_parent(samples: FloatArray, stations: Rows[Station], n_stations: int) -> int:
    """Return, from three numbers in [0, 1), any station, or the one of two that is farther from the start."""
    one, other = int(samples[0] * n_stations), int(samples[1] * n_stations)
    return other if samples[2] < 0.6 and stations[other].from_start > stations[one].from_start else one


@kernel
def distance_from_start(position: Vector, quaternion: Quaternion, middle: Vector) -> float:
    """Return how far the first box has gone, and twice the sine of half the angle by which it has turned."""
    away = minus(plus(position, rotated(quaternion, middle)), middle)
    return norm(away) + 2.0 * norm((quaternion[1], quaternion[2], quaternion[3]))


@entry
def grow_tree(
    geometry: BoxesAndPoints,
    samples: FloatArray,
    stations: Rows[Station],
    n_stations: int,
    placement: PlacedBoxes,
    tolerances: KernelTolerances,
) -> tuple[int, bool]:
    """Try one motion for each row of random samples; return (number of stations, whether the last one is out).

    Parameters
    ----------
    geometry
        As in `cagepose.kernels.play.search.find_play`.
    samples
        Random numbers in [0, 1), (n_trials, N_RANDOM).
    stations, n_stations
        The tree so far, its first station being the start; there is room for one more for each trial.
    placement, tolerances
        Workspace, and see there; lengths of the scene.
    """
    middle = row(geometry.box_positions, 0)
    used = n_stations
    for trial in range(len(samples)):
        sample = samples[trial]

        # A motion from a station of the tree, in a random direction.
        parent = random_parent(sample, stations, used)
        start = stations[parent]
        position, q = vector_from(start.position), start.quaternion
        quaternion = (q[0], q[1], q[2], q[3])
        place_boxes_at(geometry, position, quaternion, placement)
        along = random_direction(sample[3:7], placement)
        through = (0.0, 0.0, 0.0)
        distance, angle = 0.0, 0.0
        is_out = False

        # As far as a random share of what is free, or out.
        if sample[7] < 0.5:
            free, _, _ = first_contact_travel(geometry, placement, along, -math.inf, tolerances)
            is_out = free == math.inf
            distance = LENGTH_OF_WAY_OUT if is_out else free * sample[8]
        else:
            through = scaled(row(geometry.points_world, int(sample[9] * len(geometry.points_world))), 1.5 * sample[10])
            key, _ = first_contact_turn(geometry, placement, through, along, tolerances)
            free = math.pi if key == math.inf else min(math.pi, 2.0 * math.atan2(1.0, -key))
            angle = 0.0 if key == -math.inf else free * sample[8]
        if distance <= tolerances.touch_m and angle <= tolerances.touch_m:
            continue

        # It leads to a new station.
        new_position, new_quaternion = moved_pose(position, quaternion, along, through, distance, angle)
        station = stations[used]
        station.parent = parent
        for k in range(3):
            station.position[k] = new_position[k]
            station.along[k] = along[k]
            station.through[k] = through[k]
        for k in range(4):
            station.quaternion[k] = new_quaternion[k]
        station.distance, station.angle = distance, angle
        station.from_start = distance_from_start(new_position, new_quaternion, middle)
        used += 1
        if is_out:
            return used, True
    return used, False
