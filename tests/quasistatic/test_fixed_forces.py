"""Forces that act at a point of the world, under which the part moves on, against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

from audit.balance import imbalance
from cagepose import (
    Box,
    Cage,
    CageBody,
    Drive,
    Force,
    Load,
    Object,
    Pose,
    Run,
    Scene,
    SceneError,
    Spring,
    Variation,
    margin,
    run,
    run_many,
)
from cagepose.sampling.batch_columns import BatchColumns
from quasistatic.paths import path_of
from sprung_scenes import cube

MM, G = 1e-3, 9.81
LEGS = (-0.1, 0.0)
"""Where a table's points are, along x; the last is its edge."""


def slid(fixed: Force | None, stop_m: float, *, friction: float = 0.0) -> Run:
    """A bar of 0.1 kg and 400 mm, pushed along a table at the height of its middle, to a stop at its front."""
    held = Object([Box((0.4, 0.04, 0.01))], mass_kg=0.1, pose=Pose((-0.08, 0, 0.005)))
    points = [(x, y, 0.0) for x in LEGS for y in (-0.015, 0.015)] + [(stop_m + 0.2, 0.0, 0.005)]
    push = Force((1, 0, 0), (0, 0, 0), 0.5)
    load = Load("push", gravity=(0, 0, -G), forces=[push] if fixed is None else [push, fixed])
    return run(Scene(held, Cage(points), [load], friction_coefficient=friction))


def legs(result: Run) -> np.ndarray:
    """What the points at each end of the table carry."""
    found = np.zeros(len(LEGS))
    for contact in result.contacts:
        if contact.normal_world is not None and abs(contact.normal_world[2]) > 0.5 and contact.place_world is not None:
            found[LEGS.index(round(float(contact.place_world[0]), 6))] += contact.force_normal_n or 0.0
    return found


def test_a_fixed_force_stays_where_it_is_while_the_part_slides_on():
    """The moments about the table's edge: the weight is at the middle of the bar, the force where it was."""
    ended = slid(Force((0, 0, -1), magnitude_n=2.0, at_world_m=(-0.06, 0, 0)), -0.02)
    riding = slid(Force((0, 0, -1), (0.02, 0, 0), 2.0), -0.02)  # at the same place, where the bar begins
    assert ended.verdict == riding.verdict == "rests"
    weight = 0.1 * G
    assert legs(ended)[0] == pytest.approx((weight * 0.02 + 2.0 * 0.06) / 0.1, rel=1e-12)
    assert legs(riding)[0] == pytest.approx(weight * 0.02 / 0.1, rel=1e-10)  # it has come to the edge
    assert legs(ended).sum() == pytest.approx(weight + 2.0, rel=1e-12)


@pytest.mark.parametrize("force_n", [0.0, 0.3, 0.6])
def test_a_bar_tips_where_its_weight_turns_it_over_against_a_fixed_force(force_n):
    """Over the edge by d, where W d = F p."""
    fixed = Force((0, 0, -1), magnitude_n=force_n, at_world_m=(-0.05, 0, 0)) if force_n else None
    poses = path_of(slid(fixed, 0.5).phases[0])
    begins = int(np.argmax([abs(pose.euler_zyx[1]) > 1e-9 for pose in poses]))
    assert begins > 0
    assert poses[begins - 1].position_m[0] == pytest.approx(force_n * 0.05 / (0.1 * G), abs=0.1 * MM)


def test_a_part_that_falls_across_a_fixed_force_begins_to_turn():
    """As much force as weight, through the middle of a cube at the start: after a fall by z the arm of the force is z,
    so that the spin is F z / (m k^2), and as both grow with the time, the turn is z^2 / (2 k^2); k^2 is a sixth of the
    square of the edge. Explicit steps, 0.02 rad long, are short of that by one or two of them.
    """
    fixed = Force((1, 0, 0), magnitude_n=G, at_world_m=(0, 0, 0))
    scene = Scene(cube(mass_kg=1.0), Cage([(0.5, 0.0, -0.5)]), [Load("fall", gravity=(0, 0, -G), forces=[fixed])])
    poses = path_of(run(scene).phases[0])
    drops = np.array([-pose.position_m[2] for pose in poses])
    turns = np.array([abs(pose.euler_zyx[1]) for pose in poses])
    early = (drops > 0.0) & (drops < 0.012)
    assert early.sum() > 5
    assert turns[early] == pytest.approx(drops[early] ** 2 / (2.0 * 0.04**2 / 6.0), abs=0.04)


