"""Boundaries of parts at poses, and what compiled kernels say of them."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np

from cagepose import Pose
from cagepose.kernels.algebra.motion import Motion
from cagepose.kernels.boundary.features import PlacedBoundary, empty_placed, place_boundary
from cagepose.kernels.boundary.first_meeting import Hit, Search, first_to_meet
from cagepose.kernels.boundary.groups import number_groups
from cagepose.kernels.boundary.meetings import find_meetings
from cagepose.kernels.boundary.queue import empty_queue
from cagepose.kernels.boundary.touching import Meetings, empty_meetings
from cagepose.model.boundary.features import boundary_of
from cagepose.model.shapes import Shape
from inner_kernels import as_machine_code


@cache
def kernels() -> tuple[Any, ...]:
    return tuple(as_machine_code(inner) for inner in (place_boundary, find_meetings, number_groups, first_to_meet))


class Asked:
    """An object and a cage, both in their own frames at first."""

    def __init__(self, held: Sequence[Shape], cage: Sequence[Shape], touch_m: float) -> None:
        self.held, self.cage = empty_placed(boundary_of(held, touch_m)), empty_placed(boundary_of(cage, touch_m))
        self.moved, self.queue = empty_placed(self.held.own), empty_queue()
        self.found = empty_meetings(max(len(self.held.own.features), len(self.cage.own.features)))
        self.touch_m = touch_m
        for body in (self.held, self.cage):
            kernels()[0](body, *Pose().as_tuples())

    def place(self, pose: Pose) -> Meetings:
        """Place the object and find what touches."""
        place, find, group, _ = kernels()
        place(self.held, *pose.as_tuples())
        find(self.held, self.cage, self.touch_m, self.found)
        group(self.held, self.cage, self.touch_m, self.found)
        return self.found

    def first(self, motion: Motion, end: float, near_m: float = 0.0, near_depth_m: float = 0.0) -> Hit:
        """Ask what the object reaches first from where it is placed."""
        middle, reach = ball_around(self.held)
        at = np.array(self.held.pose[0]) + self.held.pose[1:] @ middle
        drift = np.array(motion.velocity) + np.cross(motion.rate * np.array(motion.axis), at - np.array(motion.center))
        speed = float(np.linalg.norm(drift) + motion.rate * reach)
        size = reach + ball_around(self.cage)[1]
        search = Search(motion, end, near_m, near_depth_m, speed, self.touch_m, size)
        return Hit(*kernels()[3](self.held, self.cage, search, self.found, self.queue, self.moved))


def ball_around(body: PlacedBoundary) -> tuple[np.ndarray, float]:
    """Return middle and radius of a ball around a body in its own frame."""
    roots = body.own.nodes[:3]
    roots = roots[roots["first"] < roots["last"]]
    low, high = (roots["middle"] - roots["half"]).min(axis=0), (roots["middle"] + roots["half"]).max(axis=0)
    return 0.5 * (low + high), 0.5 * float(np.linalg.norm(high - low))
