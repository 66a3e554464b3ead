"""One scene for each rule of docs/theory that the sample and the rail do not show, each small enough for a hand
answer.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from audit.families import drawn_scenes
from cagepose import Box, Cage, Force, Load, Object, Pose, Scene, Tolerances
from stepwise_run import run

DOWN = Load("gravity", gravity=(0, 0, -1))
FLOOR = [(1.0, 1.0, 0.0), (1.0, -1.0, 0.0), (-1.0, -1.0, 0.0), (-1.0, 1.0, 0.0)]


def block(size=(4.0, 4.0, 2.0), at=(0.0, 0.0, 1.0), cog=(0.0, 0.0, 0.0)):
    """A block that stands on the floor z = 0, unless ``at`` lifts it."""
    return Object([Box(size)], cog, pose=Pose(at))


def push(direction, at, name="push"):
    return Load(name, force=Force(direction, at))


def rules(result, phase=0):
    return [event.rule for event in result.phases[phase].events]


def last_motion(result):
    motions = [event.motion for event in result.phases[-1].events if event.motion is not None]
    return motions[-1]


def test_a_block_on_its_points_stays():
    result = run(Scene(block(), Cage(FLOOR), [DOWN]))
    assert rules(result) == ["A-4"]
    assert result.verdict == "stable"
    assert result.pose.position_m.tolist() == [0.0, 0.0, 1.0]


def test_nothing_below_means_it_escapes():
    result = run(Scene(block(at=(0, 0, -5)), Cage(FLOOR), [DOWN]))
    assert result.verdict == "escapes"
    (event,) = result.phases[0].events
    assert event.motion.distance_m == math.inf
    assert_allclose(event.motion.direction_world, (0, 0, -1))
    assert result.pose.position_m.tolist() == [0.0, 0.0, -5.0]


class TestR1:
    def test_one_contact_turns_about_the_horizontal_axis_across_the_arm(self):
        """One point at (1, 0), CoG above the origin: the left side goes down, a turn about -y."""
        scene = Scene(block(at=(0, 0, 1.5)), Cage([(1, 0, 0), (-1.9, 0.0, -0.8), (0, 1, -5)]), [DOWN])
        turn = run(scene).phases[0].events[1]
        assert turn.rule == "A-2"
        assert_allclose(turn.motion.axis_world, (0, -1, 0), atol=1e-15)
        assert_allclose(turn.motion.through_world, (1, 0, 0), atol=1e-12)

    def test_a_load_line_through_the_contact_is_balanced_and_warned_about(self):
        result = run(Scene(block(), Cage([(0, 0, 0), (9, 9, 9), (9, -9, 9)]), [DOWN]))
        assert result.verdict == "stable"
        assert any("balanced" in warning for warning in result.warnings)


class TestR2:
    def test_two_contacts_turn_in_the_sense_of_the_moment(self):
        for offset, sense in ((0.5, -1.0), (-0.5, 1.0)):
            points = [(1, 0, 0), (-1, 0, 0), (0, 1.9, -0.5), (0, -1.9, -0.5)]
            result = run(Scene(block(cog=(0, offset, 0)), Cage(points), [DOWN]))
            first = result.phases[0].events[0]
            assert first.rule == "A-3"
            assert first.note is None
            assert_allclose(first.motion.axis_world, (sense, 0, 0), atol=1e-15)

    def test_a_tie_keeps_the_axis_from_the_second_to_the_first_contact(self):
        points = [(1, 0, 0), (-1, 0, 0), (0, 1.9, -0.5), (0, -1.9, -0.5)]
        first = run(Scene(block(), Cage(points), [DOWN])).phases[0].events[0]
        assert first.note == "tie"
        assert_allclose(first.motion.axis_world, (1, 0, 0), atol=1e-15)


class TestR3:
    def test_a_centre_of_gravity_outside_of_the_support_tips_over_its_edge(self):
        """CoG beyond the edge x = 1: the free axis is that edge, turned towards +x (about +y)."""
        points = [*FLOOR, (1.9, 0.0, -0.5)]
        first = run(Scene(block(cog=(1.5, 0, 0)), Cage(points), [DOWN])).phases[0].events[0]
        assert first.rule == "A-3"
        assert first.hit == ("C5",)
        assert_allclose(first.motion.axis_world, (0, 1, 0), atol=1e-15)

    def test_a_turn_that_the_load_hardly_drives_does_not_count(self):
        """The CoG 1e-4 beyond the edge: the moment is below 1e-3 of force times distance, so the block stays."""
        assert rules(run(Scene(block(cog=(1.0001, 0, 0)), Cage(FLOOR), [DOWN]))) == ["A-4"]
        assert rules(run(Scene(block(cog=(1.01, 0, 0)), Cage(FLOOR), [DOWN])))[0] == "A-3"

    def test_an_axis_is_blocked_if_contact_comes_within_a_ten_thousandth_of_pi(self):
        """A point beyond the tipping edge, below the face by angle times distance: 0.9 blocks, 1.1 does not."""
        delta = math.pi / 10000.0
        for fraction, n_events, note in ((0.9, 1, "small turn"), (1.1, 2, None)):
            low = (1.9, 0.0, -0.9 * math.tan(fraction * delta))
            result = run(Scene(block(cog=(1.5, 0, 0)), Cage([*FLOOR, low]), [DOWN]))
            assert len(result.phases[0].events) == n_events
            assert result.verdict == "stable"
            assert result.phases[0].events[0].note == note
            assert any("less than 0.018 deg" in warning for warning in result.warnings) == (note is not None)


class TestPush:
    def test_r4_a_steep_push_onto_one_point_turns_about_it(self):
        """Normal along the push: no-slip. The push passes on the right of the point, so B-2 turns to the left."""
        scene = Scene(block(), Cage([(2, 0.5, 1), (9, 9, 9), (-9, 9, 9)]), [push((1, 0, 0), (-2, 0, 0))])
        first = run(scene).phases[0].events[0]
        assert first.rule == "B-2"
        assert_allclose(first.motion.axis_world, (0, 0, 1), atol=1e-15)

    def test_r4_a_point_on_an_edge_counts_by_the_face_that_meets_the_push(self):
        """On the edge of the right face and the bottom: the right face is steep (no-slip), the bottom would slip."""
        first = run(Scene(block(), Cage([(2, 0, 0), (9, 9, 9), (-9, 9, 9)]), [push((1, 0, 0), (-2, 0, 0))])).phases[0]
        assert first.events[0].rule == "B-2"
        assert_allclose(first.events[0].motion.axis_world, (0, 1, 0), atol=1e-15)

    def test_r4_faces_that_meet_the_push_at_the_same_angle_are_a_tie_decided_alike_in_every_frame(self):
        """Pushed at 45 deg to both faces of an edge that touches: which face counts must not hang on the last bit."""
        points = [(2, -5, -5), (-3, 1, -5), (9, 0, 0), (-9, 0, 0), (0, 9, 0), (0, 0, 9)]
        rng = np.random.default_rng(8)
        logs = set()
        for _ in range(40):
            frame = Pose(rng.uniform(-9, 9, 3), rng.normal(size=4))
            held = Object([Box((10, 10, 10))], (0, 0, 0), pose=frame)
            load = push(frame.rotation @ (0.0, -1.0, -1.0), (1, 0, 3))
            result = run(Scene(held, Cage(points, pose=frame), [load]))
            logs.add(tuple((event.rule, event.hit, event.note) for event in result.phases[0].events))
        (log,) = logs
        assert log[0][2] == "edge tie"
        assert any("(R4)" in warning for warning in result.warnings)

    def test_r6_one_face_slides_round_the_farthest_contact(self):
        """Two points below, pushed sideways at one end: Slp-1 turns about the contact farthest from the push."""
        cage = Cage([(1, 0, 0), (-1.5, 0, 0), (1.0, -2.3, 1.0)])
        first = run(Scene(block(), cage, [push((0, -1, 0), (2, 0, 0))])).phases[0].events[0]
        assert first.rule == "Slp-1"
        assert_allclose(first.motion.through_world, (-1.5, 0, 0), atol=1e-15)
        assert_allclose(np.abs(first.motion.axis_world), (0, 0, 1), atol=1e-15)
        assert first.hit == ("C3",)

    def test_r7_two_faces_slide_along_their_common_line(self):
        """Points below and beside: Slp-2 travels along x, the only direction across both normals, with the push."""
        cage = Cage([(1, 0, 0), (-1, 0, 0), (0, 2, 1), (5, 0, 1)])
        first = run(Scene(block(), cage, [push((1, 0.5, -0.5), (0, 0, 0))])).phases[0].events[0]
        assert first.rule == "Slp-2"
        assert_allclose(first.motion.direction_world, (1, 0, 0), atol=1e-15)
        assert first.motion.distance_m == pytest.approx(3.0, rel=1e-14)

    def test_r8_contacts_that_the_push_leaves_do_not_hold(self):
        """Pushed away from the only point it touches, the block travels with the push."""
        cage = Cage([(-2, 0, 1), (5, 0, 1), (0, 9, 9)])
        first = run(Scene(block(), cage, [push((1, 0, 0), (0, 0, 0))])).phases[0].events[0]
        assert (first.rule, first.hit) == ("B-1", ("C2",))
        assert first.motion.distance_m == pytest.approx(3.0, rel=1e-14)

    @pytest.mark.parametrize(("band_deg", "rule"), [(1.0, "Slp-1"), (0.1, "B-1")])
    def test_r5_the_grazing_band_keeps_contacts_that_are_a_little_steeper_than_a_right_angle(self, band_deg, rule):
        """A push 0.5 deg upward from a floor: within a band of 1 deg the floor still guides it, within 0.1 deg not."""
        direction = (math.cos(math.radians(0.5)), 0.0, math.sin(math.radians(0.5)))
        scene = Scene(
            block(),
            Cage([*FLOOR, (9, 0.5, 1)]),
            [push(direction, (0, -1.5, 0))],
            tolerances=Tolerances(grazing_band_rad=math.radians(band_deg)),
        )
        assert run(scene).phases[0].events[0].rule == rule

    def test_r8_a_contact_taken_for_contactless_that_blocks_at_once_is_one_after_all(self):
        """A stop ahead (no-slip) would be turned about, but a point behind, which the push leaves, blocks that turn.

        Turning left about (2, 0.5), the left face at y = 1.5 moves back into the point there. So both carry: the block
        tips about the line through them, which lies above the push.
        """
        cage = Cage([(2, 0.5, 1), (-2, 1.5, 1), (0, 0, -9)])
        first = run(Scene(block(), cage, [push((1, 0, 0), (-2, 0, -0.5))])).phases[0].events[0]
        along = np.array([4.0, -1.0, 0.0]) / math.sqrt(17.0)
        assert first.rule == "B-3"
        assert_allclose(np.abs(first.motion.axis_world), np.abs(along), atol=1e-15)
        assert first.motion.angle_rad > 0.0

    def test_r8b_gravity_beside_a_force_is_ignored_and_told(self):
        both = Load("both", gravity=(0, 0, -1), force=Force((0, 0, 1), (0, 0, 0)))
        result = run(Scene(block(), Cage([*FLOOR, (0, 0, 4)]), [both]))
        assert result.phases[0].events[0].hit == ("C5",)
        assert any("gravity is ignored" in warning for warning in result.warnings)

    def test_friction_decides_between_turning_and_sliding(self):
        """A push 30 deg off a face's normal slips below mu = tan 30 deg = 0.577 and sticks above."""
        direction = (math.cos(math.radians(30)), math.sin(math.radians(30)), 0.0)
        for mu, rule in ((0.5, "Slp-1"), (0.65, "B-2")):
            cage = Cage([(2, 0, 1), (9, 9, 9), (9, -9, 9)])
            scene = Scene(block(), cage, [push(direction, (-1, 0.4, 0.5))], friction_coefficient=mu)
            assert run(scene).phases[0].events[0].rule == rule


