"""Verdicts and their proof on scenes with closed forms: slope, ladder, wedge, V-groove, block between walls, edges.

All lengths in metres.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import linprog

from cagepose import Box, Cage, Convex, Force, Load, Object, Pose, Run, Scene, run, with_critical_friction
from cagepose.runs.judge import critical_friction_at, judge_pose

DOWN = Load("weight", gravity=(0, 0, -1))


def judged(scene: Scene, friction: float, pose: Pose | None = None):
    """The proof, the contacts and the critical friction at a pose (left out: where the scene starts)."""
    pose = scene.object.pose_world_object if pose is None else pose
    proof, contacts = judge_pose(scene, pose, 0, friction)
    return replace(proof, critical_friction=critical_friction_at(scene, pose, 0, 0.0)), contacts


def slope(angle: float, friction: float | None = None, height: float = 0.02) -> Scene:
    """A block on three points of a plane that is steeper by ``angle`` in x; it starts on them."""
    turned = Pose((0, 0, 0), euler_zyx=(0, angle, 0))
    points = np.array([(0.04, -0.03, 0), (0.04, 0.03, 0), (-0.05, 0.0, 0)])
    held = Object([Box((0.2, 0.1, height))], pose=turned @ Pose((0, 0, height / 2)))
    return Scene(held, Cage(points, pose=turned), [DOWN], friction_coefficient=friction)


class TestSlope:
    @pytest.mark.parametrize("angle_deg", [1, 10, 30, 45])
    def test_the_critical_friction_is_the_tangent_of_the_angle(self, angle_deg):
        proof, _ = judged(slope(math.radians(angle_deg)), 0.0)
        assert proof.critical_friction == pytest.approx(math.tan(math.radians(angle_deg)), rel=1e-9)

    def test_a_tall_block_tips_at_any_friction(self):
        """The vertical through the centre leaves the triangle of the points: 0.2 tan 30 deg = 0.115 > 0.04."""
        proof, _ = judged(slope(math.radians(30), height=0.4), 100.0)
        assert proof.verdict == "moves"
        assert proof.critical_friction == math.inf

    @pytest.mark.parametrize(("factor", "verdicts"), [(1 - 1e-7, ("moves",)), (1 + 1e-7, ("rests", "may rest"))])
    def test_the_limit_is_sharp(self, factor, verdicts):
        angle = math.radians(20)
        proof, contacts = judged(slope(angle), factor * math.tan(angle))
        assert proof.verdict in verdicts
        if proof.verdict != "moves":
            assert_balanced(contacts, slope(angle), np.array([0, 0, -1.0]), factor * math.tan(angle))

    def test_below_the_limit_it_slides_down_the_slope(self):
        angle = math.radians(20)
        proof, _ = judged(slope(angle), 0.999 * math.tan(angle))
        assert (proof.verdict, proof.motion.kind) == ("moves", "travel")
        assert proof.motion.direction_world == pytest.approx((math.cos(angle), 0, -math.sin(angle)), abs=1e-9)

    def test_above_the_limit_rest_is_the_only_onset(self):
        angle = math.radians(20)
        proof, _ = judged(slope(angle), 1.001 * math.tan(angle))
        assert (proof.verdict, proof.needs_friction) == ("rests", True)

    def test_on_a_level_plane_three_freedoms_stay_open(self):
        proof, contacts = judged(slope(0.0), 0.0)
        assert (proof.verdict, proof.stability, proof.undetermined) == ("rests", "marginal", ("x", "y", "yaw"))
        assert not proof.shared
        assert sum(contact.force_normal_n for contact in contacts) == pytest.approx(1.0, abs=1e-12)

    def test_with_friction_nothing_stays_open(self):
        proof, _ = judged(slope(0.0), 0.3)
        assert (proof.verdict, proof.stability, proof.undetermined) == ("rests", "stable", ())


class TestSizes:
    """Gap work and largest force, in parts of the load whatever its unit."""

    @pytest.mark.parametrize(("mass", "gravity"), [(None, 1.0), (3.0, 9.81)])
    def test_a_block_that_hovers_within_the_tolerance_could_fall_as_far(self, mass, gravity):
        points = [(0.04, 0.03, 0), (-0.04, 0.03, 0), (-0.04, -0.03, 0), (0.04, -0.03, 0)]
        scene = Scene(Object([Box((0.1, 0.08, 0.04))], pose=Pose((0, 0, 0.02)), mass_kg=mass), Cage(points),
                      [Load("weight", gravity=(0, 0, -gravity))])  # fmt: skip
        gap = 0.4 * scene.touch_m
        proof, contacts = judge_pose(scene, Pose((0, 0, 0.02 + gap)), 0, 0.0)
        assert proof.gap_work == pytest.approx(gap / scene.size_m, rel=1e-6)
        total = 1.0 if mass is None else mass * gravity
        assert proof.largest_force * total == pytest.approx(max(contact.force_normal_n for contact in contacts))
        assert judge_pose(scene, Pose((0, 0, 0.02)), 0, 0.0)[0].gap_work == pytest.approx(0.0, abs=1e-15)

    def test_the_load_does_no_more_work_than_that_in_any_motion_that_keeps_points_out(self):
        """By duality, and a linear program: how far the load falls if a block sinks and tips onto uneven points."""
        places = np.array([(0.04, 0.03), (-0.04, 0.03), (0.0, -0.035), (0.01, -0.01), (0.03, 0.0)])
        gaps = np.array([0.9, 0.2, 0.6, 0.8, 0.5])  # in touch tolerances
        block = Object([Box((0.1, 0.08, 0.04))], pose=Pose((0, 0, 0.02)))
        touch_m = Scene(block, Cage(np.c_[places, np.zeros(5)]), [DOWN]).touch_m
        scene = Scene(block, Cage(np.c_[places, -gaps * touch_m]), [DOWN])
        proof, contacts = judge_pose(scene, Pose((0, 0, 0.02)), 0, 0.0)
        assert (proof.verdict, len(contacts)) == ("rests", 5)
        sinks = np.c_[np.ones(5), places]  # a fall of 1 and two tilts of the bottom lower it by that at each point
        most = -linprog([-1.0, 0.0, 0.0], sinks, gaps, bounds=(None, None)).fun * touch_m
        assert 0.0 < most <= proof.gap_work * scene.size_m * (1 + 1e-6)

    def test_a_ladder_that_needs_its_friction_presses_as_statics_say(self):
        proof, contacts = judged(ladder(math.radians(60)), 0.4)
        sizes = [math.hypot(contact.force_normal_n, *contact.force_tangential_n) for contact in contacts]
        assert proof.largest_force == pytest.approx(max(sizes))

    def test_what_moves_has_none(self):
        proof, _ = judged(slope(math.radians(30)), 0.1)
        assert (proof.verdict, proof.gap_work, proof.largest_force, proof.uniqueness) == ("moves", None, None, None)


def assert_balanced(contacts, scene: Scene, force: np.ndarray, friction: float, pose: Pose | None = None) -> None:
    """The listed forces and the load sum to zero, moments about the centre of gravity too, inside the cones."""
    pose = scene.object.pose_world_object if pose is None else pose
    center = pose.transform(scene.object.center_of_gravity_m)
    points = dict(zip(scene.cage.names, scene.cage.points_world(), strict=True))
    total, moment = np.array(force, dtype=float), np.zeros(3)
    for contact in contacts:
        acting = contact.force_tangential_n - contact.force_normal_n * contact.normal_world
        assert contact.force_normal_n >= 0.0
        assert np.linalg.norm(contact.force_tangential_n) <= friction * contact.force_normal_n * (1 + 1e-9) + 1e-15
        total += acting
        moment += np.cross(points[contact.point] - center, acting)
    assert np.abs(total).max() < 1e-9
    assert np.abs(moment).max() < 1e-9 * scene.size_m


def ladder(angle: float, fraction: float = 0.5) -> Scene:
    """A rod of length 1 in the xz plane, foot box on the floor (face down), head box against the wall (face +x).

    Foot and head are small boxes with level and upright faces, so that the normals are those of floor and wall; each
    touches two points beside the plane. A smooth wall is a head that is pushed: here it is none, and the test uses the
    closed form for two rough ends only.
    """
    foot, head = np.zeros(3), np.array([math.cos(angle), 0.0, math.sin(angle)])
    boxes = [
        Box((0.02, 0.2, 0.02), Pose(foot), "foot"),
        Box((0.02, 0.2, 0.02), Pose(head), "head"),
    ]
    points = [(0.0, y, -0.01) for y in (-0.05, 0.05)] + [(head[0] + 0.01, y, head[2]) for y in (-0.05, 0.05)]
    cog = foot + fraction * (head - foot)
    return Scene(Object(boxes, cog), Cage(points), [DOWN])


@pytest.mark.parametrize("angle_deg", [30, 45, 60, 75])
def test_a_ladder_with_two_rough_ends_needs_tan_of_half_the_angle_from_upright(angle_deg):
    """Force N, mu N at the foot (up, +x) and W, mu W at the head (-x, up): mu N = W, N + mu W = 1, so
    N = 1 / (1 + mu^2). The points lie at (0, -h) and (c + h, s) with h = 0.01, the centre at (c / 2, s / 2).
    Moments about the head's point: N (c + h) - mu N (s + h) = (c / 2 + h), which gives a quadratic in mu; for h = 0
    its root is tan(45 deg - t / 2).
    """
    t = math.radians(angle_deg)
    c, s, h = math.cos(t), math.sin(t), 0.01
    # (c + h) - mu (s + h) = (c / 2 + h) (1 + mu^2)
    a, b, k = c / 2 + h, s + h, -(c / 2)
    expected = (-b + math.sqrt(b * b - 4 * a * k)) / (2 * a)
    proof, _ = judged(ladder(t), 0.0)
    assert proof.critical_friction == pytest.approx(expected, rel=1e-9)
    assert expected == pytest.approx(math.tan(math.pi / 4 - t / 2), rel=0.05)


def wedge(offset: float, friction: float) -> Scene:
    """A block 0.02 across between two points, ``offset`` apart along its faces; gravity along the faces."""
    points = [(-0.01, 0.0, -offset / 2), (0.01, 0.0, offset / 2)]
    return Scene(Object([Box((0.02, 0.1, 0.1))]), Cage(points), [DOWN], friction_coefficient=friction)


@pytest.mark.parametrize("offset", [0.002, 0.008])
def test_two_points_wedge_a_block_from_friction_d_over_w_on(offset):
    """w = 0.02. Force lines at the friction angle meet the line between the points iff mu >= d / w."""
    limit = offset / 0.02
    below, _ = judged(wedge(offset, 0.0), limit * (1 - 1e-7))
    above, _ = judged(wedge(offset, 0.0), limit * (1 + 1e-7))
    assert below.verdict == "moves"
    assert above.verdict == "may rest"
    assert "press against each other" in above.reason
    assert above.motion.kind == "travel"  # it may as well fall, the faces sliding without force
    assert above.motion.direction_world == pytest.approx((0, 0, -1), abs=1e-6)


def groove(half_spacing: float, reach: float, friction: float | None = None) -> Scene:
    """A square bar on its edge between pairs of points ``2 half_spacing`` apart; centre ``reach`` above its edge.

    Edges along y. The lower edge is at z = -reach from the centre; faces at 45 deg touch the points where they are
    ``half_spacing`` from the middle: the edge lies ``half_spacing`` below the points.
    """
    side = reach * math.sqrt(2.0)
    bar = Box((side, 0.2, side), Pose(euler_zyx=(0, math.pi / 4, 0)))
    points = [(sign * half_spacing, y, 0.0) for sign in (-1, 1) for y in (-0.05, 0.05)]
    held = Object([bar], pose=Pose((0.0, 0.0, reach - half_spacing)))
    return Scene(held, Cage(points), [DOWN], friction_coefficient=friction)


class TestGroove:
    @pytest.mark.parametrize("friction", [0.0, 0.01, 0.3, 1.0])
    def test_it_rests_at_any_friction(self, friction):
        scene = groove(0.01, 0.025)
        proof, contacts = judged(scene, friction)
        assert proof.verdict == "rests"
        assert not proof.needs_friction
        assert_balanced(contacts, scene, np.array([0, 0, -1.0]), friction)

    @pytest.mark.parametrize(("factor", "stability"), [(1 - 1e-6, "marginal"), (1 + 1e-6, "unstable")])
    def test_without_friction_it_is_stable_while_the_centre_is_low(self, factor, stability):
        """Points s = 2 half_spacing apart: turned by t, the edge moves on a circle (Thales) and the centre's height is
        L cos t - half_spacing cos 2 t: stable iff L < 4 half_spacing = 2 s. (It slides along y freely: marginal.)
        """
        proof, _ = judged(groove(0.01, 0.04 * factor), 0.0)
        assert proof.stability == stability
        assert proof.undetermined == ("y",)

    def test_stops_along_the_edge_make_it_stable(self):
        scene = groove(0.01, 0.025)
        ends = [(0.0, sign * 0.1, 0.01) for sign in (-1, 1)]
        points = np.concatenate([scene.cage.points_world(), ends])
        proof, _ = judged(Scene(scene.object, Cage(points), [DOWN]), 0.0)
        assert (proof.verdict, proof.stability, proof.undetermined) == ("rests", "stable", ())


def test_a_block_on_its_floor_rests_between_two_walls_though_they_could_wedge_it():
    points = [(0.01, 0.01, 0), (0.01, -0.01, 0), (-0.02, 0.0, 0), (0.05, 0, 0.01), (-0.05, 0, 0.01)]
    scene = Scene(Object([Box((0.1, 0.1, 0.02))], pose=Pose((0, 0, 0.01))), Cage(points), [DOWN])
    proof, _ = judged(scene, 0.8)
    assert (proof.verdict, proof.needs_friction) == ("rests", False)


def test_a_box_on_one_point_under_its_centre_rests_unstably():
    scene = Scene(Object([Box((0.1, 0.1, 0.02))], pose=Pose((0, 0, 0.01))), Cage([(0, 0, 0)]), [DOWN])
    result = run(scene, method="quasistatic")
    assert (result.verdict, result.phases[0].proof.stability) == ("rests", "unstable")
    assert any("unstable" in warning for warning in result.warnings)


@pytest.mark.parametrize(
    ("cog_mm", "stability"), [(9.0, "marginal"), (12.0, "not shown"), (14.1, "not shown"), (14.2, "unstable")]
)
def test_unstable_is_what_no_balance_of_the_same_contacts_stops(cog_mm, stability):
    """A bar with three flats, each 10 mm from its axis, on points below and on both sides. A turn t lifts it by
    (10 sqrt 2 - cog) t^2 / 2 where the sides carry all of it, and by (10 - cog) t^2 / 2 where those below do. Along its
    axis it is free.
    """
    near, side = 10.0 * (math.sqrt(2.0) - 1.0), math.sqrt(50.0)
    corners = [
        (x, y, z) for y in (-20.0, 20.0) for x, z in ((near, -10), (-near, -10), (30 + near, 20), (-30 - near, 20))
    ]
    points = [(x, y, z) for y in (-15.0, 15.0) for x, z in ((0, -10), (side, -side), (-side, -side))]
    bar = Object(shapes=[Convex(np.array(corners) * 1e-3)], center_of_gravity_m=(0, 0, cog_mm * 1e-3))
    proof, _ = judged(Scene(bar, Cage(np.array(points) * 1e-3), [DOWN]), 0.0)
    assert (proof.verdict, proof.stability) == ("rests", stability)


def test_an_object_that_hangs_from_a_sticking_point_is_stable():
    """The lid of an upside-down cup stands on a point inside; its centre is below the point."""
    lid, skirt = Box((0.1, 0.1, 0.01), Pose((0, 0, 0.1))), Box((0.01, 0.1, 0.2), Pose((0.045, 0, 0.0)))
    other = Box((0.01, 0.1, 0.2), Pose((-0.045, 0, 0.0)))
    scene = Scene(Object([lid, skirt, other]), Cage([(0.0, 0.0, 0.095)]), [DOWN])
    proof, _ = judged(scene, 0.5)
    assert (proof.verdict, proof.stability, proof.undetermined) == ("rests", "marginal", ("yaw",))


def test_four_feet_share_their_load_in_many_ways():
    feet = [(x, y, 0.0) for x in (-0.04, 0.04) for y in (-0.04, 0.04)]
    scene = Scene(Object([Box((0.1, 0.1, 0.02))], pose=Pose((0, 0, 0.01))), Cage(feet), [DOWN])
    proof, contacts = judged(scene, 0.0)
    assert proof.shared == ("C1", "C2", "C3", "C4")
    assert_balanced(contacts, scene, np.array([0, 0, -1.0]), 0.0)
    three, _ = judged(slope(0.0), 0.0)
    assert three.shared == ()


def test_a_point_on_an_edge_holds_only_what_no_way_out_is_left_for():
    """The edge of a block lies on a point; its load presses it down, and it slides off sideways: (2.4)."""
    scene = Scene(
        Object([Box((0.1, 0.1, 0.1))], pose=Pose((0.05, 0, 0.05))),
        Cage([(0.0, 0.0, 0.0)]),
        [Load("push", force=Force((1, 0, -1), (-0.05, 0, -0.05)))],
    )
    proof, _ = judged(scene, 0.0)
    assert proof.verdict == "moves"


def test_newtons_come_out_where_mass_and_magnitude_are_given():
    held = Object([Box((0.2, 0.1, 0.02))], pose=Pose((0, 0, 0.01)), mass_kg=2.0)
    points = [(0.04, -0.03, 0), (0.04, 0.03, 0), (-0.05, 0.0, 0)]
    result = run(Scene(held, Cage(points), [Load("weight", gravity=(0, 0, -9.81))]), method="quasistatic")
    assert sum(contact.force_normal_n for contact in result.contacts) == pytest.approx(19.62, rel=1e-12)


def sample(height: float) -> Scene:
    held = Object([Box((0.01, 0.01, height))], pose=Pose((0.002, 0.004, height / 2 + 0.005)))
    cage = Cage(np.array([(4, 4, 0), (4, -4, 0), (-4, -4, 0), (-4, 4, 0)]) * 1e-3)
    return Scene(held, cage, [DOWN])


@pytest.mark.parametrize(("height", "expected"), [(0.01, 0.4569), (0.02, 0.382), (0.03, 0.793)])
def test_the_samples_pose_after_both_turns_needs_friction(height, expected):
    result = run(sample(height), method="stepwise")
    both_turned = result.phases[0].events[2].pose_world_object
    proof, _ = judged(sample(height), 0.1, both_turned)
    assert proof.verdict == "moves"
    assert proof.critical_friction == pytest.approx(expected, abs=5e-4)


def test_a_stepwise_verdict_is_checked_too():
    result: Run = with_critical_friction(run(sample(0.01), method="stepwise"))
    assert (result.verdict, result.phases[0].proof.verdict) == ("stable", "moves")
    assert result.phases[0].proof.critical_friction == pytest.approx(0.4569, abs=5e-5)
    assert any("contradicts" in warning for warning in result.warnings)


def test_a_balance_that_coulombs_law_does_not_insist_on():
    """Planar: A at (0, 0) under a face (normal down), B at (1, -0.1) beside one (+x), centre (0.1, 0.15), mass 1,
    inertia 0.2, mu = 0.5. Balance: with s = normal force of B, A carries (s, 0.9 - 0.1 s), B 0.1 + 0.1 s up; inside
    the cones for s from 0.25 to 0.4286. But the body may also turn about A: B then opens (it moves to -x), and A's
    force, 0.957 up and 0.065 to the side, lies in its cone. And no forces press without a load: no wedge.
    """
    boxes = [Box((0.2, 0.2, 0.2), Pose((0, 0, 0.1)), "over A"), Box((0.1, 0.1, 0.1), Pose((0.95, 0, -0.1)), "at B")]
    held = Object(boxes, (0.1, 0.0, 0.15), mass_kg=1.0, inertia_kg_m2=np.diag([0.15, 0.2, 0.15]))
    scene = Scene(held, Cage([(0, 0, 0), (1, 0, -0.1)], ["A", "B"]), [DOWN])
    proof, contacts = judged(scene, 0.5)
    assert proof.verdict == "may rest"
    assert "press" not in proof.reason
    assert_balanced(contacts, scene, np.array([0, 0, -1.0]), 0.5)
    assert proof.motion.kind == "turn"
    assert proof.motion.axis_world == pytest.approx((0, 1, 0), abs=1e-9)  # to the right and down
    assert np.cross(proof.motion.through_world, proof.motion.axis_world) == pytest.approx((0, 0, 0), abs=1e-9)


def test_a_board_jammed_between_points_is_marginal():
    """Friction that only the points keep up, each against another, holds it: once they part, it falls."""
    board = Object([Box((0.02, 0.1, 0.1))])
    jam = Cage([(side, y, z) for y in (-0.03, 0.03) for z in (-0.03, 0.03) for side in (-0.01, 0.01)])
    proof = run(Scene(board, jam, [Load("weight", gravity=(0, 0, -1))], friction_coefficient=0.5)).phases[0].proof
    assert (proof.verdict, proof.stability) == ("may rest", "marginal")
    assert "depend on contacts that no load keeps closed" in proof.reason


@pytest.mark.parametrize(("spared", "stability"), [(1e-5, "marginal"), (2e-3, "stable")])
def test_a_rest_that_needs_nearly_all_of_its_friction_is_marginal(spared, stability):
    block = Object([Box((0.1, 0.08, 0.02), Pose((0, 0, 0.01)))])
    feet = Cage([(0.04, 0.03, 0.0), (0.04, -0.03, 0.0), (-0.04, 0.0, 0.0)])
    slope = Load("weight", gravity=(0.3, 0.0, -1.0))
    phase = run(Scene(block, feet, [slope], friction_coefficient=0.3 / (1.0 - spared))).phases[0]
    assert (phase.verdict, phase.proof.stability) == ("rests", stability)


@pytest.mark.parametrize("order", ["ABCD", "BACD", "CDAB", "DCBA", "BCDA"])
def test_a_block_on_a_smooth_foot_is_stable_whatever_the_order(order):
    """Feet that carry nothing in the forces that were found, and do in others, hold by their friction, too."""
    block = Object([Box((0.1, 0.08, 0.02))], mass_kg=1.0, pose=Pose((0, 0, 0.01)))
    feet = {"A": (0.04, 0.03, 0.0), "B": (0.04, -0.03, 0.0), "C": (-0.04, -0.03, 0.0), "D": (-0.04, 0.03, 0.0)}
    cage = Cage([feet[name] for name in order], list(order))
    weight = Load("weight", gravity=(0.0, 0.0, -9.81))
    proof = run(Scene(block, cage, [weight], friction_coefficient=0.2, friction_of={"A": 0.0})).phases[0].proof
    assert (proof.verdict, proof.stability, proof.undetermined) == ("rests", "stable", ())
