"""MuJoCo beside cagepose: where there is one rest they agree, small errors are seen, and partings have reasons."""

from __future__ import annotations

import json
import sys
from dataclasses import replace

import numpy as np
import pytest

from cagepose import (
    Box,
    Cage,
    CageBody,
    CageposeError,
    Drive,
    Force,
    Load,
    Moment,
    Object,
    Pose,
    Scene,
    SceneError,
    Spring,
    load_scene,
    run,
)
from cagepose.cli.app import main
from cagepose.exchange import crosscheck as module
from cagepose.exchange.crosscheck import crosscheck
from cagepose.exchange.solids import assembly_of
from our_scenes import SCENES

pytest.importorskip("mujoco")

FILES = {path.stem: path for path in SCENES}


@pytest.mark.parametrize(
    "name",
    ["chuck", "connector", "gripper", "ladder", "rail-pitch", "rail-yaw", "rollers", "v-groove", "plate-on-pins"],
)
def test_mujoco_ends_where_cagepose_ends(name):
    found = crosscheck(run(load_scene(FILES[name])))
    assert found.agrees, [phase.reasons for phase in found.phases]
    for phase in found.phases:
        assert 0.0 < phase.mujoco.penetration_m < 1e-5 * found.run.scene.size_m
        assert phase.distance_m <= phase.allowed_m < 5e-4 * found.run.scene.size_m


def test_mujoco_ends_there_under_a_force_that_stays_in_the_world():
    """A plate slides 2 mm on below it, so that its feet carry other shares than under one that rides."""
    feet = [(-0.03, -0.02, 0), (-0.03, 0.02, 0), (0.03, 0, 0)]
    walls = [(-0.025, -0.031, 0.008), (0.025, -0.031, 0.008), (0.025, 0.031, 0.008), (0.042, 0, 0.008)]
    plate = Object([Box((0.08, 0.06, 0.01))], mass_kg=0.3, pose=Pose((0, 0, 0.005)))
    jet = Force((0, 0, -1), magnitude_n=2.0, at_world_m=(-0.01, 0.005, 0.013))
    push = Load("push", gravity=(0, 0, -9.81), forces=[jet, Force((1, 0, 0), (-0.04, 0, 0), 3.0)])
    found = crosscheck(run(Scene(plate, Cage([*feet, *walls]), [push])))
    assert found.agrees, found.phases[0].reasons
    assert found.phases[0].mujoco.pose.position_m[0] == pytest.approx(0.002, abs=1e-5)


def test_a_roller_a_tenth_of_a_millimetre_off_is_seen(monkeypatch):
    """The rail is 1200 mm long. A wrong answer of cagepose would be seen as this is."""
    scene = load_scene(FILES["rail-pitch"])
    assert crosscheck(run(scene)).agrees
    off = assembly_of(scene.changed({f"cage.points[{index}][2]": 0.9e-3 for index in (1, 3)}))
    monkeypatch.setattr(module, "assembly_of", lambda _: off)
    found = crosscheck(run(scene))
    assert not found.phases[0].agrees
    assert found.phases[0].distance_m > 1e-4


def test_all_kinds_of_loads_act_in_mujoco():
    """A block slides on three points and is held by two springs: where it rests is what all of them come to."""
    block = Object([Box((0.04, 0.02, 0.01))], mass_kg=0.5, pose=Pose((0, 0, 0.005)))
    load = Load(
        "held by springs",
        gravity=(0, 0, -9.81),
        forces=[Force((0, 1, 0), (0.01, 0, 0), 0.1, follows=True)],
        moments=[Moment((0, 0, 1), 0.004)],
        springs=[Spring((sign * 0.02, 0, 0), (sign * 0.06, 0, 0.005), 50.0, 1.0) for sign in (1, -1)],
    )
    scene = Scene(block, Cage([(0.012, 0.006, 0), (-0.012, 0.006, 0), (0, -0.006, 0)]), [load])
    found = crosscheck(run(scene))
    assert found.agrees, found.phases[0].reasons
    assert found.phases[0].allowed_m < 1e-5 * scene.size_m
    assert np.degrees(found.run.pose.euler_zyx[0]) == pytest.approx(4.756, abs=1e-3)
    assert found.run.pose.position_m[1] == pytest.approx(1.9805e-3, abs=1e-6)


