"""Quasistatic runs of random scenes, each made once in a process, for all tests that ask something of them."""

from __future__ import annotations

import itertools
import math
from functools import cache

from audit.families import drawn_scenes
from cagepose import Run, Scene, run
from quasistatic.paths import again

SEED = 20261121
_drawn = drawn_scenes("union", math.inf, SEED)
_scenes = list[Scene]()


@cache
def random_run(number: int, friction: float | None) -> Run:
    """The run of a scene with a coefficient of friction, in one of the two metrics."""
    _scenes.extend(itertools.islice(_drawn, max(0, number + 1 - len(_scenes))))
    return run(again(_scenes[number], friction=friction, metric=("release", "drag")[number % 2]), "quasistatic")