def test_a_part_ends_where_springs_balance_a_fixed_force():
    """Springs without a tension at zero length are linear: six of stiffness k at arms a, held c times as far, give
    6 k against travels and 4 k c a^2 against turns. With the force F along z at x = p it sinks by F / 6 k, and it turns
    about y until 4 k c a^2 sin t = F p: the moment of a fixed force hangs on no angle.
    """
    k, arm, far, force, p = 500.0, 0.02, 3.0, 4.0, 0.03
    ended = run(sprung(k, arm, far, [Force((0, 0, -1), magnitude_n=force, at_world_m=(p, 0, 0.1))]))
    assert ended.verdict == "rests"
    assert ended.pose.position_m == pytest.approx([0.0, 0.0, -force / (6.0 * k)], abs=1e-12)
    assert ended.pose.euler_zyx == pytest.approx([0.0, math.asin(force * p / (4.0 * k * far * arm**2)), 0.0], abs=1e-11)
    assert imbalance(ended.scene, ended.phases[0]) < 1e-10


@pytest.mark.parametrize(("share", "stability"), [(0.9, "stable"), (1.1, "not shown")])
def test_its_coupling_of_travels_and_turns_is_half_in_the_symmetric_stiffness(share, stability):
    """The moment about the part grows by F for each metre it goes aside: the symmetric part of (6 k, 0; F, 4 k c a^2)
    is positive where F^2 < 4 (6 k) (4 k c a^2). What is above may be stable, too, but is not claimed.
    """
    k, arm, far = 500.0, 0.02, 3.0
    force = share * 2.0 * math.sqrt(6.0 * k * 4.0 * k * far * arm**2)
    ended = run(sprung(k, arm, far, [Force((0, 0, -1), magnitude_n=force, at_world_m=(0, 0, 0))]))
    assert (ended.verdict, ended.phases[0].proof.stability) == ("rests", stability)


def test_a_force_through_a_joint_turns_nothing_and_one_that_rides_hangs_or_stands():
    """A cube on a ball joint of stiff springs at its middle, pulled down: at a point below that rides on it, it hangs;
    at a point above it stands; at a fixed point no turn changes anything.
    """

    def stability(force: Force) -> str | None:
        joint = [Spring((0, 0, 0), 0.1 * axis, 1e5, 0.0) for axis in (*np.eye(3), *-np.eye(3))]
        return (
            run(Scene(cube(), Cage([(0.9, 0.9, 0.9)]), [Load("pull", forces=[force], springs=joint)]))
            .phases[0]
            .proof.stability
        )

    down = (0, 0, -1)
    assert stability(Force(down, magnitude_n=5.0, at_world_m=(0, 0, -0.02))) != "unstable"
    assert stability(Force(down, (0, 0, -0.02), 5.0)) == "marginal"  # free to turn about the line of the force
    assert stability(Force(down, (0, 0, 0.02), 5.0)) == "unstable"


def test_a_part_that_a_fixed_force_drives_round_ends_as_limit_and_says_why():
    joint = [Spring((0, 0, 0), 0.1 * axis, 1e3, 0.0) for axis in (*np.eye(3), *-np.eye(3))]
    crank = Load("crank", forces=[Force((0, 1, 0), magnitude_n=0.1, at_world_m=(0.05, 0, 0))], springs=joint)
    ended = run(Scene(cube(), Cage([(0.9, 0.9, 0.9)]), [crank]))
    assert ended.verdict == "limit"
    assert any("stay at a point of the world" in warning for warning in ended.warnings)


def test_the_frame_does_not_matter():
    here = cornered(Force((1, -0.4, -0.5), magnitude_n=3.0, at_world_m=(-0.02, 0.004, 0.03)), Pose())
    moved = Pose((0.3, -0.2, 0.1), euler_zyx=(0.7, -0.4, 1.1))
    force = Force(
        moved.rotation @ (1, -0.4, -0.5), magnitude_n=3.0, at_world_m=moved.transform(np.array([-0.02, 0.004, 0.03]))
    )
    there = cornered(force, moved)
    one, other = run(here), run(there)
    assert one.verdict == other.verdict == "rests"
    assert (moved @ one.pose).position_m == pytest.approx(other.pose.position_m, abs=1e-11)
    assert [contact.point for contact in one.contacts] == [contact.point for contact in other.contacts]


def test_rows_of_a_batch_are_the_runs_to_the_last_bit_where_the_cage_is_misaligned():
    scene = cornered(Force((1, -0.4, -0.5), magnitude_n=3.0, at_world_m=(-0.02, 0.004, 0.03)), Pose())
    angles = [(0.0, 0.0, 0.0), (0.02, 0.0, 0.0), (0.0, 0.01, -0.01)]
    rows = run_many(scene, Variation(cage_euler_zyx=angles, cage_position_m=[(0, 0, 0), (1e-3, 0, 0), (0, 0, -1e-3)]))
    for row, (euler, shift) in enumerate(zip(angles, [(0, 0, 0), (1e-3, 0, 0), (0, 0, -1e-3)], strict=True)):
        alone = run(Scene(scene.object, Cage(scene.cage.points_cage, pose=Pose(shift, euler_zyx=euler)), scene.loads))
        assert np.array_equal(rows.position_m[row, 0], alone.pose.position_m)
        assert rows.verdict[row] == alone.verdict


