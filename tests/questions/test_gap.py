"""The critical gap: squares among pins, whose closed forms lie between what is proven and what is found."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from cagepose import Box, Cage, Load, Object, Pose, Scene, SceneError, Sphere
from cagepose.cli.app import main
from cagepose.questions.gap import CriticalGap, critical_gap
from cagepose.questions.unanswered import Unanswered

SCENES = Path(__file__).resolve().parents[2] / "scenes"
SIDE, THICK = 0.02, 0.01


def square_among(pins: list[tuple[float, float, float]], yaw: float = 0.0) -> Scene:
    """A square plate that stays between points below and above it."""
    level = THICK / 2.0 + 0.0001
    lids = [(x, y, z) for x in (-0.006, 0.006) for y in (-0.006, 0.006) for z in (-level, level)]
    plate = Object([Box((SIDE, SIDE, THICK))], pose=Pose(euler_zyx=(yaw, 0, 0)))
    return Scene(plate, Cage([*pins, *lids]), [Load("weight", gravity=(0, 0, -1))])


def among_four(apart: float) -> Scene:
    return square_among([(x * apart / 2.0, y * apart / 2.0, 0.0) for x in (-1, 1) for y in (-1, 1)], math.pi / 4.0)


def among_eight(apart: float) -> Scene:
    """Two pins on each side, 12 mm from each other."""
    half, along = apart / 2.0, 0.006
    pins = [(side * half, y, 0.0) for side in (-1, 1) for y in (-along, along)]
    return square_among([*pins, *[(y, x, 0.0) for x, y, _ in pins]])


def gap_of(*arguments: object) -> CriticalGap:
    found = critical_gap(*arguments)  # type: ignore[arg-type]
    assert isinstance(found, CriticalGap)
    return found


def test_a_square_leaves_four_pins_that_are_as_far_apart_as_it_is_wide() -> None:
    """It passes between two pins whose distance is its side. What holds it to second order alone is not proven."""
    found = gap_of(among_four, 0.0145, 0.03)
    assert found.escapes_at is not None
    assert SIDE <= found.escapes_at <= 1.01 * SIDE
    assert found.caged_at is None


def test_a_square_leaves_eight_pins_at_their_corners() -> None:
    """Between pins at (a, b) and (b, a) the gap is sqrt 2 (a - b), which is the side at a = b + side / sqrt 2."""
    found = gap_of(among_eight, 0.0201, 0.06)
    truth = 2.0 * (0.006 + SIDE / math.sqrt(2.0))
    assert found.caged_at is not None
    assert found.escapes_at is not None
    assert 0.0205 < found.caged_at < truth <= found.escapes_at <= 1.03 * truth


def test_ends_of_the_range_are_checked() -> None:
    with pytest.raises(SceneError, match="two different"):
        critical_gap(among_four, 0.02, 0.02)
    with pytest.raises(SceneError, match="two different"):
        critical_gap(among_four, 0.02, math.nan)


def test_round_parts_have_no_answer() -> None:
    ball = Scene(Object(shapes=[Sphere(0.01)]), Cage([(0, 0, -0.011)]), [Load("weight", gravity=(0, 0, -1))])
    assert isinstance(critical_gap(lambda _: ball, 0.0, 1.0), Unanswered)


def test_the_command_closes_in_a_number_of_the_scene(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["ask", "gap", str(SCENES / "gripper.yaml"), "--vary", "object.boxes[0].size[1]", "--range", "20,4"]
    assert main([*arguments, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert 4.0 < document["caged_at"] < 20.0
    assert document["escapes_at"] is None or document["escapes_at"] < document["caged_at"]
    assert main(arguments) == 0
    assert f"at {document['caged_at']:.7g} (proven)" in capsys.readouterr().out


def test_the_command_refuses_a_range_that_is_none(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["ask", "gap", str(SCENES / "gripper.yaml"), "--vary", "object.boxes[0].size[1]", "--range"]
    assert main([*arguments, "20"]) == 2
    assert capsys.readouterr().err.startswith("--range 20: is not two numbers")
    assert main([*arguments, "20,-3"]) == 2