def test_a_point_that_lets_go_and_comes_back_is_hit():
    """Standing on four points, with its weight left of the first two, the block swings half round about these: the
    other two let go and meet the same face again, both at once, 180 deg later.
    """
    points = [(0, 1, 0), (0, -1, 0), (1.5, 1, 0), (1.5, -1, 0)]
    first = run(Scene(block(cog=(-0.5, 0, 0)), Cage(points), [DOWN])).phases[0].events[0]
    assert first.motion.angle_rad == pytest.approx(math.pi, rel=1e-14)
    assert first.hit == ("C3", "C4")


@pytest.mark.parametrize("direction", [(0, 0, 1), (1, 0, 0)])
def test_a_start_pose_a_little_too_deep_may_leave_and_slide(direction):
    """The points start half a touch tolerance inside the floor's face, as a pose drawn by hand may."""
    tolerances = Tolerances(touch=1e-7)
    depth = 0.5e-7 * Scene(block(), Cage(FLOOR), [DOWN]).size_m
    scene = Scene(block(at=(0, 0, 1 - depth)), Cage(FLOOR), [push(direction, (0, 0, 0))], tolerances=tolerances)
    first = run(scene).phases[0].events[0]
    assert first.motion is not None
    assert max(first.motion.distance_m, first.motion.angle_rad) > 0.1


