"""What is asked of whole runs of shapes: how deep they went, whether the potential rose, if rests are balanced."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from audit import balance
from audit.geometry import acting, load_size
from cagepose import Pose, Run, Scene
from quasistatic.paths import RESTS, VERDICTS, path_of, potential

DEEP = 4.0
"""Touch tolerances."""
POSES = 40
"""About so many poses of a path are asked how deep parts are."""
UNDECIDED = 0.05
"""At most this share of runs may end without an answer, by name."""


def imbalance(scene: Scene, result: Run) -> float:
    """What is left of the forces and moments at the end, of the load, but for the rounding of their sum: in a jam,
    contacts press on each other with any multiple of it.
    """
    phase, total = result.phases[-1], load_size(acting(scene, scene.loads[-1]))
    rounding = np.finfo(float).eps * len(phase.contacts) * sum(contact.force_normal_n for contact in phase.contacts)
    return max(balance.imbalance(scene, phase) - float(rounding / total), 0.0)


class Asked:
    """What was seen of many runs; on the way they may go ``deep_on_the_way`` touch tolerances deep."""

    def __init__(self, deep_on_the_way: float = DEEP) -> None:
        self.deep_on_the_way = deep_on_the_way
        self.verdicts = dict.fromkeys(sorted(VERDICTS), 0)
        self.wrong: list[str] = []
        self.deepest = self.highest = self.least_balanced = 0.0

    def ask(self, number: int, scene: Scene, result: Run, depth_at: Callable[[Pose], float]) -> None:
        """Ask one run for how deep it went, whether its potential rose, and whether a rest is balanced."""
        phase = result.phases[-1]
        self.verdicts[phase.verdict] += 1
        path = path_of(phase)
        every = max(1, len(path) // POSES)
        depth, last = (max(map(depth_at, poses)) / scene.touch_m for poses in (path[::every], path[-1:]))
        heights = [potential(scene, scene.loads[0], pose) for pose in path]
        rise = float(np.max(np.diff(heights), initial=0.0))
        left = imbalance(scene, result) if phase.verdict in RESTS else 0.0
        if last >= DEEP or depth >= self.deep_on_the_way or rise >= 1e-12 or left >= 1e-8:
            self.wrong.append(
                f"run {number} {phase.verdict}: {depth:g} touch tolerances deep, {last:g} at last, {rise:g} up,"
                f" {left:g} of the load not balanced"
            )
        self.deepest, self.highest = max(self.deepest, depth), max(self.highest, rise)
        self.least_balanced = max(self.least_balanced, left)

    def __str__(self) -> str:
        return (
            f"{self.verdicts}; at most {self.deepest:.1e} touch tolerances deep, {self.highest:.1e} up,"
            f" {self.least_balanced:.1e} of the load not balanced"
        )

    def check(self) -> None:
        n_runs = sum(self.verdicts.values())
        assert not self.wrong, "\n".join(self.wrong)
        assert self.verdicts["stalled"] + self.verdicts["limit"] <= UNDECIDED * n_runs, self.verdicts
