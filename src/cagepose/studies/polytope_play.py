"""Play of boxes among points: ends by linear programs and Newton steps over their gaps."""

from __future__ import annotations

from functools import partial
from time import perf_counter

import numpy as np

from cagepose.kernels.algebra.record import Rows, empty_rows
from cagepose.kernels.native.slots import Slots
from cagepose.kernels.play.extreme import OPEN, REACHED, UNFINISHED, Extreme
from cagepose.kernels.play.goal import SHIFT, Goal
from cagepose.kernels.play.polytope import empty_play_workspace
from cagepose.kernels.play.search import find_play, find_play_from
from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.studies.play_frame import FREEDOMS, PlayFrame
from cagepose.studies.play_limits import Clearance, limiting_clearances
from cagepose.studies.play_result import EndStatus, PlayEnd

MOST_STARTS = 2000
"""Poses of the search for a way out that ends are looked for from: a millisecond, and as many on any machine."""
MOST_ROUNDS = 5
"""So many rounds of searches start from the ends of others. One round that finds nothing is usual."""
STATUS: dict[int, EndStatus] = {REACHED: "local", OPEN: "open", UNFINISHED: "not converged"}


class PolytopePlay:
    """What the kernels find for a scene's goals, two for each range: least, greatest."""

    def __init__(self, scene: Scene, frame: PlayFrame, goals: Rows[Goal]) -> None:
        self.scene = scene
        self.frame = frame
        self.goals = goals
        self.extremes = empty_rows(Extreme, len(goals))
        work = empty_play_workspace(frame.geometry, frame.held)
        geometry, workspace = self._given = Slots(frame.geometry), Slots(work)
        started = perf_counter()
        find_play(geometry, goals, self.extremes, workspace)
        self.analysis_s = perf_counter() - started

    def search_from(self, stations: np.ndarray) -> None:
        """Search for ends again, from the farthest of all other ends and of these poses.

        Where a freedom has no end the object leaves its cage, and out there nothing has one: no search starts there.
        """
        geometry, workspace = self._given
        ends = np.asarray(self.extremes)
        started = perf_counter()
        for _ in range(MOST_ROUNDS):
            nearby = ends[: 2 * len(FREEDOMS)]  # not those of points: answers hang on no other question
            starts, before = [nearby[nearby["outcome"] != OPEN], stations], ends["value"].copy()
            positions, quaternions = (np.concatenate([rows[k] for rows in starts]) for k in ("position", "quaternion"))
            find_play_from(geometry, self.goals, self.extremes, positions, quaternions, workspace)
            if (ends["value"] == before).all():
                break
        self.analysis_s += perf_counter() - started

    def ranges(self) -> list[tuple[PlayEnd, PlayEnd]]:
        goals, found = np.asarray(self.goals), np.asarray(self.extremes)
        units = np.where(goals["kind"] == SHIFT, self.frame.length_m, 1.0)
        linear = _known(units * found["linear"], found["linear_outcome"] == REACHED)
        reached = _known(units * found["value"], found["outcome"] != OPEN)
        status = [STATUS[outcome] for outcome in found["outcome"].tolist()]
        ends = [
            PlayEnd(first, far, None, status[index], partial(self._pose, index), partial(self._clearances, index))
            for index, (first, far) in enumerate(zip(linear, reached, strict=True))
        ]
        return list(zip(ends[::2], ends[1::2], strict=True))

    def _pose(self, index: int) -> Pose | None:
        extreme = self.extremes[index]
        return None if extreme.outcome == OPEN else self.frame.pose_after(extreme.position, extreme.quaternion)

    def _clearances(self, index: int) -> tuple[Clearance, ...]:
        goal, extreme = self.goals[index], self.extremes[index]
        return limiting_clearances(self.scene, self.frame, goal, extreme) if extreme.outcome == REACHED else ()

    def free_directions(self) -> tuple[str, ...]:
        """``x``: free both ways; ``+x``: free one way; as linearised."""
        names = []
        for place, name in enumerate(FREEDOMS):
            low, high = (self.extremes[2 * place + side].linear_outcome == OPEN for side in range(2))
            if low or high:
                names.append(name if low and high else f"{'-' if low else '+'}{name}")
        return tuple(names)


def _known(values: FloatArray, is_known: np.ndarray) -> list[float | None]:
    return [value if known else None for value, known in zip(values.tolist(), is_known.tolist(), strict=True)]