def test_a_batch_varies_no_place_on_the_part_of_a_force_that_has_none():
    scene = cornered(Force((1, -0.4, -0.5), magnitude_n=3.0, at_world_m=(-0.02, 0.004, 0.03)), Pose())
    with pytest.raises(SceneError, match="the force acts at a point of the world"):
        run_many(scene, Variation(force_at_object_m=[(0, 0, 0)]))
    data = {"loads": [{"name": "push", "force": {"direction": [1, 0, 0], "at_world": [0, 0, 0], "magnitude": 1.0}}]}
    takes = BatchColumns(data, "mm").takes
    assert takes(("loads", 0, "force", "magnitude"))
    assert not takes(("loads", 0, "force", "at_world", 0))  # a study builds a scene for each


def test_a_rest_has_the_margin_of_the_same_force_that_rides():
    scene = cornered(Force((1, -0.4, -0.5), magnitude_n=3.0, at_world_m=(-0.02, 0.004, 0.03)), Pose())
    ended = run(scene)
    at = ended.pose.inverse_transform(np.array([-0.02, 0.004, 0.03]))
    riding = Scene(
        Object(scene.object.boxes, mass_kg=0.2, pose=ended.pose),
        scene.cage,
        [Load("push", gravity=(0, 0, -G), forces=[Force((1, -0.4, -0.5), at, 3.0)])],
    )
    one, other = margin(ended), margin(run(riding))
    assert one is not None
    assert other is not None
    assert one.force_n == pytest.approx(other.force_n, rel=1e-6)
    assert one.moment_nm == pytest.approx(other.moment_nm, rel=1e-6)


@pytest.mark.parametrize("friction", [0.0, 0.2])
def test_a_drive_moves_a_part_on_below_a_fixed_force(friction):
    """A block on a table, pushed at the height of its middle h: the force stays at x = 0, and so the moments about the
    front leg change as the weight goes on; the drive takes what friction takes.
    """
    held = Object([Box((0.2, 0.04, 0.02))], mass_kg=0.1, pose=Pose((0, 0, 0.01)))
    points = [(x, y, 0.0) for x in (-0.05, 0.05) for y in (-0.015, 0.015)]
    mate = CageBody("mate", [(-0.1, 0.0, 0.01)])
    fixed = Force((0, 0, -1), magnitude_n=2.0, at_world_m=(0, 0, 0.05))
    load = Load("push", gravity=(0, 0, -G), forces=[fixed], drive={"mate": Drive(travel=(0.03, 0, 0))})
    smooth = {"mate/C1": 0.0}
    ended = run(Scene(held, Cage(points, bodies=[mate]), [load], friction_coefficient=friction, friction_of=smooth))
    assert ended.verdict in ("rests", "may rest")
    assert ended.pose.position_m == pytest.approx([0.03, 0.0, 0.01], abs=1e-9)
    drive = ended.phases[0].drive
    assert drive is not None
    assert drive.along == pytest.approx(friction * (0.1 * G + 2.0), rel=1e-9, abs=1e-12)
    front = sum(
        contact.force_normal_n or 0.0
        for contact in ended.contacts
        if contact.place_world is not None and contact.place_world[0] > 0.04
    )
    wanted = (0.1 * G * 0.08 + 2.0 * 0.05) / 0.1  # friction is at the feet, h below the push that balances it
    assert front == pytest.approx(wanted + friction * (0.1 * G + 2.0) * 0.01 / 0.1, rel=1e-6)


def sprung(k: float, arm: float, far: float, forces: list[Force]) -> Scene:
    springs = [Spring(arm * a, far * arm * a, k, k * (far - 1.0) * arm) for a in (*np.eye(3), *-np.eye(3))]
    return Scene(cube(), Cage([(0.9, 0.9, 0.9)]), [Load("pull", forces=forces, springs=springs)])


def cornered(force: Force, moved: Pose) -> Scene:
    """A brick on three points, pushed into a corner of three more."""
    points = [(-0.03, -0.02, 0), (-0.03, 0.02, 0), (0.03, 0, 0), (-0.025, -0.031, 0.004), (0.025, -0.031, 0.004)]
    points.append((0.042, 0, 0.004))
    held = Object([Box((0.08, 0.06, 0.01))], mass_kg=0.2, pose=moved @ Pose((0, 0, 0.008)))
    gravity = moved.rotation @ (0, 0, -G)
    return Scene(held, Cage(points, pose=moved), [Load("push", gravity=gravity, forces=[force])])
