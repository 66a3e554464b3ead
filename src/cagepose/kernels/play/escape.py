"""The search for a way out of the cage: a tree of travels and turns, each free of collision along its whole way.

A travel that meets nothing is the way out. What is random comes from outside, so a search is the same each time.
"""

from __future__ import annotations

import math
from typing import Annotated

from cagepose.kernels.algebra.pose import Quaternion, moved_pose, rotated
from cagepose.kernels.algebra.record import FloatArray, Rows
from cagepose.kernels.algebra.tolerances import KernelTolerances
from cagepose.kernels.algebra.vector import Vector, norm, plus, row, scaled, vector_from
from cagepose.kernels.collision.first_contact import first_contact_travel, first_contact_turn
from cagepose.kernels.collision.geometry import Geometry, Placement, place_object
from cagepose.kernels.native.kernel import entry, kernel

N_RANDOM = 12
"""Random numbers for each motion that is tried."""
OUT = 4.0
"""Lengths of the scene: how far the way out is followed."""


class Station:
    """A pose of the tree and the motion that leads to it; a record.

    Attributes
    ----------
    parent
        The station before; -1: the start.
    position, quaternion
        The pose.
    along, through
        Unit vector of the motion and, for a turn, a point on its axis.
    distance, angle
        How far it goes, metres and radians; one of them is zero.
    strangeness
        How far the pose is from the start, lengths of the scene and radians.
    """

    parent: int
    position: Annotated[FloatArray, 3]
    quaternion: Annotated[FloatArray, 4]
    along: Annotated[FloatArray, 3]
    through: Annotated[FloatArray, 3]
    distance: float
    angle: float
    strangeness: float


@kernel
def direction_from(dice: FloatArray, first: int, placement: Placement) -> Vector:
    """Return a unit vector from four numbers in [0, 1): any one, an axis of the cage, or one of a box."""
    kind = dice[first]
    if kind < 0.5:
        height = 2.0 * dice[first + 1] - 1.0
        radius = math.sqrt(max(0.0, 1.0 - height * height))
        angle = 2.0 * math.pi * dice[first + 2]
        return (radius * math.cos(angle), radius * math.sin(angle), height)
    axis = int(3.0 * dice[first + 1])
    sign = 1.0 if dice[first + 2] < 0.5 else -1.0
    if kind < 0.7:
        return (sign if axis == 0 else 0.0, sign if axis == 1 else 0.0, sign if axis == 2 else 0.0)
    columns = placement.box_rotations[int(dice[first + 3] * len(placement.box_rotations))]
    return (sign * columns[0, axis], sign * columns[1, axis], sign * columns[2, axis])


@kernel
def chosen_station(dice: FloatArray, stations: Rows[Station], n_stations: int) -> int:
    """Return any station, or the one of two that is farther from the start."""
    one, other = int(dice[0] * n_stations), int(dice[1] * n_stations)
    if dice[2] < 0.6 and stations[other].strangeness > stations[one].strangeness:
        return other
    return one


@kernel
def strangeness_of(position: Vector, quaternion: Quaternion, middle: Vector, length_m: float) -> float:
    moved = plus(position, rotated(quaternion, middle))
    away = (moved[0] - middle[0], moved[1] - middle[1], moved[2] - middle[2])
    return norm(away) / length_m + 2.0 * norm((quaternion[1], quaternion[2], quaternion[3]))


@entry
def grow_tree(
    geometry: Geometry,
    length_m: float,
    dice: FloatArray,
    stations: Rows[Station],
    n_stations: int,
    placement: Placement,
    tolerances: KernelTolerances,
) -> tuple[int, bool]:
    """Try one motion for each row of ``dice``; return (number of stations, whether the last one is out).

    Parameters
    ----------
    geometry, length_m
        As in `cagepose.kernels.play.search.find_play`.
    dice
        Random numbers in [0, 1), (n_trials, N_RANDOM).
    stations, n_stations
        The tree so far, its first station being the start; there is room for one more for each trial.
    placement, tolerances
        Room, and see there.
    """
    middle = row(geometry.box_positions, 0)
    used = n_stations
    for trial in range(len(dice)):
        numbers = dice[trial]
        parent = chosen_station(numbers, stations, used)
        start = stations[parent]
        position = vector_from(start.position)
        quaternion = (start.quaternion[0], start.quaternion[1], start.quaternion[2], start.quaternion[3])
        place_object(geometry, position, quaternion, placement)
        along = direction_from(numbers, 3, placement)
        through = (0.0, 0.0, 0.0)
        distance, angle = 0.0, 0.0
        is_out = False
        if numbers[7] < 0.5:
            free, _, _ = first_contact_travel(geometry, placement, along, -math.inf, tolerances)
            is_out = free == math.inf
            distance = OUT * length_m if is_out else free * numbers[8]
        else:
            point = row(geometry.points_world, int(numbers[9] * len(geometry.points_world)))
            through = scaled(point, 1.5 * numbers[10])
            key, _ = first_contact_turn(geometry, placement, through, along, tolerances)
            free = math.pi if key == math.inf else min(math.pi, 2.0 * math.atan2(1.0, -key))
            angle = 0.0 if key == -math.inf else free * numbers[8]
        if distance <= tolerances.touch_m and angle * length_m <= tolerances.touch_m:
            continue
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
        station.strangeness = strangeness_of(new_position, new_quaternion, middle, length_m)
        used += 1
        if is_out:
            return used, True
    return used, False
