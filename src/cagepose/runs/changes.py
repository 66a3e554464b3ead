"""What each event of a run reaches, and what it leaves."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.run import Event, MotionKind, PhaseRun, Run

MODES = {"slide": "sliding", "pivot": "pivoting", "held": "balanced"}
"""What people read where the rule of an event, as files have it, is not the word of the field."""
SLIGHT_TURN_RAD = 0.1
"""A greater turn looks like one, however far off its axis is."""


class Seen(NamedTuple):
    """A motion as it looks: a slight turn about an axis that is farther off than the scene is large is a travel of the
    centre of gravity, on which the object also turns by ``angle_rad``. Else as in `Motion`.
    """

    kind: MotionKind
    line_world: FloatArray
    through_world: FloatArray | None
    distance_m: float
    angle_rad: float


class Change(NamedTuple):
    """An event, its number in the run from 1 on, its phase, its motion as it looks, and the names that touch from it on
    and those that do no more.
    """

    number: int
    event: Event
    phase: PhaseRun
    seen: Seen | None
    reached: tuple[str, ...]
    left: tuple[str, ...]


def changes_of(run: Run) -> Iterator[Change]:
    """Yield what changes with each event; of what touches from the start on, the first reaches what it hits alone."""
    number = 0
    before: tuple[str, ...] = ()
    for phase in run.phases:
        pose = phase.start_pose
        for event in phase.events:
            number += 1
            is_new = set(event.hit if number == 1 else (*event.hit, *(set(event.contacts) - set(before))))
            reached = tuple(name for name in event.contacts if name in is_new)
            left = tuple(name for name in before if name not in event.contacts)
            yield Change(number, event, phase, as_seen(event, pose, run.scene), reached, left)
            before, pose = event.contacts, event.pose_world_object


def mode_of(rule: str) -> str:
    """Return the contact mode that the rule of an event stands for; rules of the paper stay as they are."""
    return MODES.get(rule, rule)


def as_seen(event: Event, start: Pose, scene: Scene) -> Seen | None:
    """Return an event's motion from a pose as it looks; None where nothing moved."""
    motion, center = event.motion, scene.object.center_of_gravity_m
    if motion is None:
        return None
    if motion.through_world is not None and motion.angle_rad < SLIGHT_TURN_RAD:
        before = start.transform(center)
        lever = np.cross(motion.line_world, before - motion.through_world)
        if np.linalg.norm(lever) > scene.size_m:
            way = event.pose_world_object.transform(center) - before
            distance = float(np.linalg.norm(way))
            return Seen("travel", way / distance, None, distance, motion.angle_rad)
    return Seen(motion.kind, motion.line_world, motion.through_world, motion.distance_m, motion.angle_rad)