@pytest.mark.parametrize("length", [1e-200, 1e155, 9.81])
def test_the_length_of_gravity_does_not_matter(length):
    result = run(Scene(block(at=(0, 0, 3)), Cage(FLOOR), [Load("gravity", gravity=(0, 0, -length))]))
    assert rules(result) == ["A-1", "A-4"]


def test_where_the_object_was_drawn_does_not_matter(cases):
    """The same part drawn 1000 sizes from its own origin; a cycle may take one more round to be told from rounding."""
    for scene in drawn_scenes("union", cases(30, 100), seed=17):
        held, shift = scene.object, 1000.0 * scene.size_m * np.array([0.6, -0.64, 0.48])
        moved = Object(
            [
                Box(b.size_m, Pose(b.pose_object_box.position_m + shift, b.pose_object_box.quaternion_wxyz))
                for b in held.boxes
            ],
            held.center_of_gravity_m + shift,
            pose=held.pose_world_object @ Pose(-shift),
        )
        loads = [
            load
            if load.force is None
            else Load(load.name, force=Force(load.force.direction, load.force.at_object_m + shift))
            for load in scene.loads
        ]
        found, expected = run(Scene(moved, scene.cage, loads)), run(scene)
        assert found.verdict == expected.verdict
        if expected.verdict != "cycling":
            phases = range(len(expected.phases))
            assert [rules(found, i) for i in phases] == [rules(expected, i) for i in phases]


