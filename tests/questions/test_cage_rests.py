"""Rests in a cage: starts that end where a closed form says, and what is told of them."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import binomtest

from cagepose.cli.app import main
from cagepose.errors import SceneError
from cagepose.files.scene_file import load_scene
from cagepose.model.box import Box
from cagepose.model.cage import Cage
from cagepose.model.load import Load
from cagepose.model.parts import Object
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.model.shapes import Capsule, Sphere
from cagepose.questions.cage_rests import CageRests, cage_rests
from cagepose.questions.resting import is_on_floor_alone
from cagepose.questions.unanswered import Unanswered
from cagepose.studies.likelihood import wilson

SCENES = Path(__file__).resolve().parents[2] / "scenes"
RADIUS, APART, BALL = 0.003, 0.015, 0.01


def ball_over_three_rods(x: float = 0.0015) -> Scene:
    """A ball between walls over three rods along y: it rolls into one of two troughs."""
    along_y = (math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0)
    rods = [
        Capsule(RADIUS, 0.2, Pose((place, 0.0, 0.0), along_y), f"rod {number}")
        for number, place in enumerate((-APART, 0.0, APART))
    ]
    walls = [
        Box((0.002, 0.2, 0.1), pose_object_box=Pose((side * 0.022, 0.0, 0.02)), name=f"wall {side}") for side in (-1, 1)
    ]
    ball = Object(shapes=[Sphere(BALL)], pose=Pose((x, 0.0, 0.02)))
    return Scene(ball, Cage(shapes=[*rods, *walls]), [Load("weight", gravity=(0, 0, -1))])


def rests_of(scene: Scene, phase: str | None = None, n_starts: int = 200) -> CageRests:
    found = cage_rests(scene, phase, n_starts=n_starts)
    assert isinstance(found, CageRests)
    return found


def test_a_ball_ends_in_the_trough_over_which_it_starts(cases: Callable[[int, int], int]) -> None:
    """Between two rods the ball's middle is sqrt((R + r)^2 - (a / 2)^2) over them."""
    found = rests_of(ball_over_three_rods(), n_starts=cases(60, 2000))
    assert len(found.rests) == 2
    height = math.sqrt((BALL + RADIUS) ** 2 - (APART / 2.0) ** 2)
    for rest in found.rests:
        assert rest.verdict == "rests"
        assert rest.stability == "marginal"
        assert "y" in rest.undetermined
        assert abs(rest.pose.position_m[0]) == pytest.approx(APART / 2.0, abs=1e-9)
        assert rest.pose.position_m[2] == pytest.approx(height, abs=1e-9)
    ends_x = np.array([rest.pose.position_m[0] for rest in found.rests])[list(found.ends_in)]
    assert (np.sign(found.start_position_m[:, 0]) == np.sign(ends_x)).all()
    assert [rest.n for rest in found.rests] == np.bincount(found.ends_in).tolist()


def test_shares_are_told_with_wilsons_interval() -> None:
    for n_in, n in ((0, 10), (3, 10), (200, 200), (41, 200)):
        exact = binomtest(n_in, n).proportion_ci(0.95, "wilson")
        assert wilson(n_in, n) == pytest.approx((exact.low, exact.high), abs=1e-12)


def test_a_part_that_lies_on_pins_has_one_rest_that_leaves_the_plane_open() -> None:
    (rest,) = rests_of(load_scene(SCENES / "gripper.yaml"), n_starts=30).rests
    assert (rest.n, rest.verdict, rest.stability) == (30, "rests", "marginal")
    assert rest.undetermined == ("x", "y", "yaw")
    assert all(name.startswith("below") for name in rest.touching)


def test_with_friction_a_row_is_a_set_of_contacts() -> None:
    found = rests_of(load_scene(SCENES / "phone-dock.yaml"), n_starts=40)
    assert found.has_friction
    at_rest = [frozenset(rest.touching) for rest in found.rests if rest.stability is not None]
    assert len(at_rest) == len(set(at_rest)) > 0
    assert sum(rest.n for rest in found.rests) == 40


def test_a_phase_is_named_and_one_that_drives_has_no_answer() -> None:
    scene = ball_over_three_rods()
    with pytest.raises(SceneError, match="phase"):
        cage_rests(scene, "push")
    driven = load_scene(SCENES / "jaws.yaml")
    names = [load.name for load in driven.loads if load.drive]
    assert isinstance(cage_rests(driven, names[0]), Unanswered)


def test_only_a_level_floor_is_taken_for_a_plane() -> None:
    part, loads = Object([Box((0.01, 0.01, 0.01))], pose=Pose((0, 0, 0.1))), [Load("weight", gravity=(0, 0, -1))]
    floor = Box((1.0, 1.0, 0.1))
    assert is_on_floor_alone(Scene(part, Cage(shapes=[floor]), loads))
    assert not is_on_floor_alone(Scene(part, Cage(shapes=[floor], pose=Pose(euler_zyx=(0, 0.1, 0))), loads))
    assert not is_on_floor_alone(Scene(part, Cage([(0.0, 0.0, 0.5)], shapes=[floor]), loads))
    assert not is_on_floor_alone(load_scene(SCENES / "gripper.yaml"))


def test_the_command_prints_a_row_for_each_rest_and_the_document_has_the_same(
    capsys: pytest.CaptureFixture[str],
) -> None:
    arguments = ["ask", "resting", str(SCENES / "gripper.yaml"), "--starts", "20"]
    assert main(arguments) == 0
    shown = capsys.readouterr().out
    assert "sampled: let go from 20 poses that are free" in shown
    assert "rests (marginal)" in shown
    assert main([*arguments, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert (len(document["ends_in"]), document["phase"]) == (20, "weight")
    assert [(rest["n"], rest["verdict"]) for rest in document["rests"]] == [(20, "rests")]
