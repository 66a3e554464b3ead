"""The poses of a run: those that it tells, and others between them and on the travel of an escape."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from audit.solids import rotation_of
from cagepose import Event, Pose, Run, Scene

MOST_POSES = 160
"""Of a run; longer ways are thinned out evenly, but for the ends of events."""
STEP = 0.02
"""Of the size: how far the part moves from pose to pose at most, if `MOST_BETWEEN` allows it."""
MOST_BETWEEN = 24
AHEAD, N_AHEAD = 2.0, 50
"""In sizes: how far the travel of an escape is followed, and at how many poses."""


@dataclass(frozen=True)
class Station:
    """A pose of a run: of event ``event`` of phase ``phase``, the ``number``-th of those looked at; ``is_told`` by the
    run itself, not between two that are.
    """

    phase: int
    event: int
    number: int
    pose: Pose
    is_told: bool


def stations(run: Run) -> list[Station]:
    """Return poses throughout a run, in their order."""
    found = list(_all(run))
    if len(found) <= MOST_POSES:
        return found
    ends = [(a.phase, a.event) != (b.phase, b.event) for a, b in pairwise(found)] + [True]
    kept = set(np.linspace(0, len(found) - 1, MOST_POSES).astype(int).tolist())
    return [one for index, one in enumerate(found) if ends[index] or index in kept]


def farthest_way(scene: Scene, one: Pose, other: Pose) -> float:
    """Return how far a place of the object moves from one pose to another at most, in sizes; or a little more."""
    center = scene.object.center_of_gravity_m
    turned = float(np.linalg.norm(rotation_of(one) - rotation_of(other), 2)) * scene.object.reach_m
    return (turned + float(np.linalg.norm(one.transform(center) - other.transform(center)))) / scene.size_m


def _all(run: Run) -> Iterator[Station]:
    for phase_index, phase in enumerate(run.phases):
        yield Station(phase_index, 0, 0, phase.start_pose, True)
        start = phase.start_pose
        for index, event in enumerate(phase.events):
            for number, (pose, is_told) in enumerate(_poses(run, start, event), start=1):
                yield Station(phase_index, index, number, pose, is_told)
            start = event.pose_world_object


def _poses(run: Run, start: Pose, event: Event) -> Iterator[tuple[Pose, bool]]:
    """Poses of an event after its start: between those that are told, as many as the way is long."""
    motion = event.motion
    if motion is None:
        yield event.pose_world_object, True
        return
    if math.isinf(motion.distance_m):
        for k in range(1, N_AHEAD + 1):
            way = AHEAD * run.scene.size_m * k / N_AHEAD * motion.line_world
            yield Pose(start.position_m + way, start.quaternion_wxyz), False
        return
    told = event.path or (event.pose_world_object,)
    for index, (before, after) in enumerate(pairwise([start, *told])):
        n = int(np.clip(math.ceil(farthest_way(run.scene, before, after) / STEP), 2, MOST_BETWEEN))
        for k in range(1, n):
            yield run.pose_on_the_way(start, event, (index + k / n) / len(told)), False
        yield after, True
