"""What is asked about the end of a phase is asked with the bodies of the cage where they were driven to."""

from __future__ import annotations

import math

import numpy as np
import pytest

import cagepose
from cagepose import Box, Cage, CageBody, Drive, Force, Load, Object, Pose, Run, Scene, Spring
from cagepose.runs.critical import with_critical_friction
from cagepose.runs.drives import displaced_after
from cagepose.runs.judge import judge_pose
from cagepose.studies.pushes import Freedom
from cagepose.studies.seat import seated

DOWN = (0.0, 0.0, -9.81)
SIDEWAYS_N = 5.0
FEET = [(-0.008, -0.015, 0.0), (0.008, -0.015, 0.0), (0.0, 0.015, 0.0)]


def is_right(run: Run, phase: int) -> bool:
    """Whether there is a certificate of the end of a phase which is right."""
    found = cagepose.certificate(run, phase)
    assert found is not None
    cagepose.check_certificate(found, run, phase)
    return True


def carried(body: CageBody, *, cage: Pose) -> Scene:
    """A block on a body, which carries it up; then that stands still, and a force pushes the block to the side at its
    foot. The cage may be anywhere.
    """
    block = Object([Box((0.02, 0.04, 0.01))], mass_kg=2.0, pose=cage @ Pose((0.0, 0.0, 0.005)))
    down, aside = cage.rotation @ DOWN, cage.rotation @ (0.0, 1.0, 0.0)
    carry = Load("carry", gravity=down, drive={"table": Drive((0.0, 0.0, 0.1))})
    push = Load("push", gravity=down, force=Force(aside, (0.0, 0.0, -0.005), SIDEWAYS_N))
    return Scene(block, Cage(bodies=[body], pose=cage), [carry, push], friction_coefficient=0.3)


ELSEWHERE = Pose((3.0, -2.0, 1.0), euler_zyx=(0.4, -0.7, 1.1))


@pytest.mark.parametrize(("is_of_points", "cage"), [(False, Pose()), (False, ELSEWHERE), (True, Pose())])
def test_a_block_on_a_table_that_carried_it_up_needs_the_friction_of_a_push(is_of_points: bool, cage: Pose) -> None:
    on_box = CageBody("table", shapes=[Box((0.3, 0.3, 0.02), Pose((0.0, 0.0, -0.01)), "top")])
    run = cagepose.run(carried(CageBody("table", FEET) if is_of_points else on_box, cage=cage))
    assert [phase.verdict for phase in run.phases] == ["rests", "rests"]
    needed = [phase.proof.critical_friction for phase in with_critical_friction(run).phases]
    assert needed == pytest.approx([0.0, SIDEWAYS_N / (2.0 * 9.81)], rel=1e-9)
    for phase in (0, 1):
        assert is_right(run, phase)
        margin = cagepose.margin(run, phase)
        assert margin is not None
        assert sum(contact.equally_stiff_n for contact in margin.contacts) == pytest.approx(2.0 * 9.81, rel=1e-9)


def test_jaws_that_closed_hold_where_they_stand() -> None:
    """They close on a block, which stays on its shelf as they rise beside it; then they stand higher."""
    block = Object([Box((0.02, 0.04, 0.02))], mass_kg=1.0, pose=Pose((0.0, 0.0, 0.01)))
    shelf = Box((0.2, 0.2, 0.02), Pose((0.0, 0.0, -0.01)), "shelf")
    jaws = [
        CageBody(name, shapes=[Box((0.01, 0.1, 0.06), Pose((x, 0.0, 0.035)), f"{name} pad")])
        for name, x in (("left", -0.04), ("right", 0.04))
    ]
    close = Load("close", gravity=DOWN, drive={"left": Drive((0.03, 0, 0)), "right": Drive((-0.03, 0, 0))})
    lift = Load("lift", gravity=DOWN, drive={"left": Drive((0, 0, 0.001)), "right": Drive((0, 0, 0.001))})
    cage = Cage(shapes=[shelf], bodies=jaws)
    run = cagepose.run(Scene(block, cage, [close, lift], friction_coefficient=0.3, friction_of={"shelf": 0.0}))
    assert run.phases[0].verdict == "blocked"
    assert run.phases[0].drive is not None
    assert run.phases[0].drive.share == pytest.approx(2.5 / 3.0, abs=1e-9)
    assert displaced_after(run, 1)[:, :3] == pytest.approx(
        np.array([(0, 0, 0), (0.025, 0, 0.001), (-0.025, 0, 0.001)]), abs=1e-10
    )
    for number, phase in enumerate(run.phases):
        proof, contacts = judge_pose(run.scene, phase.pose, number, 0.3, displaced_after(run, number))
        assert {contact.point for contact in contacts} == {"shelf", "left pad", "right pad"}
        assert (proof.verdict, proof.reason) == (phase.proof.verdict, phase.proof.reason)
        assert is_right(run, number)
        margin = cagepose.margin(run, number)
        assert margin is not None
        assert margin.force_n == math.inf  # pads with nothing between them and the block press without end
    assert [phase.proof.critical_friction for phase in with_critical_friction(run).phases] == [0.0, 0.0]


