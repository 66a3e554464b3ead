"""What touches without carrying must not tell in the verdict: faces on edges, flush boxes, points that only touch."""

from __future__ import annotations

import numpy as np
import pytest

from cagepose import Box, Cage, Force, Load, Object, Pose, Scene, Spring, run

GRAVITY = [Load("gravity", gravity=(0, 0, -1))]


@pytest.mark.parametrize("axes", [(0, 1, 2), (1, 2, 0), (2, 0, 1)])
def test_a_rest_is_unique_only_if_it_is_with_every_face_on_an_edge(axes):
    """Two of three points are on edges; the box's own axes are numbered in three ways, which is no property of it.

    With one choice of faces every mode but rest is ruled out; with another the object travels along gravity.
    """
    order = np.eye(3)[:, axes]
    aligned = Pose(quaternion_wxyz=(1, 0, 0, 0) if axes == (0, 1, 2) else (0.5, *(0.5 * _cycle_sign(axes))))
    assert np.allclose(aligned.rotation, order)
    box = Box(np.abs(order.T @ [0.04, 0.03, 0.02]), aligned)
    points = [
        (-0.004680195335759398, -0.015, 0.01),
        (0.007743883893135841, 0.015, 0.01),
        (0.02, 0.0, -0.01),
    ]
    center = (-0.009376700530598048, 0.0, 0.0017130129755714451)
    loads = [Load("pull", gravity=(-1.1413184976339208, 0.0, 0.5389014833223098))]
    result = run(Scene(Object([box], center), Cage(points), loads, friction_coefficient=2.0))
    assert result.verdict == "may rest"
    assert result.phases[0].proof.motion is not None


def _cycle_sign(axes):
    """The vector part of the quaternion of a third of a turn that takes the axes round."""
    return np.full(3, 1.0 if axes == (1, 2, 0) else -1.0)


@pytest.mark.parametrize(
    ("heights_mm", "stability"),
    [((-3, -6), "stable"), ((-6, -9), "unstable"), ((-12, -15), "unstable"), ((3, 6), "stable")],
)
def test_stability_looks_into_the_cone_between_contacts_that_may_open(heights_mm, stability):
    """A square bar, edge down, lies in a V of two points below its middle; two more points only touch its ends.

    The motions that close neither end are a wedge of (travel along x, pitch). For low end points the potential falls in
    the middle of it, along no axis of the curvature: a pitch of 1e-4 rad then grows to 0.1 rad.
    """
    half, wide, apart = 0.03, 0.04, 0.03
    bar = Box((2 * half, wide, wide), Pose(euler_zyx=(0, 0, np.pi / 4)))
    at = -wide / np.sqrt(2) + apart / 2
    ends = [(half, 0, heights_mm[0] * 1e-3), (-half, 0, heights_mm[1] * 1e-3)]
    points = [(0, apart / 2, at), (0, -apart / 2, at), *ends]
    result = run(Scene(Object([bar], (0, 0, 0)), Cage(points), GRAVITY))
    assert result.verdict == "rests"
    assert result.phases[0].proof.stability == stability


@pytest.mark.parametrize("turn", [0.0, 0.3, 0.7, 1.1])
def test_freedoms_beside_walls_that_only_touch_do_not_depend_on_the_frame(turn):
    """On a smooth floor, at two walls without force: it can slide along and away, and turn."""
    cage = Pose(euler_zyx=(turn, 0, 0))
    points = [(-0.03, -0.02, 0), (0.03, -0.02, 0), (0, 0.02, 0), (0.04, 0.001, 0.01), (0.002, -0.03, 0.01)]
    held = Object([Box((0.08, 0.06, 0.02))], pose=cage @ Pose((0, 0, 0.01)))
    proof = run(Scene(held, Cage(points, pose=cage), GRAVITY)).phases[0].proof
    assert (proof.stability, proof.undetermined) == ("marginal", ("x", "y", "yaw"))


@pytest.mark.parametrize("swapped", [False, True])
@pytest.mark.parametrize("direction", [(1, 0, 0), (0, 1, 0)])
def test_a_plus_of_two_flush_boxes_slides_off_whichever_is_first(swapped, direction):
    """Six pins below the plate, two of them at its re-entrant corners: none stands in the way of a push sideways."""
    boxes = [Box((0.02, 0.06, 0.004)), Box((0.06, 0.02, 0.004))]
    corners = [(0.01, 0.01, -0.002), (-0.01, 0.01, -0.002)]
    pins = [(x, y, -0.002) for x in (0.005, -0.005) for y in (0.025, -0.025)]
    push = Load("push", gravity=(0, 0, -1.0), force=Force(direction, np.zeros(3), 0.5))
    held = Object(boxes[::-1] if swapped else boxes, np.zeros(3), mass_kg=1.0)
    assert run(Scene(held, Cage(corners + pins), [push])).verdict == "escapes"


