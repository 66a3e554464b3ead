"""Friction of single cage points and boxes: a contact has that of its point, else of its box, else of the scene."""

from __future__ import annotations

import numpy as np
import pytest

from cagepose import Box, Cage, Load, Object, Pose, Scene, SceneError, Variation, compare, margin, run, run_many
from cagepose.runs.critical import with_critical_friction

FEET = np.array([(0.04, 0.03, 0.0), (0.04, -0.03, 0.0), (-0.04, -0.03, 0.0), (-0.04, 0.03, 0.0)])


def on_a_slope(tilt_rad: float, friction: float, **friction_of: float) -> Scene:
    """A block on four feet, the first two of them ahead; gravity leans by the angle along x."""
    held = Object([Box((0.1, 0.08, 0.02), Pose((0, 0, 0.01)), "block")])
    down = (np.sin(tilt_rad), 0.0, -np.cos(tilt_rad))
    loads = [Load("weight", gravity=down)]
    return Scene(held, Cage(FEET), loads, friction_coefficient=friction, friction_of=friction_of)


def ladder(wall: float, floor: float) -> Scene:
    """A rod at 60 deg between a floor and a wall, two points each, its ends boxes of their own."""
    angle, length = np.radians(60.0), 1.0
    foot, head = np.array([0.0, 0.0, 0.0]), length * np.array([np.cos(angle), 0.0, np.sin(angle)])
    boxes = [
        Box((0.02, 0.1, 0.02), Pose(foot + np.array((0, 0, 0.01))), "foot"),
        Box((0.02, 0.1, 0.02), Pose(head - np.array((0.01, 0, 0))), "head"),
    ]
    points = [(*foot[:1], y, 0.0) for y in (-0.03, 0.03)] + [(head[0], y, head[2]) for y in (-0.03, 0.03)]
    own = {"W1": wall, "W2": wall} | ({} if floor < 0.0 else {"F1": floor, "F2": floor})
    middle = 0.5 * (foot + head)
    return Scene(
        Object(boxes, middle), Cage(points, ["F1", "F2", "W1", "W2"]), [Load("weight", gravity=(0, 0, -1))],
        friction_coefficient=0.5, friction_of=own,
    )  # fmt: skip


@pytest.mark.parametrize("beyond", [-1e-8, 1e-8])
def test_a_slope_is_held_up_to_a_hundred_millionth_of_its_limit(beyond):
    """By Coulomb's law alone, tan t = mu: on four feet so low that nothing tips."""
    found = run(on_a_slope(np.arctan(0.3 * (1.0 + beyond)), 0.3))
    assert found.verdict == ("rests" if beyond < 0.0 else "escapes")


@pytest.mark.parametrize("share", [0.999, 1.001])
def test_two_smooth_feet_leave_all_friction_to_the_others(share):
    """With the centre of gravity at height h over feet 2a apart, the rear ones carry (1 - h/a tan t)/2 of it."""
    rough, height, half = 0.4, 0.01, 0.04
    # tan t = mu (1 - h/a tan t)/2
    tilt = np.arctan(rough / (2.0 + rough * height / half))
    scene = on_a_slope(tilt * share, 0.0, C3=rough, C4=rough)
    found = run(scene)
    assert found.verdict == ("may rest" if share < 1.0 else "escapes")  # one of the two alone may carry: a turn


def test_all_points_with_the_scene_s_coefficient_are_the_scene():
    one, other = on_a_slope(0.1, 0.3), on_a_slope(0.1, 0.0, C1=0.3, C2=0.3, C3=0.3, C4=0.3)
    by_box = on_a_slope(0.1, 0.0, block=0.3)
    runs = [run(scene) for scene in (one, other, by_box)]
    forces = [[contact.force_tangential_n.tolist() for contact in found.phases[0].contacts] for found in runs]
    assert forces[0] == forces[1] == forces[2]
    assert {found.verdict for found in runs} == {"rests"}