def test_a_spring_is_held_where_its_body_is() -> None:
    """A shelf rises with a block on it, which a spring from the shelf pulls down all the way."""
    block = Object([Box((0.02, 0.04, 0.02))], mass_kg=1.0, pose=Pose((0.0, 0.0, 0.01)))
    shelf = CageBody("shelf", shapes=[Box((0.2, 0.2, 0.02), Pose((0.0, 0.0, -0.01)), "top")])
    spring = Spring((0, 0, 0), (0, 0, -0.05), 1000.0, 7.0, of="shelf")
    rise = Load("rise", gravity=DOWN, springs=[spring], drive={"shelf": Drive((0, 0, 0.1))})
    hold = Load("hold", gravity=DOWN, springs=[spring])
    run = cagepose.run(Scene(block, Cage(bodies=[shelf]), [rise, hold], friction_coefficient=0.3))
    assert [phase.verdict for phase in run.phases] == ["rests", "rests"]
    assert run.pose.position_m == pytest.approx((0.0, 0.0, 0.11), abs=1e-8)
    for number, phase in enumerate(run.phases):
        _, contacts = judge_pose(run.scene, phase.pose, number, 0.3, displaced_after(run, number))
        carried = [sum(contact.force_normal_n or 0.0 for contact in of) for of in (contacts, phase.contacts)]
        assert carried == pytest.approx([16.81, 16.81], rel=1e-12)
        assert phase.proof.largest_force is not None
        assert phase.proof.largest_force <= 1.0
        assert is_right(run, number)
        margin = cagepose.margin(run, number)
        assert margin is not None
        assert sum(contact.equally_stiff_n for contact in margin.contacts) == pytest.approx(16.81, rel=1e-9)


def test_pushes_from_a_seat_begin_where_bodies_have_been_driven_to() -> None:
    """A smooth block that a spring draws onto a shelf, which rose: a small push of it moves against 140 N/m."""
    block = Object([Box((0.02, 0.04, 0.02))], mass_kg=1.0, pose=Pose((0.0, 0.0, 0.01)))
    shelf = CageBody("shelf", shapes=[Box((0.2, 0.2, 0.02), Pose((0.0, 0.0, -0.01)), "top")])
    spring = Spring((0, 0, 0), (0, 0, -0.04), 1000.0, 7.0, of="shelf")
    rise = Load("rise", gravity=DOWN, springs=[spring], drive={"shelf": Drive((0, 0, 0.1))})
    hold = Load("hold", gravity=DOWN, springs=[spring])
    scene = Scene(block, Cage(bodies=[shelf]), [rise, hold], friction_coefficient=0.0)
    away = 1e-4 * (9.81 + 50.0 + 43.0) / 140.0  # a push is so much of weight and of what a spring's tension is made of
    for phase in ("rise", "hold"):
        pushes = seated(scene, phase)
        assert pushes.start.position_m == pytest.approx((0.0, 0.0, 0.11), abs=1e-9)
        for sign in (1.0, -1.0):
            pushed = pushes.push(Freedom(np.zeros(3), np.array((1.0, 0.0, 0.0))), sign, pushes.start)
            assert pushed.rests
            x, _, z = pushed.pose.position_m
            assert (sign * x, z) == (pytest.approx(away, rel=1e-4), pytest.approx(0.11, abs=1e-9))
