"""Runs of scenes that differ in numbers, one after the other, of which only where they end is read: `SceneRows`."""

from __future__ import annotations

import time
from typing import cast

import numpy as np

from cagepose.kernels.native.slots import Slots
from cagepose.kernels.outcome.cases import Cases
from cagepose.kernels.outcome.endings import empty_endings
from cagepose.model.checks import FloatArray
from cagepose.model.scene import FARTHEST_START, Scene
from cagepose.runs.batch import DriveEnds, drive_ends
from cagepose.runs.cases import taken_apart
from cagepose.runs.methods import chosen_method
from cagepose.runs.solve import run_sizes


class SceneRows:
    """Runs of many scenes with the loads, points and shapes of one, by its method.

    Attributes
    ----------
    n_runs
        How many.
    endings
        Filled by `run`.
    solve_s
        How long each took, seconds, (n_runs,).
    """

    def __init__(self, scene: Scene, n_runs: int) -> None:
        self._scene, self.n_runs = scene, n_runs
        self.endings = empty_endings(n_runs, len(scene.loads), len(scene.cage.element_names))
        self.solve_s: FloatArray = np.zeros(n_runs)
        self._slots, self._frictions = Slots(self.endings), np.zeros(n_runs)
        self._work: tuple[tuple[object, ...], Slots] | None = None

    def run(self, row: int, scene: Scene) -> None:
        """Run a scene.

        Raises
        ------
        SceneError
            The method does not run it.
        """
        method = chosen_method(scene)
        friction = method.friction(scene)
        part, cases = taken_apart(scene, friction)
        sizes = run_sizes(scene, cast(Cases, cases.value))
        rules = method.rules(scene)
        if self._work is None or self._work[0] != sizes:
            self._work = sizes, Slots(method.workspace(scene, rules.step_limit))
        self._frictions[row] = friction
        began = time.perf_counter()
        method.run_cases(row, row + 1, part, cases, FARTHEST_START, Slots(rules), self._work[1], self._slots)
        self.solve_s[row] = time.perf_counter() - began

    def drives(self) -> DriveEnds:
        """Return what came of the drives of all runs, which are done."""
        return drive_ends(self._scene, self.endings, self._frictions)
