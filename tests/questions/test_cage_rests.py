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
from cagepose.model.facets import Facets
from cagepose.model.load import Load
from cagepose.model.parts import Object
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.model.shapes import Capsule, Cylinder, Sphere
from cagepose.model.spring import Spring
from cagepose.questions.cage_rests import CageRests, cage_rests
from cagepose.questions.resting import is_on_floor_alone, resting_poses
from cagepose.questions.unanswered import Unanswered
from cagepose.runs.many import Runs, run_many
from cagepose.runs.run import Run
from cagepose.runs.solve import run
from cagepose.runs.variation import Variation
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


def in_a_tray(part: Object) -> Scene:
    """A part 25 mm above the floor of a tray with a lid, in which it may turn in any way."""
    sides = [Box((0.01, 0.12, 0.06), Pose((side * 0.035, 0.0, 0.03)), f"side {side}") for side in (-1, 1)] + [
        Box((0.12, 0.01, 0.06), Pose((0.0, side * 0.035, 0.03)), f"end {side}") for side in (-1, 1)
    ]
    level = [Box((0.12, 0.12, 0.01), Pose((0.0, 0.0, z)), name) for z, name in ((-0.005, "floor"), (0.065, "lid"))]
    return Scene(
        part.starting_at(Pose((0.0, 0.0, 0.03))), Cage(shapes=[*sides, *level]), [Load("weight", gravity=(0, 0, -1))]
    )


def test_a_part_that_may_turn_in_any_way_ends_in_all_its_rests_on_a_plane() -> None:
    """A U, which lies in six ways: starts are not only about the orientation in which it is drawn."""
    part = Object(
        [
            Box((0.02, 0.03, 0.004), Pose((0.0, 0.0, 0.002))),
            *(Box((0.004, 0.03, 0.016), Pose((side * 0.008, 0.0, 0.008))) for side in (-1, 1)),
        ]
    )
    found = rests_of(in_a_tray(part), n_starts=150)
    assert set(found.not_limited) == {"roll", "pitch", "yaw"}
    downs = np.array([-rest.pose.rotation[2] for rest in found.rests])
    on_plane = np.array([pose.down_object for pose in resting_poses(part).poses])
    assert len(downs) == len(on_plane) == 6
    assert (on_plane @ downs.T).max(axis=1) == pytest.approx(1.0, abs=1e-9)


def test_a_shaft_that_may_roll_is_one_row_wherever_it_stops() -> None:
    """On the floor of a tray it turns about itself and the vertical; it may touch walls, too."""
    shaft = Object(shapes=[Cylinder(0.006, 0.02), Cylinder(0.004, 0.016, Pose((0.0, 0.0, 0.018)))])
    found = rests_of(in_a_tray(shaft), n_starts=60)
    heights = [rest.pose.position_m[2] for rest in found.rests]
    assert heights[0] == pytest.approx(0.006, abs=1e-9)
    assert min(abs(height - 0.006) for height in heights[1:]) > 1e-3
    assert found.rests[0].n > 45


def test_a_start_that_is_followed_again_is_the_same_to_the_last_bit(monkeypatch: pytest.MonkeyPatch) -> None:
    """Else a run that hangs on it, as of a thin disc in a V-groove, ends otherwise, and its row takes in others."""
    asked, followed = set[tuple[float, ...]](), list[tuple[float, ...]]()

    def many(scene: Scene, variation: Variation) -> Runs:
        assert variation.object_euler_zyx is not None
        asked.update(tuple(Pose(euler_zyx=row).quaternion_wxyz.tolist()) for row in variation.object_euler_zyx)
        return run_many(scene, variation)

    def one(scene: Scene) -> Run:
        followed.append(tuple(scene.object.pose_world_object.quaternion_wxyz.tolist()))
        return run(scene)

    monkeypatch.setattr("cagepose.questions.cage_rests.run_many", many)
    monkeypatch.setattr("cagepose.questions.cage_rests.run", one)
    rests_of(in_a_tray(Object(shapes=[Cylinder(0.006, 0.02)])), n_starts=20)
    assert set(followed) <= asked
    assert len(followed) > 10