def test_a_point_comes_before_its_box():
    assert run(on_a_slope(0.1, 0.3, block=0.0)).verdict == "escapes"
    assert run(on_a_slope(0.1, 0.0, block=0.0, C1=0.3, C2=0.3, C3=0.3, C4=0.3)).verdict == "rests"


@pytest.mark.parametrize("scale", [0.999, 1.001])
def test_a_ladder_at_a_smooth_wall_needs_friction_of_its_foot_alone(scale):
    """cot(60 deg) / 2, and where the foot has its own coefficient that of the scene does not matter."""
    needed = 0.5 / np.tan(np.radians(60.0))
    found = run(ladder(0.0, needed * scale))
    assert (found.verdict == "rests") == (scale > 1.0)


def test_the_critical_friction_is_the_greatest_coefficient_with_all_in_proportion():
    """The foot's, with that of the wall a third of it: mu (1 + mu/3 cot(60 deg) ... ) by the balance of the ladder."""
    found = with_critical_friction(run(ladder(0.2, 0.6))).phases[0].proof.critical_friction
    # floor N, mu N; wall H = mu N, up mu/3 H; moments about the foot: W cos/2 = H sin + mu/3 H cos.
    cos, sin = np.cos(np.radians(60.0)), np.sin(np.radians(60.0))

    def excess(mu: float) -> float:
        floor = 1.0 / (1.0 + mu * mu / 3.0)
        return float(mu * floor * (sin + mu / 3.0 * cos) - 0.5 * cos)

    assert excess(found) == pytest.approx(0.0, abs=1e-9)
    smooth = with_critical_friction(run(on_a_slope(0.1, 0.9, C1=0.0))).phases[0].proof.critical_friction
    rough = with_critical_friction(run(on_a_slope(0.1, 0.9))).phases[0].proof.critical_friction
    assert smooth > rough == pytest.approx(np.tan(0.1), rel=1e-9)


def test_forces_stay_in_the_cones_of_their_contacts():
    found = run(on_a_slope(0.1, 0.3, C1=0.0, C2=0.05))
    assert found.verdict in ("rests", "may rest")
    limits = {"C1": 0.0, "C2": 0.05, "C3": 0.3, "C4": 0.3}
    down = np.array((np.sin(0.1), 0.0, -np.cos(0.1)))
    total = np.zeros(3)
    for contact in found.phases[0].contacts:
        size = np.linalg.norm(contact.force_tangential_n)
        assert size <= limits[contact.point] * contact.force_normal_n * (1 + 1e-9) + 1e-15
        total += contact.force_tangential_n - contact.force_normal_n * contact.normal_world
    assert total == pytest.approx(-down, abs=1e-9)
    shares = {one.point: np.linalg.norm(one.equally_stiff_tangential_n) for one in margin(found).contacts}
    assert shares["C1"] == 0.0
    assert 0.0 < shares["C2"] < shares["C3"]


def test_a_row_of_a_batch_is_the_run():
    scene = on_a_slope(0.1, 0.0, C1=0.0)
    rows = run_many(scene, Variation(friction_coefficient=[0.05, 0.15, 0.3]))
    for row, friction in enumerate((0.05, 0.15, 0.3)):
        one = run(on_a_slope(0.1, friction, C1=0.0))
        assert rows.phase_verdicts[row, 0] == one.verdict
        assert (rows.position_m[row, 0] == one.pose.position_m).all()


def test_names_and_numbers_are_checked():
    with pytest.raises(SceneError, match=r"friction.of.C9: is neither in the cage nor in the object"):
        on_a_slope(0.1, 0.3, C9=0.1)
    with pytest.raises(SceneError, match=r"friction.of.C1: is -0.1; give a finite coefficient"):
        on_a_slope(0.1, 0.3, C1=-0.1)
    with pytest.raises(SceneError, match="one friction for all"):
        run(on_a_slope(0.1, 0.3, C1=0.1), "stepwise")


def test_compare_tells_of_the_method_that_cannot():
    with pytest.raises(SceneError, match="one friction for all"):
        compare(on_a_slope(0.1, 0.3, C1=0.1))