class TestFailuresHaveNames:
    def test_a_pendulum_spins(self):
        """Nothing stops the turn about one point: a full turn without contact, never a rest."""
        result = run(Scene(block(at=(0.5, 0, 1)), Cage([(0, 0, 0), (50, 0, 0), (50, 1, 0)]), [DOWN]))
        assert result.verdict == "spins"
        assert result.failed
        assert math.degrees(result.phases[0].events[-1].motion.angle_rad) == pytest.approx(360.0)

    def test_a_swing_between_two_poses_is_cycling_not_rest(self):
        """A plate hung over one rod, with a stop on either side of its lowest place: the rules swing it for ever."""
        plate = Object([Box((0.5, 4, 6)), Box((4, 4, 0.5), Pose((0, 0, 3.25)))], (0, 0, -1.0), pose=Pose((0, 0, -3.0)))
        rods = [(1.0, 1.5, 0.0), (1.0, -1.5, 0.0), (-1.2, 0, -5.0), (1.2, 0.0, -5.0), (-2.5, 0, 0.2)]
        result = run(Scene(plate, Cage(rods), [DOWN]))
        assert result.verdict == "cycling"
        assert result.failed

    def test_a_failed_phase_is_the_last_one_run(self):
        scene = Scene(block(at=(0, 0, -5)), Cage(FLOOR), [DOWN, push((1, 0, 0), (0, 0, 0))])
        result = run(scene)
        assert [phase.name for phase in result.phases] == ["gravity"]


class TestUnions:
    def test_a_point_that_slides_over_a_plate_meets_the_block_that_stands_on_it(self):
        """The point runs exactly in the plane where block and plate meet: the seam is bridged (docs/theory)."""
        lshape = Object([Box((8, 4, 1), Pose((0, 0, -0.5))), Box((1, 4, 2), Pose((-3.5, 0, 1)))], (0, 0, 0))
        cage = Cage([(2, 1, 0), (2, -1, 0), (-1, 0, 0), (0, 2, -0.5)])
        slide = run(Scene(lshape, cage, [push((1, 0.2, 0.2), (0, 0, 0))])).phases[0].events[0]
        assert (slide.rule, slide.hit) == ("Slp-2", ("C3",))
        assert slide.motion.distance_m == pytest.approx(2.0, rel=1e-14)

    @pytest.mark.parametrize("top", [[(0, 0, 1)], [(-1, 0, 1), (1, 0, 1)]])
    def test_a_point_does_not_run_along_the_line_where_three_or_four_blocks_meet(self, top):
        """Two blocks side by side with one across their seam, or two more on top: a point on the line x = z = 0."""
        boxes = [Box((2, 4, 2), Pose((-1, 0, -1))), Box((2, 4, 2), Pose((1, 0, -1)))]
        boxes += [Box((2, 4, 2), Pose(at)) for at in top]
        travel = (
            run(Scene(Object(boxes), Cage([(0, 5, 0), (9, 9, 9)]), [push((0, 1, 0), (0, 0, 0))])).phases[0].events[0]
        )
        assert travel.hit == ("C1",)
        assert travel.motion.distance_m == pytest.approx(3.0)

    def test_a_point_does_not_fall_into_the_seam_between_two_blocks_side_by_side(self):
        pair = Object([Box((2, 4, 2), Pose((-1, 0, 0))), Box((2, 4, 2), Pose((1, 0, 0)))], pose=Pose((0, 0, 3)))
        result = run(Scene(pair, Cage([(0, 1, 0), (0, -1, 0), (1, 0, 0)]), [DOWN]))
        assert result.phases[0].events[0].motion.distance_m == pytest.approx(2.0)
        assert result.verdict == "stable"
        assert {tuple(contact.normal_world.round(9)) for contact in result.contacts} == {(0.0, 0.0, -1.0)}