@pytest.mark.parametrize("aside", [0.0, 0.003])
def test_a_bar_that_turns_about_its_own_axis_is_one_row_wherever_its_origin_is(aside: float) -> None:
    """In a V-groove, between two ends, a bar without friction stops at any angle."""
    flanks = [
        Box((0.1, 0.06, 0.01), Pose((0.0, side * 0.0176776695, 0.0106066017), euler_zyx=(0.0, 0.0, side * math.pi / 4)))
        for side in (-1, 1)
    ]
    ends = [Box((0.01, 0.1, 0.06), Pose((side * 0.027, 0.0, 0.03))) for side in (-1, 1)]
    bar = Object(
        shapes=[Cylinder(0.01, 0.04, Pose((0.0, aside, 0.0), euler_zyx=(0.0, math.pi / 2, 0.0)))],
        pose=Pose((0.0, 0.0, 0.02)),
    )
    found = rests_of(Scene(bar, Cage(shapes=[*flanks, *ends]), [Load("weight", gravity=(0, 0, -1))]), n_starts=40)
    lying = [rest for rest in found.rests if rest.stability is not None and "roll" in rest.undetermined]
    assert len(lying) == 1


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


def tray_of_two_grooves() -> Facets:
    """One body, 60 mm by 100 mm, with two equal grooves along y, 15 mm to the left and to the right."""
    xs, tops, half = (-0.03, -0.015, 0.0, 0.015, 0.03), (0.01, -0.005, 0.01, -0.005, 0.01), 0.05
    vertices = [(x, y, z) for x, top in zip(xs, tops, strict=True) for y in (-half, half) for z in (-0.02, top)]

    def corner(column: int, back: int, upper: int) -> int:
        return 4 * column + 2 * back + upper

    sides = []
    for i in range(4):
        for face in (
            [(i, 0, 1), (i + 1, 0, 1), (i + 1, 1, 1), (i, 1, 1)],
            [(i, 0, 0), (i, 1, 0), (i + 1, 1, 0), (i + 1, 0, 0)],
            [(i, 0, 0), (i + 1, 0, 0), (i + 1, 0, 1), (i, 0, 1)],
            [(i, 1, 0), (i, 1, 1), (i + 1, 1, 1), (i + 1, 1, 0)],
        ):
            sides.append([corner(*at) for at in face])
    sides.append([corner(0, *at) for at in ((0, 0), (0, 1), (1, 1), (1, 0))])
    sides.append([corner(4, *at) for at in ((0, 0), (1, 0), (1, 1), (0, 1))])
    triangles = [(a, b, c) for a, b, c, _ in sides] + [(a, c, d) for a, _, c, d in sides]
    return Facets(vertices, triangles, name="tray")


def test_a_ball_in_either_of_two_equal_grooves_of_one_body_is_two_rows() -> None:
    """They bear it alike and are as high, but its middle is elsewhere."""
    ends = [Box((0.004, 0.1, 0.08), Pose((side * 0.032, 0, 0.02)), f"end {side}") for side in (-1, 1)]
    walls = [Box((0.06, 0.01, 0.08), Pose((0, side * 0.02, 0.05)), f"wall {side}") for side in (-1, 1)]
    ball = Object(shapes=[Sphere(0.008)], pose=Pose((0.001, 0, 0.03)))
    scene = Scene(ball, Cage(shapes=[tray_of_two_grooves(), *ends, *walls]), [Load("weight", gravity=(0, 0, -1))])
    found = cage_rests(scene, n_starts=30)
    assert isinstance(found, CageRests)
    assert sorted(round(1e3 * float(rest.pose.position_m[0])) for rest in found.rests) == [-15, 15]
    assert sum(rest.n for rest in found.rests) == 30


def test_a_part_that_hangs_by_a_spring_rests_without_a_contact() -> None:
    block = Object([Box((0.01, 0.01, 0.01))], mass_kg=0.1, pose=Pose((0, 0, 0.02)))
    plates = [Box((0.1, 0.1, 0.01), Pose((0, 0, z)), name) for z, name in ((-0.03, "floor"), (0.09, "lid"))]
    hung = Load("hung", gravity=(0, 0, -9.81), springs=[Spring((0, 0, 0.005), (0, 0, 0.06), 100.0)])
    found = cage_rests(Scene(block, Cage(shapes=plates), [hung]), n_starts=10)
    assert isinstance(found, CageRests)
    assert all(rest.touching == () for rest in found.rests)