@pytest.mark.parametrize("edge_pins_first", [False, True])
def test_many_pins_at_lower_edges_hold_nothing_sideways(edge_pins_first):
    """Eight pins at the lower edges of a plate: 256 combinations of faces, and one that lets it slide."""
    core = [(-0.02, -0.005, -0.005), (0.02, -0.005, -0.005), (0, 0.006, -0.005)]
    front = [(0.03, -0.004, -0.005), (0.03, 0.004, -0.005)]
    sides = [(x, y, -0.005) for x in (-0.015, 0, 0.015) for y in (-0.01, 0.01)]
    points = sides + core + front if edge_pins_first else front + core + sides
    push = Load("push", gravity=(0, 0, -1.0), force=Force((1, 0, 0), (0, 0, -0.004), 0.3))
    held = Object([Box((0.06, 0.02, 0.01))], mass_kg=1.0)
    assert run(Scene(held, Cage(points), [push])).verdict == "escapes"


@pytest.mark.parametrize("raised_mm", [0.0, 1.0])
def test_a_couple_turns_a_free_body_until_its_forces_are_in_line(raised_mm):
    """2 N of weight and 2 N upwards, 10 mm aside: no contact, no force left, and at rest where the arm hangs."""
    push = Force((0, 0, 1), (0.01, 0, raised_mm * 1e-3), 2.0)
    held = Object([Box((0.08, 0.06, 0.02))], mass_kg=1.0)
    result = run(Scene(held, Cage([(0.2, 0.2, 0.2)]), [Load("both", gravity=(0, 0, -2), force=push)]))
    assert result.verdict == "rests"
    assert result.contacts == ()
    arm = result.pose.rotation @ (push.at_object_m - held.center_of_gravity_m)
    assert arm / np.linalg.norm(arm) == pytest.approx([0, 0, 1], abs=1e-9)


CORNERS = [(-0.02, -0.01, 0), (-0.02, 0.01, 0), (0.02, -0.01, 0), (0.02, 0.01, 0)]


@pytest.mark.parametrize("center", [(0, 0, 0), (-0.003, 0.001, 0)])
@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("inward_m", [0.0, 1e-6])
def test_what_falls_only_as_points_are_exactly_on_its_edges_says_so(center, friction, inward_m):
    """A plate on four points under its corners: of real ones rounding decides whether they hold it."""
    plate = Object([Box((0.04, 0.02, 0.01))], center, pose=Pose((0, 0, 0.005)))
    points = np.array(CORNERS) - inward_m * np.sign(CORNERS)
    result = run(Scene(plate, Cage(points), GRAVITY, friction_coefficient=friction))
    at_edges = [warning for warning in result.warnings if "exactly on edges" in warning]
    if inward_m > 0.0:
        assert result.verdict == "rests"
        assert not at_edges
    else:
        assert result.verdict == "escapes"
        assert result.phases[0].events[0].note == "edge"
        assert at_edges == [warning for warning in result.warnings if "event 1" in warning]


def test_what_would_slide_off_an_edge_with_any_face_is_not_told_as_let_go_by_it():
    """The same plate pushed along by more than friction holds, with one of three points on an edge along the push."""
    plate = Object([Box((0.04, 0.02, 0.01))], mass_kg=1.0, pose=Pose((0, 0, 0.005)))
    points = [(-0.01, -0.01, 0), (-0.01, 0.005, 0), (0.015, 0.0, 0)]
    push = Force((1, 0, 0), (0, 0, 0), 20.0)
    loads = [Load("push", gravity=(0, 0, -9.81), force=push)]
    result = run(Scene(plate, Cage(points), loads, friction_coefficient=0.3))
    assert result.verdict == "escapes"
    assert result.phases[0].events[0].note is None


def test_a_slide_along_edges_is_one_event_and_warns_once_at_most():
    """A plate on a floor, with four points exactly at the lower edges of its sides, is pulled along by a spring."""
    floor = Box((0.6, 0.04, 0.02), Pose((0, 0, -0.01)))
    beside = [(x, y, 0.0) for x in (-0.04, 0.04) for y in (-0.03, 0.03)]
    plate = Object([Box((0.4, 0.06, 0.01))], mass_kg=1.0, pose=Pose((0, 0, 0.005)))
    pull = Spring((0.05, 0.0, 0.0), (0.3, 0.0, 0.005), 10.0, 5.0)
    loads = [Load("pull", gravity=(0, 0, -9.81), springs=[pull])]
    result = run(Scene(plate, Cage(beside, shapes=[floor]), loads, friction_coefficient=0.3))
    assert result.verdict in ("rests", "may rest")
    assert len(result.phases[0].events) <= 3
    assert sum("exactly on edges" in warning for warning in result.warnings) <= 1
