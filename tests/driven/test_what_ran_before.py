"""A run must not depend on what ran before it in the same memory."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from cagepose import run
from cagepose.files.scene_file import read_scene_file
from driven.insertions import Insertion
from our_scenes import SCENES


def test_a_peg_that_touches_twice_after_one_that_touches_once() -> None:
    once, twice = Insertion(5.05, 0.4, 0.0, 0.0), Insertion(5.01, 0.3, math.radians(0.5), 0.0)
    run(once.scene(3.0, [10.0]))
    assert run(twice.scene(3.0, [10.0])).verdict == "rests"


def test_a_drawer_that_jams_at_once_after_one_that_goes_in() -> None:
    path: Path = next(path for path in SCENES if path.stem == "drawer-jams")
    (alone,) = run(read_scene_file(path).scene).phases
    run(read_scene_file(path, ("friction.coefficient=0.5",)).scene)
    (phase,) = run(read_scene_file(path).scene).phases
    assert phase.drive is not None
    assert alone.drive is not None
    assert phase.drive.share == 0.0
    assert phase.drive.along == alone.drive.along == pytest.approx(1.0, abs=1e-9)  # what pushes the drawer back
