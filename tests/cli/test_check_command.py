"""``cagepose check``, and ``run --check-tolerance``."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Command = Callable[..., Any]
SCENES = Path(__file__).resolve().parents[2] / "scenes"


def test_check_tolerance_says_that_nothing_changes(command: Command, sample: str) -> None:
    out = command("run", sample, "--check-tolerance").out
    assert out.endswith("same verdict with a ten times larger and a ten times smaller touch tolerance\n")


def test_check_tolerance_warns_when_the_verdict_hangs_on_it(command: Command, sample: str) -> None:
    """C2 starts 0.05 um inside: touching within 1e-5 of the size (0.17 um), an impossible scene within 1e-6."""
    answer = command(
        "run", sample, "--check-tolerance", "--json",
        "--set", "tolerances.touch=1e-5", "--set", "object.pose.position=[2, 4, 4.99995]",
    )  # fmt: skip
    (warning,) = [text for text in json.loads(answer.out)["warnings"] if "touch tolerance of" in text]
    assert warning.startswith("with a touch tolerance of 1e-06 instead of 1e-05 the scene cannot be run (cage.points.C")
    assert answer.code == 0


def test_check_says_what_a_scene_holds(command: Command, sample: str) -> None:
    assert command("check", sample) == (
        0,
        "sample: 1 box, 4 cage points, 1 load (gravity), method quasistatic\n"
        "object 10 x 10 x 10 mm: x -5 to 5, y -5 to 5, z -5 to 5\n"
        "cage 8 x 8 x 0 mm: x -4 to 4, y -4 to 4, z 0 to 0\n"
        "size 17.3205 mm, touch tolerance 1.73e-08 mm; no problems found\n",
        "",
    )


@pytest.mark.parametrize(("depth", "told"), [(9, "9 mm deep"), (30, "through 30 mm"), (32, "through 30 mm")])
def test_check_says_whether_a_hole_runs_through(command: Command, depth: int, told: str) -> None:
    """The block of the peg's hole is 30 mm thick; a hole that is drawn deeper than that is one through it."""
    out = command("check", str(SCENES / "peg-in-hole.yaml"), "--set", f"cage.shapes[1].hole.depth={depth}").out
    assert f"\nholes: hole {told}\n" in out
    assert "\ncage 60 x 60 x 30 mm: " in out