def test_a_scene_that_drives_a_body_is_refused():
    held, jaw = Object([Box((2, 2, 2))]), CageBody("jaw", [(5, 0, 0)])
    driven = Scene(held, Cage([(0, 0, -1)], bodies=[jaw]), [Load("close", drive={"jaw": Drive((-1, 0, 0))})])
    still = run(Scene(held, Cage([(0, 0, -1)]), [Load("weight", gravity=(0, 0, -1))]))
    with pytest.raises(SceneError, match=r"^loads\[0\].drive: 'close' drives a body, and MuJoCo is asked where all"):
        crosscheck(replace(still, scene=driven))


def test_a_fall_without_end_agrees_with_a_fall():
    found = crosscheck(run(Scene(Object([Box((1, 1, 1))]), Cage([(0, 0, 2)]), [Load("weight", gravity=(0, 0, -1))])))
    assert found.run.verdict == "escapes"
    assert found.agrees


def test_the_reasons_say_what_the_proof_and_the_other_program_say():
    wedge = crosscheck(run(load_scene(FILES["wedge"]))).phases[0]
    assert "cagepose proves only that it may rest: a motion can begin there as well" in wedge.reasons
    assert wedge.leaves_theirs_m is None  # MuJoCo has no rest at which to start
    rod = crosscheck(run(load_scene(FILES["slender-rod"]))).phases[0]
    assert rod.leaves_theirs_m <= rod.allowed_m < rod.distance_m
    assert "cagepose, started at MuJoCo's pose, stays there" in rod.reasons or rod.reasons[0].startswith("both poses")
    paper = crosscheck(run(load_scene(FILES["sample"]))).phases[0]
    assert any(
        reason.startswith("the paper's rules end here, but by the mechanics it moves") for reason in paper.reasons
    )


def test_a_holes_own_friction_that_mujoco_has_not_is_named_as_a_reason_where_the_hole_is_touched():
    """The peg, turned back, is wedged by 0.8 and not by 0.1, the friction of the block."""
    own = "hole has a friction of its own, 0.8, and that of block in MuJoCo"
    found = crosscheck(run(load_scene(FILES["peg-in-hole"], ["friction.of.hole=0.8"])))
    assert [phase.agrees for phase in found.phases] == [True, True, False]
    assert own in found.phases[2].reasons
    assert "friction holds it: a whole range of poses is at rest" in found.phases[2].reasons
    reasons = crosscheck(run(load_scene(FILES["peg-in-hole"]))).phases[2].reasons
    assert not [reason for reason in reasons if "of its own" in reason]


def test_after_a_parting_the_next_phase_starts_at_our_pose():
    found = crosscheck(run(load_scene(FILES["drawer"])))
    assert [phase.agrees for phase in found.phases] == [False, True]


def test_the_command_says_it_with_its_exit_code(capsys):
    assert main(["crosscheck", str(FILES["rollers"])]) == 0
    assert capsys.readouterr().out.startswith("bar between rollers: agrees  (quasistatic beside mujoco)\n")
    assert main(["crosscheck", str(FILES["wedge"]), "--json"]) == 1
    document = json.loads(capsys.readouterr().out)
    assert document["agrees"] is False
    (phase,) = document["phases"]
    assert phase["distance"] > phase["allowed"]
    assert phase["cagepose_leaves_theirs_by"] is None
    assert np.isfinite(phase["mujoco"]["pose"]["position"]).all()


def test_without_mujoco_the_command_says_what_to_install(monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "mujoco", None)
    assert main(["crosscheck", str(FILES["rollers"])]) == 2
    assert "pip install 'cagepose[files]'" in capsys.readouterr().err


def test_mujoco_without_room_for_its_contacts_is_an_error(monkeypatch):
    monkeypatch.setattr("cagepose.exchange.mujoco_run.MEMORY_BYTES", 26_000)
    with pytest.raises(CageposeError, match="MuJoCo has no room for all contacts of this scene"):
        crosscheck(run(load_scene(FILES["drawer"])))
