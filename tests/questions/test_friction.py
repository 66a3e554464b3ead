"""How much friction a rest needs: for a balance, and so that no motion can begin."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from cagepose import (
    Box,
    Cage,
    FrictionLimits,
    Load,
    Object,
    Pose,
    Run,
    Scene,
    SceneError,
    Unanswered,
    friction_limits,
    load_scene,
    run,
)
from cagepose.cli.app import main
from cagepose.runs.judge import judge_pose
from questions.cones_of_sides import is_balanced
from questions.planar_modes import Block, can_begin_to_move, drawn_block, obeys_coulomb

SCENES = Path(__file__).resolve().parents[2] / "scenes"


def limits_of(a_run: Run, phase: str | None = None) -> FrictionLimits:
    found = friction_limits(a_run, phase)
    assert isinstance(found, FrictionLimits)
    return found


@pytest.mark.parametrize("needed", [0.02, 0.12, 0.3])
def test_a_bar_that_is_pulled_along_a_v_groove_needs_what_textbooks_say_so_that_it_must_stay(needed: float) -> None:
    """F / (N + N), where N + N is sqrt 2 times what presses the bar down. Wedged, it can stay with less: 0.06174578
    against 0.0618638 in the scene as it is.
    """
    scene = load_scene(
        SCENES / "v-groove.yaml", [f"loads[1].force.direction[1]={math.sqrt(2.0) * needed}", "friction.coefficient=0.5"]
    )
    found = limits_of(run(scene))
    (first,) = found.no_motion
    assert first.motion_at is not None
    assert first.motion is not None
    assert first.motion.direction_world == pytest.approx([0.0, 1.0, 0.0], abs=1e-9)
    assert first.motion_at <= needed * (1.0 + 1e-9) <= first.shown_from * (1.0 + 2e-9)
    assert first.shown_from - first.motion_at <= 1e-4 * needed
    assert (first.shown_to, first.motion_again_at) == (found.up_to, None)
    assert found.balance < needed


@pytest.mark.parametrize(
    ("name", "needed"), [("slope", math.tan(math.radians(30))), ("ladder", math.tan(math.pi / 12))]
)
def test_where_nothing_can_be_wedged_both_frictions_are_the_same(name: str, needed: float) -> None:
    """tan 30 deg on a slope, tan 15 deg of a ladder."""
    found = limits_of(run(load_scene(SCENES / f"{name}.yaml", ["friction.coefficient=0.6"])))
    (first,) = found.no_motion
    assert found.balance == pytest.approx(needed, rel=1e-9)
    assert first.shown_from == pytest.approx(needed, rel=2e-6)
    assert first.motion_at == pytest.approx(needed, rel=2e-6)


def test_without_friction_needed_no_motion_can_begin_from_zero_on() -> None:
    found = limits_of(run(load_scene(SCENES / "rail-pitch.yaml")))
    assert (found.balance, found.no_motion[0].shown_from, found.no_motion[0].motion_at) == (0.0, 0.0, None)


@pytest.mark.parametrize("name", ["v-groove", "planks"])
def test_a_balance_begins_between_those_of_cones_with_64_sides_inside_and_around(name: str) -> None:
    """Linear programs over the run's contacts, solved by SciPy's HiGHS."""
    a_run = run(load_scene(SCENES / f"{name}.yaml"))
    balance = limits_of(a_run).balance
    inner, outer = 1.0, math.cos(math.pi / 64)
    assert is_balanced(a_run, balance / outer * (1.0 + 1e-7), inner)
    assert not is_balanced(a_run, balance * (1.0 - 1e-7), 1.0)
    assert not is_balanced(a_run, balance * outer * (1.0 - 1e-7), 1.0 / outer)


def test_it_says_that_no_motion_can_begin_just_where_an_enumeration_of_modes_finds_none(
    cases: Callable[[int, int], int],
) -> None:
    """Blocks in the plane. In space a block may turn out of the plane where it cannot move within it: each motion that
    is named is one of Coulomb's law.
    """
    rng, n_shown, n_moving, n_out_of_plane = np.random.default_rng(7), 0, 0, 0
    for _ in range(cases(4, 400)):
        block = drawn_block(rng)
        scene = block.scene()
        for friction in (0.1, 0.4, 0.9):
            proof, _contacts = judge_pose(scene, scene.object.pose_world_object, 0, friction)
            if proof.uniqueness == "not shown":
                continue
            is_moving = can_begin_to_move(block, friction)
            n_moving += is_moving
            if proof.verdict == "rests":
                n_shown += 1
                assert not is_moving
            else:
                assert proof.motion is not None
                if proof.uniqueness == "weak":
                    assert obeys_coulomb(block, proof.motion, friction)
                n_out_of_plane += not is_moving
    assert n_shown > 0
    assert n_moving > n_out_of_plane


def test_more_friction_may_bring_a_motion_back_and_each_motion_is_one_of_coulombs_law() -> None:
    """A block wedged between floor and ceiling, which turns out of the plane about its foot, with little friction and
    with much.
    """
    force = np.array([-0.38, -0.92])
    places = np.array([[-0.008, -0.015], [0.005, -0.015], [0.02, 0.005], [-0.002, 0.015]])
    normals = np.array([[0.0, 1.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    block = Block(places, normals, force / np.hypot(*force), np.array([-0.009, -0.009]))
    a_run = run(block.scene())
    (only,) = limits_of(a_run).no_motion
    assert only.motion_at is not None
    assert only.motion is not None
    assert only.motion_again_at is not None
    assert only.motion_at == pytest.approx(only.shown_from, rel=2e-4)
    assert only.motion_again_at == pytest.approx(only.shown_to, rel=5e-4)
    assert obeys_coulomb(block, only.motion, only.motion_at)
    assert not obeys_coulomb(block, only.motion, only.shown_from)
    assert only.motion_again is not None
    assert obeys_coulomb(block, only.motion_again, only.motion_again_at * (1.0 + 1e-3))
    assert not obeys_coulomb(block, only.motion_again, only.shown_to)


def test_own_coefficients_keep_their_proportion() -> None:
    """On a slope of 30 deg a block with a coefficient of its own."""
    scene = load_scene(SCENES / "slope.yaml", ["friction.coefficient=0.9", "friction.of.block=0.6"])
    found = limits_of(run(scene))
    assert (found.has_several, found.present) == (True, 0.6)
    assert found.no_motion[0].shown_from == pytest.approx(math.tan(math.radians(30.0)), rel=2e-6)
    assert found.no_motion[0].motion_at == pytest.approx(math.tan(math.radians(30.0)), rel=2e-6)


def test_what_is_not_held_by_contacts_has_no_such_friction() -> None:
    cage = Cage([(0.0, 0.0, -0.02)])
    falls = Scene(Object([Box((0.01, 0.01, 0.01))], pose=Pose((0.1, 0, 0))), cage, [Load("weight", gravity=(0, 0, -1))])
    found = friction_limits(run(falls))
    assert isinstance(found, Unanswered)
    assert found.unanswered == "nothing is at rest at the end of weight: it ends as 'escapes'"


def test_a_phase_is_named_and_an_unknown_one_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    a_run = run(load_scene(SCENES / "v-groove.yaml"))
    assert limits_of(a_run, "weight").balance == pytest.approx(0.0)
    with pytest.raises(SceneError, match="phase: is 'puhs'"):
        friction_limits(a_run, "puhs")
    assert main(["ask", "friction", str(SCENES / "v-groove.yaml"), "--phase", "puhs"]) == 2
    assert capsys.readouterr().err.startswith("--phase: is 'puhs'")


def test_the_document_has_the_same_numbers(capsys: pytest.CaptureFixture[str]) -> None:
    path = SCENES / "v-groove.yaml"
    assert main(["ask", "friction", str(path), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    found = limits_of(run(load_scene(path)))
    assert (document["balance"], document["phase"]) == (found.balance, "clamp")
    (told,), (only,) = document["no_motion"], found.no_motion
    assert (told["shown_from"], told["motion_at"], told["motion"]["kind"]) == (
        only.shown_from,
        only.motion_at,
        "travel",
    )
