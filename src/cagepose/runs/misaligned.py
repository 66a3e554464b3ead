"""Runs of one scene whose drives are set up out of place: `Misaligned`. No scene is built anew for them."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.native.slots import Slots
from cagepose.kernels.outcome.cases import Cases
from cagepose.kernels.outcome.endings import INVALID, NOT_RUN, Endings, empty_endings
from cagepose.kernels.outcome.trace import RESTS, VERDICT_NAMES
from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.model.scene import FARTHEST_START, Scene
from cagepose.runs.cases import cases_of, part_of
from cagepose.runs.drives import at_start, drives_of
from cagepose.runs.methods import chosen_method

OVERLAPS = "overlaps"
"""What is told in the place of a verdict where the object cannot start: it would be inside the cage."""


class Reached(NamedTuple):
    """How a phase ended.

    Attributes
    ----------
    verdict
        That of the phase, or of one before it that did not come to rest; `OVERLAPS` where none could begin.
    is_end
        Whether the drive got to its end, and the object rests there.
    advance_m
        How far the object and what it meets have come together along the way of the drive, metres: the way of the
        bodies less that of the object, or the way of the object where that hangs on them. NaN: no such way, since the
        bodies turn alone or go against each other.
    """

    verdict: str
    is_end: bool
    advance_m: float


class Misaligned:
    """A scene in which what a phase drives can be set up elsewhere: its bodies with their whole ways, and the object,
    too, where it hangs on them by springs alone.

    Parameters
    ----------
    scene
        As it is.
    phase
        Number of the phase, from 0, whose drive is meant. The bodies that it drives are out of place from the start,
        and their ways in all phases.

    Attributes
    ----------
    bodies
        Names of the bodies that are set up elsewhere.
    takes_object
        Whether the object goes along with them: no body that the phase drives has points or shapes.
    """

    def __init__(self, scene: Scene, phase: int) -> None:
        self._scene, self._phase, self._method = scene, phase, chosen_method(scene)
        drives = scene.loads[phase].drive
        self.bodies = tuple(drives)
        self.takes_object = all(body.own.is_empty for body in scene.cage.bodies if body.name in drives)
        ways = [
            sum((leg.travel_m for leg in legs if leg.travel_m is not None), np.zeros(3)) for legs in drives.values()
        ]
        self._way_cage: FloatArray = np.mean(ways, axis=0)
        self._rules = self._method.rules(scene)
        self._part, self._cases = Slots(part_of(scene)), cases_of(scene, self._method.friction(scene))
        self._idle = list[Slots]()

    def run(self, moved: Sequence[Pose]) -> list[Reached]:
        """Return how the phase ends for each way in which its drive is moved, in the cage's frame; on all cores."""
        stopped = np.zeros(1, np.int64)
        executor = ThreadPoolExecutor(os.cpu_count() or 1)
        try:
            waiting = [executor.submit(self._run_one, pose, stopped) for pose in moved]
            return [one.result() for one in waiting]
        except BaseException:  # Ctrl-C is heard here, not in the threads
            stopped[0] = 1
            raise
        finally:
            executor.shutdown(cancel_futures=True)

    def _run_one(self, moved: Pose, stopped: NDArray[np.int64]) -> Reached:
        scene, phase = self._scene, self._phase
        endings = empty_endings(1, len(scene.loads), len(scene.cage.element_names))
        try:
            work = self._idle.pop()
        except IndexError:
            work = Slots(self._method.workspace(scene, self._rules.step_limit))
        cases = self._moved_cases(moved)
        arguments = [self._part, Slots(cases), FARTHEST_START, Slots(self._rules), work, Slots(endings)]
        self._method.run_cases.until(stopped, 0, 1, *arguments)
        self._idle.append(work)
        codes = endings.verdicts[0, : phase + 1]
        last = int(np.flatnonzero(codes != NOT_RUN)[-1])
        if codes[last] == INVALID:
            return Reached(OVERLAPS, False, math.nan)
        is_end = last == phase and bool(codes[last] == RESTS)  # where a drive ends at rest it is at its end
        return Reached(VERDICT_NAMES[codes[last]], is_end, self._advance(moved, cases, endings) if is_end else math.nan)

    def _advance(self, moved: Pose, cases: Cases, endings: Endings) -> float:
        """Return how far the object and what it meets come together in the phase, whose drive is at its end."""
        whole = float(np.linalg.norm(self._way_cage))
        if whole == 0.0:
            return math.nan
        phase, center = self._phase, self._scene.object.center_of_gravity_m
        before = (cases.object_positions[0], cases.object_quaternions[0])
        if phase > 0:
            before = (endings.positions[0, phase - 1], endings.quaternions[0, phase - 1])
        start, end = Pose(*before), Pose(endings.positions[0, phase], endings.quaternions[0, phase])
        along = self._scene.cage.pose_world_cage.rotation @ moved.rotation @ self._way_cage / whole
        went = float(along @ (end.transform(center) - start.transform(center)))
        return went if self.takes_object else whole - went

    def _moved_cases(self, moved: Pose) -> Cases:
        """Return the case in which all that the phase drives is moved. Springs keep their length without a load."""
        scene = self._scene
        displaced = at_start(scene)
        for row, body in enumerate(scene.cage.bodies, start=1):
            if body.name in self.bodies:
                displaced[row] = *moved.position_m, *moved.quaternion_wxyz
        held, cage = scene.object.pose_world_object, scene.cage.pose_world_cage
        if self.takes_object:
            held = cage @ moved @ cage.inverse() @ held
        return self._cases._replace(
            displaced=displaced,
            drives=drives_of(scene, dict.fromkeys(self.bodies, moved)),
            object_positions=held.position_m[None],
            object_quaternions=held.quaternion_wxyz[None],
        )
