"""The paper's sample: a cube over four points. Hand answers: docs/theory, "The sample".

The cube's side faces lie at distances a and b from the first point touched, the points s apart: the two turns are
acos(a/s) and acos(b/s).
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cagepose import Box, Cage, Load, Object, Pose, Run, Scene
from stepwise_run import run

MM = 1e-3


def sample_scene(
    a=7.0, b=5.0, s=8.0, height=10.0, drop=5.0, *, scale=MM, frame=None, order=None, mirror=False, cog_y=0.0
):
    """A box whose faces lie at -a (x) and -b (y) from the point C1.

    In the sample a = 7 and b = 5 come with a 10 mm cube at (2, 4): C1 is 2 mm from the centre in x and 0 in y.
    """
    half = s / 2.0
    size = np.array([10.0, 10.0, height])
    center = np.array([half - a + size[0] / 2.0, half - b + size[1] / 2.0, drop + height / 2.0])
    points = np.array([[half, half, 0.0], [half, -half, 0.0], [-half, -half, 0.0], [-half, half, 0.0]])
    cog = np.array([0.0, cog_y, 0.0])
    flip = np.array([1.0, -1.0, 1.0]) if mirror else np.ones(3)
    frame = frame or Pose()
    order = list(range(4)) if order is None else order
    names = [f"C{index + 1}" for index in order]
    return Scene(
        Object([Box(size * scale)], cog * flip * scale, pose=frame @ Pose(center * flip * scale)),
        Cage(points[order] * flip * scale, names, pose=frame),
        [Load("gravity", gravity=frame.rotation @ (0.0, 0.0, -1.0))],
        name="sample",
    )


def turns_deg(result: Run) -> list[float]:
    motions = [event.motion for event in result.phases[0].events if event.motion is not None]
    return [math.degrees(motion.angle_rad) for motion in motions if motion.kind == "turn"]


def test_the_published_numbers_come_out():
    result = run(sample_scene())
    travel, first, second, held = result.phases[0].events
    assert [event.rule for event in result.phases[0].events] == ["A-1", "A-2", "A-3", "A-4"]
    assert travel.motion.distance_m == pytest.approx(5 * MM, abs=1e-12 * MM)
    assert (travel.hit, first.hit, second.hit) == (("C1",), ("C4",), ("C3",))
    assert_allclose(first.motion.axis_world, (0, -1, 0), atol=1e-15)
    assert_allclose(first.motion.through_world / MM, (4, 4, 0), atol=1e-12)
    assert_allclose(second.motion.axis_world, (1, 0, 0), atol=1e-15)
    assert_allclose(turns_deg(result), np.degrees([math.acos(7 / 8), math.acos(5 / 8)]), atol=1e-9)
    assert result.verdict == "stable"
    assert held.motion is None
    assert {contact.point for contact in result.contacts} == {"C1", "C3", "C4"}


def test_the_final_pose_is_that_of_the_two_turns():
    """Turn the centre and the axes by hand: acos(7/8) about (0,-1,0), then acos(5/8) about (1,0,0), both through C1."""
    result = run(sample_scene())
    c, s = 7 / 8, math.sqrt(1 - (7 / 8) ** 2)
    about_minus_y = np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]])
    c, s = 5 / 8, math.sqrt(1 - (5 / 8) ** 2)
    about_x = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    pivot = np.array([4.0, 4.0, 0.0])
    rotation = about_x @ about_minus_y
    assert_allclose(result.pose.rotation, rotation, atol=1e-14)
    assert_allclose(result.pose.position_m / MM, pivot + rotation @ (np.array([2.0, 4.0, 5.0]) - pivot), atol=1e-9)
    assert_allclose(np.degrees(result.pose.euler_zyx), (-23.3598, -17.6124, 54.9864), atol=5e-5)
    assert_allclose(result.center_of_gravity_world / MM, (-0.170615, 1.340603, 2.129221), atol=5e-7)


def test_the_tie_and_the_range_of_45_degrees_are_on_the_result():
    result = run(sample_scene())
    assert [event.note for event in result.phases[0].events] == [None, None, "tie", None]
    assert any("tie" in warning and "A-3" in warning for warning in result.warnings)
    assert any("55.0 deg" in warning and "45 deg" in warning for warning in result.warnings)


@pytest.mark.parametrize(("a", "b", "s"), [(7, 5, 8), (6.5, 5, 9), (9, 4, 9.5), (7.5, 5, 7.6), (8, 3, 8.2)])
def test_any_box_turns_by_acos_of_face_distance_over_spacing(a, b, s):
    # Tall enough for the third point to meet the face; the CoG stays over the line C1-C4, as in the sample.
    scene = sample_scene(a, b, s, height=16.0, cog_y=b - 5.0)
    result = run(scene)
    assert_allclose(turns_deg(result)[:2], np.degrees([math.acos(a / s), math.acos(b / s)]), atol=1e-9)
    assert result.phases[0].events[2].note == "tie"


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("scale", [1e-3 * MM, MM, 1e3 * MM])
def test_turned_moved_and_scaled_it_is_the_same_result(seed, scale):
    rng = np.random.default_rng(seed)
    frame = Pose(rng.uniform(-50, 50, 3) * scale, rng.normal(size=4))
    expected = run(sample_scene()).pose
    result = run(sample_scene(scale=scale, frame=frame))
    assert result.verdict == "stable"
    assert [event.rule for event in result.phases[0].events] == ["A-1", "A-2", "A-3", "A-4"]
    assert result.phases[0].events[2].note == "tie"
    assert_allclose(turns_deg(result), np.degrees([math.acos(7 / 8), math.acos(5 / 8)]), atol=1e-9)
    inside = frame.inverse() @ result.pose
    assert_allclose(inside.position_m / scale, expected.position_m / MM, atol=1e-9)
    assert_allclose(np.degrees(inside.euler_zyx), np.degrees(expected.euler_zyx), atol=1e-9)


@pytest.mark.parametrize("order", [[1, 2, 3, 0], [3, 2, 1, 0], [2, 0, 3, 1]])
def test_renumbered_points_give_the_same_result(order):
    expected, result = run(sample_scene()), run(sample_scene(order=order))
    assert_allclose(result.pose.position_m, expected.pose.position_m, atol=1e-15)
    assert {contact.point for contact in result.contacts} == {"C1", "C3", "C4"}


@pytest.mark.parametrize("offset", [0.01, -0.01])
def test_off_the_tie_line_the_mirrored_scene_gives_the_mirrored_result(offset):
    """On the line a convention decides, which a mirror cannot respect; 0.01 mm beside it the load decides."""
    plain, mirrored = run(sample_scene(cog_y=offset)), run(sample_scene(cog_y=offset, mirror=True))
    flip = np.array([1.0, -1.0, 1.0])
    assert plain.verdict == mirrored.verdict
    assert not any(event.note == "tie" for event in plain.phases[0].events)
    assert len(plain.phases[0].events) == len(mirrored.phases[0].events)
    assert_allclose(mirrored.pose.position_m / MM, flip * plain.pose.position_m / MM, atol=1e-9)
    assert_allclose(mirrored.pose.rotation, np.outer(flip, flip) * plain.pose.rotation, atol=1e-12)


def test_the_two_sides_of_the_tie_line_fall_to_different_sides():
    inner, outer = run(sample_scene(cog_y=-0.01)), run(sample_scene(cog_y=0.01))
    assert_allclose(inner.phases[0].events[2].motion.axis_world, (1, 0, 0), atol=1e-12)
    assert_allclose(outer.phases[0].events[2].motion.axis_world, (-1, 0, 0), atol=1e-12)
