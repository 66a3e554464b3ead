"""How far a drive may be set up out of place, so that the object still goes in: `permitted_misalignment`."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.misaligned import Misaligned, Reached
from cagepose.runs.run import FAILURES

LENGTHS, ANGLES = ("x", "y", "z"), ("roll", "pitch", "yaw")
FREEDOMS = (*LENGTHS, *ANGLES)
"""Shifts along, and turns about, the axes of the cage's frame, in this order."""
LENGTH_LIMIT_OF_SIZE, ANGLE_LIMIT = 0.1, math.radians(10.0)
"""How far is searched: in sizes of the scene, and radians."""
PLACES = 8
"""On each side at first: at the limit, at half of it, and so on."""
WITHIN_OF_LIMIT = 1e-6
"""So near to nothing, as a fraction of the limit, an end is as good as there."""
AS_FAR = 0.9
"""Of the way that the object and what it meets come together where nothing is out of place: less is too short."""
SHORT = "falls short"
"""What ends a side where the drive is at its end, but the object has not gone in."""


@dataclass(frozen=True)
class MisalignmentEnd:
    """How far a drive may be out of place to one side of a freedom, metres or radians.

    Attributes
    ----------
    permitted
        The farthest place of the search up to which all were good; below zero on the low side. None: even where the
        scene has it, the object does not go in.
    fails_at
        The nearest place where it was not, beyond that one. None: there is none up to the limit of the search, so the
        end is "at least" `permitted`.
    verdict
        How it ends there: "blocked", "jams", "stops", "escapes", a failure such as "stalled", "overlaps" (it cannot
        start: the object would be inside the cage) or "falls short" (the drive gets to its end, but the object stays
        behind by more than a tenth of the way). None with `fails_at`.
    """

    permitted: float | None
    fails_at: float | None
    verdict: str | None

    def __repr__(self) -> str:
        if self.permitted is None:
            return f"<MisalignmentEnd: none, {self.verdict}>"
        least = "at least " if self.fails_at is None else ""
        return f"<MisalignmentEnd: {least}{self.permitted:.6g}, {self.verdict or 'not found'}>"

    @property
    def is_failure(self) -> bool:
        """Whether the run that ends it failed, so that nothing is known of the mechanism there."""
        return self.verdict in FAILURES


@dataclass(frozen=True)
class Misalignment:
    """How far a drive may be out of place along one freedom, to both sides."""

    low: MisalignmentEnd
    high: MisalignmentEnd


def permitted_misalignment(
    scene: Scene, phase: int, along: Sequence[str], within: float, progress: Callable[[float], None] | None = None
) -> dict[str, Misalignment]:
    """Return for each freedom how far what a phase drives may be out of place, so that the object still goes in.

    Out of place are all bodies that the phase drives, with their whole ways, as if the machine that moves them stood
    elsewhere; the object with them where it hangs on them by springs alone. Shifts are along the axes of the cage's
    frame, turns about axes through the object's origin at the start. It goes in where the drive gets to its end, the
    object rests there, and both have come together nine tenths as far as where nothing is out of place.

    A side is searched outwards at 8 places, each twice as far as the one before. The first one that is not good ends
    it: between it and the last good one the end is found by halving. Should it be good again farther out, or bad
    between two places that are good, that is not seen.

    Parameters
    ----------
    scene, phase
        The phase's number, from 0; it drives something.
    along
        Names of `FREEDOMS`.
    within
        To which fraction of itself each end is found.
    progress
        Called with a share of the work that is done.
    """
    misaligned = Misaligned(scene, phase)
    (nominal,) = misaligned.run([Pose()])
    if not nominal.is_end:
        end = MisalignmentEnd(None, 0.0, nominal.verdict)
        return dict.fromkeys(along, Misalignment(end, end))
    through = turned_through(scene)
    sides = [_Side(name, sign, scene.size_m, through, within) for name in along for sign in (-1.0, 1.0)]
    while waiting := [side for side in sides if not side.is_done]:
        if progress is not None:
            progress(sum(side.part_done for side in sides) / len(sides))
        found = misaligned.run([side.next_pose() for side in waiting])
        for side, reached in zip(waiting, found, strict=True):
            side.note(_fault(reached, nominal))
    ends = [side.end() for side in sides]
    return {name: Misalignment(*ends[2 * place : 2 * place + 2]) for place, name in enumerate(along)}


def turned_through(scene: Scene) -> FloatArray:
    """Return the point that turns go through: the object's origin at the start, in the cage's frame, (3,), metres."""
    return scene.cage.pose_world_cage.inverse_transform(scene.object.pose_world_object.position_m)


def out_of_place(name: str, amount: float, through_cage_m: FloatArray) -> Pose:
    """Return how a drive is moved, in the cage's frame, that is out of place along a freedom, by metres or radians."""
    axis = np.eye(3)[FREEDOMS.index(name) % len(LENGTHS)]
    if name in LENGTHS:
        return Pose(amount * axis)
    half = 0.5 * amount
    turn = Pose((0, 0, 0), (math.cos(half), *(math.sin(half) * axis)))
    return Pose(through_cage_m - turn.transform(through_cage_m), turn.quaternion_wxyz)


class _Side:
    """The search along one freedom to one side; metres or radians, all above zero."""

    def __init__(self, name: str, sign: float, size_m: float, through_cage_m: FloatArray, within: float) -> None:
        self._name, self._sign, self._through = name, sign, through_cage_m
        self._within = within
        self._limit = LENGTH_LIMIT_OF_SIZE * size_m if name in LENGTHS else ANGLE_LIMIT
        self._good, self._bad, self._fault, self._n_tried = 0.0, math.inf, "", 0

    @property
    def is_done(self) -> bool:
        if math.isinf(self._bad):
            return self._good == self._limit
        return self._bad - self._good <= max(self._within * self._good, WITHIN_OF_LIMIT * self._limit)

    @property
    def part_done(self) -> float:
        """How much of the search is done, as far as that can be known."""
        return 1.0 if self.is_done else min(self._n_tried / (2 * PLACES), 1.0)

    @property
    def _next(self) -> float:
        if math.isinf(self._bad):
            return self._limit * 0.5 ** (PLACES - 1 - self._n_tried)
        return 0.5 * (self._good + self._bad)

    def next_pose(self) -> Pose:
        """Return how the drive is moved, in the cage's frame, at the place that is to be tried next."""
        return out_of_place(self._name, self._sign * self._next, self._through)

    def note(self, fault: str | None) -> None:
        """Take the answer at that place: what is wrong there, or None."""
        if fault is None:
            self._good = self._next
        else:
            self._bad, self._fault = self._next, fault
        self._n_tried += 1

    def end(self) -> MisalignmentEnd:
        good = self._sign * self._good + 0.0  # -0.0 becomes 0.0
        if math.isinf(self._bad):
            return MisalignmentEnd(good, None, None)
        return MisalignmentEnd(good, self._sign * self._bad, self._fault)


def _fault(reached: Reached, nominal: Reached) -> str | None:
    """Return why a place is not good; None: it is."""
    if not reached.is_end:
        return reached.verdict
    is_short = reached.advance_m < nominal.advance_m - (1.0 - AS_FAR) * abs(nominal.advance_m)
    return SHORT if is_short else None
