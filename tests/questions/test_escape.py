"""The work that gets a part out: closed forms of a well, ways that are free, and proofs that there is none."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from cagepose import Box, Cage, Force, Load, Object, Scene, load_scene, run
from cagepose.cli.app import main
from cagepose.model.pose import Pose
from cagepose.questions.escape import EscapeEnergy, escape_energy
from cagepose.questions.unanswered import Unanswered

SCENES = Path(__file__).resolve().parents[2] / "scenes"
MASS, G = 0.1, 9.81
HALF, RIM, CLEARANCE = 0.01, 0.006, 0.0005


def cube_in_a_well(push: Force | None = None) -> Scene:
    """A cube on four points, fenced in by points up to `RIM` above its middle, so that it must be raised by that and
    half its height, less what it may lean.
    """
    points = [(x, y, -HALF) for x in (-0.006, 0.006) for y in (-0.006, 0.006)]
    side = HALF + CLEARANCE
    for z in (-0.008, RIM):
        for along in (-0.006, 0.006):
            points += [(side, along, z), (-side, along, z), (along, side, z), (along, -side, z)]
    load = Load("weight", gravity=(0, 0, -G), force=push)
    return Scene(Object([Box((2.0 * HALF,) * 3)], mass_kg=MASS), Cage(points), [load])


def energy_of(scene: Scene, n_motions: int = 4000) -> EscapeEnergy:
    found = escape_energy(run(scene), n_motions=n_motions)
    assert isinstance(found, EscapeEnergy)
    return found


def test_a_cube_must_be_raised_over_the_rim_of_its_well() -> None:
    found = energy_of(cube_in_a_well())
    leaning = HALF * CLEARANCE / HALF * 2.0
    assert found.in_newtons
    assert found.at_least_j == 0.0
    assert MASS * G * (HALF + RIM - leaning) <= found.at_most_j <= 1.1 * MASS * G * (HALF + RIM)
    assert found.top is not None
    assert MASS * G * found.top.position_m[2] == pytest.approx(found.at_most_j, rel=1e-9)


def test_a_force_that_presses_it_down_adds_to_the_work() -> None:
    """Twice the weight in all: twice the work of the same way, the search being the same each time."""
    pressed = energy_of(cube_in_a_well(Force((0, 0, -1), (0, 0, 0), MASS * G)))
    assert pressed.at_most_j >= 2.0 * MASS * G * (HALF + RIM - 2.0 * CLEARANCE)


def test_the_way_is_free_of_contact_and_nowhere_higher_than_told() -> None:
    scene = cube_in_a_well()
    found = energy_of(scene)
    pose, highest = run(scene).pose, -math.inf
    start = pose.position_m[2]
    for step in found.path:
        for share in np.linspace(0.0, 1.0, 15):
            here = step.motion.pose_at(pose, float(share))
            scene.but_for(object=scene.object.starting_at(here))  # raises where a point is in the cube
            highest = max(highest, float(here.position_m[2]))
        pose = step.pose_world_object
        assert pose.position_m == pytest.approx(here.position_m, abs=1e-12)
    assert MASS * G * (highest - start) == pytest.approx(found.at_most_j, rel=1e-3)
    assert np.linalg.norm(pose.position_m) > 1.5 * scene.size_m


def test_what_is_proven_to_be_caged_takes_infinite_work() -> None:
    found = energy_of(load_scene(SCENES / "gripper.yaml"))
    assert (found.at_least_j, found.at_most_j, found.path) == (math.inf, math.inf, ())


def test_loads_without_a_potential_have_no_energy() -> None:
    scene = cube_in_a_well(Force((0, 0, -1), (0, 0, 0), MASS * G, follows=True))
    assert isinstance(escape_energy(run(scene)), Unanswered)


def test_nothing_at_rest_has_no_answer() -> None:
    falls = Scene(
        Object([Box((0.01,) * 3)], pose=Pose((0.1, 0, 0))), Cage([(0, 0, 0)]), [Load("weight", gravity=(0, 0, -1))]
    )
    assert isinstance(escape_energy(run(falls)), Unanswered)


def test_the_command_tells_that_a_caged_part_stays(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["ask", "escape", str(SCENES / "gripper.yaml")]
    assert main(arguments) == 0
    assert "no work gets it out: it is proven to be caged" in capsys.readouterr().out
    assert main([*arguments, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["at_least"] == "unbounded"
    assert main([*arguments, "--motions", "0"]) == 2


def test_the_command_prints_the_way(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["ask", "escape", str(SCENES / "v-groove.yaml"), "--phase", "weight", "--motions", "2000"]) == 0
    shown = capsys.readouterr().out
    assert "at most" in shown
    assert "way out" in shown
