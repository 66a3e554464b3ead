"""Forces, moments and springs in any number, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from audit.balance import imbalance
from cagepose import Box, Cage, Force, Load, Moment, Object, Pose, Run, Scene, Spring, Variation, run, run_many
from quasistatic.paths import path_of
from sprung_scenes import cube, sprung

MM, G = 1e-3, 9.81
FAR = [(0.9, 0.9, 0.9)]
"""A cage that nothing reaches."""
NEST = [(0.021, 0.011, 0.021), (0.0212, -0.012, 0.019), (0.002, 0.0215, 0.02), (-0.003, -0.0215, 0.02)]
"""Stops ahead of a cube of 40 mm and beside it."""
FLOOR = [(x * MM, y * MM, 0.0) for x in (-10, 10) for y in (-10, 10)]


def ended(held: Object, points: list, *loads: Load, friction: float = 0.0) -> Run:
    return run(Scene(held, Cage(points), loads, friction_coefficient=friction))


def forces_of(result: Run) -> dict[str, float]:
    return {contact.point: float(contact.force_normal_n or 0.0) for contact in result.contacts}


def test_a_part_hangs_where_its_springs_carry_its_weight() -> None:
    """Four vertical springs of 1 N/mm: it sinks by m g / (4 k), and touches nothing."""
    springs = [Spring((x, y, 0.02), (x, y, 0.12), 1000.0) for x in (-0.02, 0.02) for y in (-0.02, 0.02)]
    result = ended(cube(mass_kg=2.0), FAR, Load("hang", gravity=(0, 0, -G), springs=springs))
    assert (result.verdict, result.phases[0].proof.stability) == ("rests", "stable")
    assert result.contacts == ()
    assert result.pose.position_m == pytest.approx([0.0, 0.0, -2.0 * G / 4000.0], abs=1e-13)
    assert "nothing touches" in result.phases[0].proof.reason


@pytest.mark.parametrize(("preload_n", "floor_n"), [(0.0, G - 1.5), (3.0, G - 4.5), (-2.0, G + 0.5)])
def test_a_spring_above_a_floor_takes_off_what_it_pulls(preload_n: float, floor_n: float) -> None:
    """The part falls by 3 mm onto the floor; the spring of 0.5 N/mm is then longer by as much."""
    spring = Spring((0, 0, 0.02), (0, 0, 0.2), 500.0, preload_n)
    start = Pose((0.0, 0.0, 0.023))
    result = ended(cube(pose=start), FLOOR, Load("down", gravity=(0, 0, -G), springs=[spring]))
    assert result.verdict == "rests"
    assert result.pose.position_m[2] == pytest.approx(0.02, abs=1e-15)
    assert sum(forces_of(result).values()) == pytest.approx(floor_n, rel=1e-12)


def test_a_spring_that_carries_the_weight_leaves_the_floor_alone() -> None:
    spring = Spring((0, 0, 0.02), (0, 0, 0.2), 500.0, 2.0 * G)
    result = ended(cube(pose=Pose((0.0, 0.0, 0.02))), FLOOR, Load("up", gravity=(0, 0, -G), springs=[spring]))
    assert (result.verdict, result.contacts) == ("rests", ())
    assert result.pose.position_m[2] == pytest.approx(0.02 + G / 500.0, abs=1e-13)


def test_two_springs_along_a_line_hold_a_part_upright_or_do_not() -> None:
    """Two opposite springs with a tension act at points outside of the centre of gravity. Every freedom but the turn
    about their line is stable; pushed together they buckle."""

    def held(preload_n: float) -> Run:
        springs = [Spring((side * 0.02, 0, 0), (side * 0.07, 0, 0), 100.0, preload_n) for side in (-1, 1)]
        return ended(cube(), FAR, Load("between", springs=springs))

    pulled, pushed = held(1.0), held(-1.0)
    assert pulled.verdict == pushed.verdict == "rests"
    assert (pulled.phases[0].proof.stability, pulled.phases[0].proof.undetermined) == ("marginal", ("roll",))
    assert pushed.phases[0].proof.stability == "unstable"


def test_a_pendulum_on_a_spring_hangs_below_its_pivot() -> None:
    """Without stiffness a spring is a rope of constant tension: hung by more than its weight it rises to the pivot, so
    it is held by stiffness: length = start + (m g - preload) / k, and the centre of gravity is below the pivot.
    """
    at, to = np.array([0.0, 0.0, 0.05]), np.array([0.0, 0.0, 0.2])
    held = cube(pose=Pose((0.08, 0.02, 0.0), euler_zyx=(0.3, 0.5, 0.2)))
    result = ended(held, [(0.5, 0.5, 0.5)], Load("hang", gravity=(0, 0, -G), springs=[Spring(at, to, 400.0, 1.0)]))
    start = float(np.linalg.norm(to - held.pose_world_object.transform(at)))
    length = start + (G - 1.0) / 400.0
    assert result.verdict == "rests"
    assert result.center_of_gravity_world == pytest.approx(to - [0.0, 0.0, length + 0.05], abs=1e-10)
    assert (result.phases[0].proof.stability, result.phases[0].proof.undetermined) == ("marginal", ("yaw",))


def test_a_spring_without_stiffness_pulls_along_its_line_with_its_preload() -> None:
    """A cube on a smooth floor is pulled against two stops: they carry the preload, whatever the length."""
    points = [*FLOOR, (0.02, 0.0, 0.02), (-0.0205, 0.0, 0.02)]
    spring = Spring((0, 0, 0), (0.3, 0.4, 0.02), 0.0, 5.0)
    result = ended(cube(pose=Pose((0, 0, 0.02))), [*points, (0.0, 0.021, 0.02)], Load("pull", springs=[spring]))
    way = spring.to_m - result.pose.position_m
    pull = 5.0 * way / np.linalg.norm(way)
    assert result.verdict == "rests"
    carried = sum(-(contact.force_normal_n or 0.0) * contact.normal_world for contact in result.contacts)
    assert carried == pytest.approx(-pull, abs=1e-9)
    assert np.linalg.norm(carried) == pytest.approx(5.0, rel=1e-9)


def test_a_soft_spring_far_away_is_a_constant_force() -> None:
    points = [*FLOOR, *NEST]
    held = cube(pose=Pose((0, 0, 0.022), euler_zyx=(0.01, 0.0, 0.0)))
    at = (0.0, 0.001, 0.002)
    weight = {"gravity": (0, 0, -G)}
    force = ended(held, points, Load("push", **weight, force=Force((1, 0, 0), at, 3.0)))
    reach_m = 1e7
    start = held.pose_world_object.transform(at)
    spring = Spring(at, start + np.array([reach_m, 0.0, 0.0]), 1e-9, 3.0)
    pulled = ended(held, points, Load("push", **weight, springs=[spring]))
    assert force.verdict == pulled.verdict == "rests"
    assert pulled.pose.position_m == pytest.approx(force.pose.position_m, abs=1e-9)
    assert forces_of(pulled) == pytest.approx(forces_of(force), abs=1e-6)


def test_parallel_forces_are_their_resultant() -> None:
    points = [*FLOOR, *NEST]
    held = cube(pose=Pose((0, 0, 0.022), euler_zyx=(0.01, 0.0, 0.0)))
    two = [Force((1, 0, 0), (0, 0.006, 0.001), 2.0), Force((1, 0, 0), (0, -0.003, 0.004), 1.0)]
    one = Force((1, 0, 0), (0, 0.003, 0.002), 3.0)
    several = ended(held, points, Load("push", gravity=(0, 0, -G), forces=two))
    single = ended(held, points, Load("push", gravity=(0, 0, -G), force=one))
    assert several.verdict == single.verdict == "rests"
    for mine, other in zip(path_of(several.phases[0]), path_of(single.phases[0]), strict=True):
        assert mine.position_m == pytest.approx(other.position_m, abs=1e-12)
        assert mine.quaternion_wxyz == pytest.approx(other.quaternion_wxyz, abs=1e-12)


def test_a_dead_couple_turns_a_part_until_its_forces_are_in_line_and_a_moment_for_ever() -> None:
    """Two opposite dead forces are a pendulum: no moment is left where their line passes both points. A moment of the
    same size never ceases.
    """
    couple = [Force((0, 1, 0), (0.01, 0, 0), 1.0), Force((0, -1, 0), (-0.01, 0, 0), 1.0)]
    turned = ended(cube(), FAR, Load("turn", forces=couple))
    assert turned.verdict == "rests"
    assert turned.pose.euler_zyx == pytest.approx([np.pi / 2.0, 0.0, 0.0], abs=1e-10)
    for follows in (False, True):
        driven = ended(cube(), FAR, Load("turn", moments=[Moment((0, 0, 1), 0.02, follows=follows)]))
        assert (driven.verdict, driven.failed) == ("limit", True)
        assert any("moments, and forces that follow" in warning for warning in driven.warnings)
    following = [Force(force.direction, force.at_object_m, 1.0, follows=True) for force in couple]
    assert ended(cube(), FAR, Load("turn", forces=following)).verdict == "limit"


@pytest.mark.parametrize("follows", [False, True])
def test_a_moment_turns_a_bar_between_stops_by_the_angle_of_their_play(follows: bool) -> None:
    """Pins at x = +-l, a gap above the bar's upper and below its lower face: sin t = gap cos t + ..., so that
    l sin t + h cos t = h + gap, h the half height. The pins carry M / (2 l cos t + 2 h sin t) ... as statics says.
    """
    half, gap, reach, moment = 0.005, 0.0002, 0.05, 0.3
    bar = Object([Box((0.12, 0.02, 2.0 * half))])
    pins = [(reach, y, half + gap) for y in (-0.005, 0.005)] + [(-reach, y, -half - gap) for y in (-0.005, 0.005)]
    result = ended(bar, pins, Load("turn", moments=[Moment((0, -1, 0), moment, follows=follows)]))
    angle = -result.pose.euler_zyx[1]
    assert result.verdict == "rests"
    # The upper face passes through (reach, half + gap): half = (half + gap) cos t - reach sin t.
    assert (half + gap) * np.cos(angle) - reach * np.sin(angle) == pytest.approx(half, abs=1e-15)
    along = reach * np.cos(angle) + (half + gap) * np.sin(angle)  # of a pin, along the bar
    assert sum(forces_of(result).values()) == pytest.approx(moment / along, rel=1e-9)
    assert "y" in result.phases[0].proof.undetermined or result.phases[0].proof.stability == "not shown"


@pytest.mark.parametrize("follows", [False, True])
def test_a_force_that_follows_presses_with_all_of_it(follows: bool) -> None:
    """A bar turns its end flush against two stops that stand askew by atan 0.01. A force along it is then along the
    normal, if it follows; else a part of it pushes the bar aside, against the pins there.
    """
    bar = Object([Box((0.1, 0.02, 0.02))])
    points = [
        (0.055, 0.005, 0.0),
        (0.0551, -0.005, 0.0),
        *[(x, y, 0.0) for x in (-0.02, 0.02) for y in (-0.013, 0.013)],
    ]
    result = ended(bar, points, Load("push", force=Force((1, 0, 0), (0, 0, 0), 2.0, follows=follows)))
    yaw, found = result.pose.euler_zyx[0], forces_of(result)
    assert (result.verdict, yaw) == ("rests", pytest.approx(np.arctan(0.01), abs=1e-12))
    assert found["C1"] + found["C2"] == pytest.approx(2.0 if follows else 2.0 * np.cos(yaw), rel=1e-12)
    aside = sum(force for name, force in found.items() if name not in ("C1", "C2"))
    assert aside == pytest.approx(0.0 if follows else 2.0 * np.sin(yaw), abs=1e-12)


def test_a_following_force_on_one_pin_is_in_balance_but_not_shown_to_be_stable() -> None:
    """A cube that pushes itself against a pin ahead of its centre of gravity can turn and slide along the pin: each
    changes what the other does, which no potential has.
    """
    points = [(0.03, 0.0, 0.0), (0.0, 0.03, 0.0), (0.0, -0.03, 0.0)]
    result = ended(cube(), points, Load("push", force=Force((1, 0, 0), (0, 0, 0), 1.0, follows=True)))
    phase = result.phases[0]
    assert (result.verdict, phase.proof.stability, phase.proof.undetermined) == ("rests", "not shown", ())
    assert any("was not shown" in warning for warning in result.warnings)
    assert imbalance(result.scene, phase) < 1e-10


def test_what_flies_away_has_escaped_and_what_a_spring_pulls_back_has_not() -> None:
    ahead = [(0.1, 0.0, 0.0), (0.0, 0.05, 0.0), (0.0, -0.05, 0.0)]
    away = Load("jet", force=Force((-1, 0, 0), (0, 1e-5, 0), 1.0, follows=True))
    assert ended(cube(), ahead, away).verdict == "escapes"
    jet = Force((-1, 0, 0), (0, 5e-3, 0), 1.0, follows=True)
    assert ended(cube(), ahead, Load("jet", force=jet)).verdict == "limit"  # round and round
    falls = Load("jet", gravity=(0, 0, -G), forces=[jet])
    above = [(0.05, 0.05, 0.1), (-0.05, 0.05, 0.1)]
    helix = ended(cube(), above, falls)
    assert (helix.verdict, len(path_of(helix.phases[0]))) == ("escapes", 5)  # not ten sizes away
    on_the_way = ended(cube(), [*above, (0.01, 0.0, -0.1)], falls)
    assert on_the_way.phases[0].events[0].hit == ("C3",)
    bent = Load("jet", forces=[jet, Force((0, 0, -1), (0.001, 0, 0), 1.0)])  # tumbles
    assert ended(cube(), above, bent).verdict in ("escapes", "limit")
    bound = Load("jet", forces=[Force((-1, 0, 0), (0, 0, 0), 1.0)], springs=[Spring((0, 0, 0), (0.1, 0, 0), 1e-3)])
    result = ended(cube(), ahead, bound)
    assert result.verdict == "rests"  # a kilometre away
    assert result.pose.position_m[0] == pytest.approx(-1000.0, rel=1e-9)
    pushed = Load("off", springs=[Spring((0, 0, 0), (0.05, 0, 0), 0.0, -1.0)])
    assert ended(cube(), ahead, pushed).verdict == "escapes"


def test_a_constant_pull_that_has_come_home_is_no_rest_and_says_so() -> None:
    reel = Load("reel", springs=[Spring((0, 0, 0.02), (0, 0.1, 0.02), 0.0, 1.0)])
    result = ended(cube(), [(0.2, 0.0, 0.0), (-0.2, 0.1, 0.0)], reel)
    assert result.failed
    assert any("ends of" in warning for warning in result.warnings)


def test_a_spring_is_as_long_in_each_phase_as_since_the_start() -> None:
    """The part falls by 3 mm in the first phase; the second has a spring of 0.5 N/mm, with 1 N at the start."""
    spring = Spring((0, 0, 0.02), (0, 0, 0.2), 500.0, 1.0)
    falls, pulls = Load("falls", gravity=(0, 0, -G)), Load("pulls", gravity=(0, 0, -G), springs=[spring])
    result = ended(cube(pose=Pose((0.0, 0.0, 0.023))), FLOOR, falls, pulls)
    assert result.verdict == "rests"
    assert sum(forces_of(result).values()) == pytest.approx(G - 2.5, rel=1e-12)


@pytest.mark.parametrize("turned", [False, True])
def test_the_world_has_no_place_of_its_own(turned: bool) -> None:
    """Cage, object, springs, forces and moments moved and turned together end moved and turned together."""
    random = np.random.default_rng(12)
    frame = Pose((30.0, -20.0, 10.0), euler_zyx=(0.7, -0.4, 1.9))
    for _ in range(5):
        scene = sprung(random, turned=turned)
        load = scene.loads[0]
        here = Load(
            "all",
            gravity=frame.rotation @ (0.0, 0.0, -G),
            forces=[
                force
                if force.follows
                else Force(frame.rotation @ force.direction, force.at_object_m, force.magnitude_n)
                for force in load.forces
            ],
            moments=[
                moment if moment.follows else Moment(frame.rotation @ moment.direction, moment.magnitude_nm)
                for moment in load.moments
            ],
            springs=[
                Spring(spring.at_object_m, frame.transform(spring.to_m), spring.stiffness_n_per_m, spring.preload_n)
                for spring in load.springs
            ],
        )
        there = run(Scene(cube(pose=frame), Cage(scene.cage.points_cage, pose=frame), [here]))
        back = frame.inverse() @ there.pose
        result = run(scene)
        assert there.verdict == result.verdict
        assert back.position_m == pytest.approx(result.pose.position_m, abs=1e-11)
        assert back.rotation == pytest.approx(result.pose.rotation, abs=1e-9)


def test_rows_of_a_batch_have_the_bits_of_runs() -> None:
    """Also where start and cage vary, and with them the springs' length at the start and the middle of the cage."""
    random = np.random.default_rng(4)
    scene = sprung(random, friction=0.1)
    start = scene.object.pose_world_object
    positions = start.position_m + 1e-3 * random.uniform(-1, 1, (6, 3))
    turns = 0.01 * random.uniform(-1, 1, (6, 3))
    cages, tilts = 1e-4 * random.uniform(-1, 1, (6, 3)), 0.01 * random.uniform(-1, 1, (6, 3))
    rows = run_many(
        scene,
        Variation(object_position_m=positions, object_euler_zyx=turns, cage_position_m=cages, cage_euler_zyx=tilts),
    )
    for row in range(6):
        held = scene.object
        placed = Object(
            held.boxes, held.center_of_gravity_m, pose=Pose(positions[row], euler_zyx=turns[row]), mass_kg=1.0
        )
        cage = Cage(scene.cage.points_cage, pose=Pose(cages[row], euler_zyx=tilts[row]))
        single = run(Scene(placed, cage, scene.loads, friction_coefficient=0.1))
        assert rows.verdict[row] == single.verdict
        assert np.array_equal(rows.position_m[row, 0], single.pose.position_m)
        assert np.array_equal(rows.quaternion_wxyz[row, 0], single.pose.quaternion_wxyz)
