"""Ways out in the plane: closed forms, an oracle that samples, and motions that are free."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cagepose import (
    Box,
    Cage,
    CageBody,
    Chamfer,
    Cone,
    Convex,
    Cylinder,
    Facets,
    Hole,
    Load,
    Moment,
    Object,
    Pose,
    Scene,
    SceneError,
    Sphere,
    play,
    run,
)
from cagepose.model.surfaces import Surface
from cagepose.questions.escape import EscapeEnergy, escape_energy
from cagepose.questions.gap import CriticalGap, _bracket, critical_gap
from cagepose.questions.plane_escape import way_out_in_plane
from cagepose.questions.unanswered import Unanswered
from cagepose.studies.plane_cells import Cells, State
from cagepose.studies.plane_frame import InPlane, PlaneFrame
from cagepose.studies.plane_search import Found
from cagepose.studies.plane_thick import thickened
from cagepose.studies.plane_verdict import searched

WEIGHT = Load("weight", gravity=(0.0, 0.0, -9.81))


def letter_h(gap_m: float, thick_m: float = 0.02) -> Scene:
    """An H of bars 10 mm wide, 50 mm by 40 mm, with a finger in each of its notches: as these leave, one is at the
    outer corner of a flange, the other still in the notch, 25 mm below it and 10 mm inward.
    """
    bars = [
        Box((0.03, thick_m, 0.01)),
        Box((0.01, thick_m, 0.04), Pose((-0.02, 0, 0))),
        Box((0.01, thick_m, 0.04), Pose((0.02, 0, 0))),
    ]
    fingers = [(0, 0, gap_m / 2), (0, 0, -gap_m / 2)]
    return Scene(Object(bars, mass_kg=1.0), Cage(fingers), [WEIGHT], planar="xz")


def in_a_well(rim_m: float, shape: Box | Sphere | Cylinder, half_m: float, play_m: float) -> Scene:
    """A part on a floor, between walls that end so high above its middle."""
    height = rim_m + half_m
    walls = [
        Box((0.01, 0.02, height), Pose((side * (half_m + play_m + 0.005), 0, rim_m - height / 2))) for side in (-1, 1)
    ]
    floor = Box((0.08, 0.02, 0.01), Pose((0, 0, -half_m - 0.005)))
    return Scene(Object([], shapes=[shape], mass_kg=2.0), Cage([], shapes=[floor, *walls]), [WEIGHT], planar="xz")


@pytest.mark.parametrize(
    ("gap_mm", "thick_mm", "is_out"), [(22.0, 20.0, False), (22.0, 1.0, False), (30.0, 20.0, True)]
)
def test_an_h_leaves_two_fingers_from_their_diagonal_on(gap_mm: float, thick_mm: float, is_out: bool) -> None:
    """From 26.926 mm on. It is held by large turns alone: of the linearised gaps nothing limits it. How thick it is
    across the plane changes nothing.
    """
    assert math.hypot(25.0, 10.0) == pytest.approx(26.926, abs=1e-3)
    assert way_out_in_plane(letter_h(1e-3 * gap_mm, 1e-3 * thick_mm), 80_000) is is_out


def test_play_in_the_plane_proves_what_the_linearised_gaps_do_not() -> None:
    caged, searched_not = play(letter_h(0.014)), play(letter_h(0.014), search_s=0.0)
    assert (caged.verdict, searched_not.verdict) == ("caged", "not certified")
    assert "every way out in the plane leads through" in caged.cage.reason
    escapes = play(letter_h(0.030))
    assert escapes.verdict == "escapes"
    assert escapes.cage.path


def test_a_roller_leaves_three_pins_that_are_farther_apart_than_it_is_wide() -> None:
    """A disc of radius 10 mm among pins of radius 1 mm: it passes where the middles of two are 22 mm apart."""

    def among(pitch_m: float) -> Scene:
        across = Pose(euler_zyx=(0, 0, math.pi / 2)).quaternion_wxyz
        places = [(pitch_m * math.cos(a), 0, pitch_m * math.sin(a)) for a in np.radians([90.0, 210.0, 330.0])]
        pins = [Cylinder(0.001, 0.02, Pose(place, across)) for place in places]
        disc = Object([], shapes=[Cylinder(0.01, 0.02, Pose((0, 0, 0), across))], mass_kg=1.0)
        return Scene(disc, Cage([], shapes=pins), [WEIGHT], planar="xz")

    assert way_out_in_plane(among(0.88 * 0.022 / math.sqrt(3.0)), 60_000) is False
    assert way_out_in_plane(among(1.12 * 0.022 / math.sqrt(3.0)), 60_000) is True


def test_a_critical_value_is_closed_in_from_both_sides_also_where_it_is_not_found_out() -> None:
    low, high = _bracket(lambda value: value > 1.3, 1.0, 2.0)
    assert (low, high) == (pytest.approx(1.3, abs=2e-4), pytest.approx(1.3, abs=2e-4))
    low, high = _bracket(lambda value: None if 1.25 < value < 1.55 else value > 1.3, 2.0 - 1.0, 2.0)
    assert low is not None
    assert high is not None
    assert 1.25 - 0.5 / 2**5 <= low <= 1.25
    assert 1.55 <= high <= 1.55 + 0.5 / 2**5
    assert _bracket(lambda _: None, 1.0, 2.0) == (None, None)
    assert _bracket(lambda _: False, 1.0, 2.0) == (2.0, None)
    assert _bracket(lambda _: True, 1.0, 2.0) == (None, 1.0)
    with pytest.raises(SceneError, match="the other way round"):
        _bracket(lambda value: value < 1.3, 1.0, 2.0)


def test_a_square_leaves_four_pins_that_are_as_far_apart_as_it_is_wide() -> None:
    def among(side_m: float) -> Scene:
        pins = [(x, 0.0, z) for x in (-0.5 * side_m, 0.5 * side_m) for z in (-0.5 * side_m, 0.5 * side_m)]
        turned = Pose((0, 0, 0), euler_zyx=(0, math.radians(45.0), 0))
        plate = Object([Box((0.02, 0.02, 0.02))], pose=turned, mass_kg=1.0)
        return Scene(plate, Cage(pins), [WEIGHT], planar="xz")

    assert way_out_in_plane(among(0.017), 40_000) is False
    assert way_out_in_plane(among(0.026), 40_000) is True
    found = critical_gap(among, 0.016, 0.026, n_motions=1_000)
    assert isinstance(found, CriticalGap)
    assert (found.caged_at, found.escapes_at, found.n_motions, found.in_plane) == (None, None, 1_000, True)


@pytest.mark.parametrize(
    "shape", [Box((0.02, 0.02, 0.02)), Cylinder(0.01, 0.02, Pose(euler_zyx=(0, 0, math.pi / 2))), Sphere(0.01)]
)
def test_a_part_must_be_raised_over_the_rim_of_its_well(shape: Box | Sphere | Cylinder) -> None:
    """By the rim's height above its middle, and half of its own: less by at most what a block may lean in its play."""
    rim, half, play_m = 0.012, 0.01, 0.001
    found = escape_energy(run(in_a_well(rim, shape, half, play_m)), n_motions=20_000)
    assert isinstance(found, EscapeEnergy)
    assert found.in_plane
    raised = 2.0 * 9.81 * (rim + half)
    assert 0.8 * raised < found.at_least_j <= raised
    assert raised * (1.0 - 2.0 * play_m / (rim + half)) <= found.at_most_j <= 1.2 * raised


def test_the_way_is_free_of_contact_and_no_higher_than_told() -> None:
    scene = in_a_well(0.012, Box((0.02, 0.02, 0.02)), 0.01, 0.001)
    ended = run(scene)
    found = escape_energy(ended, n_motions=15_000)
    assert isinstance(found, EscapeEnergy)
    pose, start, highest = ended.pose, float(ended.pose.position_m[2]), -math.inf
    for step in found.path:
        for share in np.linspace(0.0, 1.0, 25):
            here = step.motion.pose_at(pose, float(share))
            scene.but_for(object=scene.object.starting_at(here))  # raises where the part is in the cage
            highest = max(highest, float(here.position_m[2]))
        pose = step.pose_world_object
        assert pose.position_m == pytest.approx(here.position_m, abs=1e-12)
    assert 2.0 * 9.81 * (highest - start) <= found.at_most_j * (1.0 + 1e-9)
    assert found.top is not None
    assert found.top.position_m[2] == pytest.approx(highest, abs=1e-9)
    assert math.hypot(*pose.position_m) > 0.02


def test_states_of_cells_are_those_of_poses_in_them(cases) -> None:
    """Plates of two boxes and a ball among points and pins."""
    rng, counts = np.random.default_rng(7), dict.fromkeys(State, 0)
    for _ in range(cases(3, 60)):
        parts = [
            Box(rng.uniform(0.005, 0.03, 3), Pose(rng.uniform(-0.01, 0.01, 3), euler_zyx=(0, rng.uniform(-1, 1), 0))),
            Box(rng.uniform(0.005, 0.03, 3), Pose((0, 0, 0))),
            Sphere(0.006, Pose((0.012, 0, 0.004))),
        ]
        pins = [
            Sphere(0.003, Pose((0.05, 0.002, 0.0))),
            Cylinder(0.004, 0.03, Pose((-0.04, 0, 0.01), euler_zyx=(0, 0, math.pi / 2))),
        ]
        planar = ("xz", "xy", "yz")[int(rng.integers(3))]
        held = Object([], shapes=parts, pose=Pose((0, 0, 0.09)), mass_kg=1.0)
        scene = Scene(held, Cage([(0.0, 0.0, -0.04)], shapes=pins), [WEIGHT], planar=planar)
        assert thickened(scene) is scene  # it has balls
        check_states(scene, rng, counts)
    assert counts[State.BLOCKED] > 0
    assert counts[State.FREE] > 10


ACROSS = Pose(euler_zyx=(0, 0, -math.pi / 2)).quaternion_wxyz
"""A shape's z along y of its body."""


def test_thin_parts_have_the_same_poses_stretched_across_the_plane(cases) -> None:
    """Sheets one to two millimetres thick, with one of each shape that can be stretched, in cages that are turned."""
    rng, counts = np.random.default_rng(8), dict.fromkeys(State, 0)
    for _ in range(cases(3, 60)):
        thick, turn = rng.uniform(0.001, 0.002), Pose(euler_zyx=(0, rng.uniform(-3, 3), 0))
        corners = rng.uniform(-0.015, 0.015, (8, 3)) * (1, 0.0, 1) + np.array(
            [[0, side * thick, 0] for side in (-1, 1)] * 4
        )
        hole = Hole(0.004, thick, Chamfer(0.001, 1.0), ["sheet"], Pose((0.01, thick / 2, 0.0), ACROSS))
        parts = [
            Box((0.03, thick, 0.02), Pose(), "sheet"),
            Convex(corners, pose_body_shape=Pose((-0.02, 0.0002, 0))),
            Box((0.02, thick, 0.005), Pose((0, 0, 0.015), euler_zyx=(0.3, 0.5, 0.2))),
        ]
        pins = [
            Cylinder(0.002, 0.005, Pose((0.05, 0.0005, 0.0), ACROSS)),
            Cone(0.006, 0.004, 0.006, Pose((-0.04, 0, 0.01), ACROSS)),
            rod_of_facets(0.005, 8, is_round=False).moved(Pose((0.0, 0.01 * rng.uniform(-1, 1), -0.06))),
            Cylinder(0.02, 0.01, Pose((0.0, 0.02, 0.0), ACROSS)),  # beside the plane
        ]
        held = Object([], shapes=parts, holes=[hole], pose=Pose((0, 0.003, 0.09), turn.quaternion_wxyz), mass_kg=1.0)
        cage = Cage([(0.0, 0.003, -0.04)], shapes=pins, pose=Pose((0.01, 0.003, 0), turn.quaternion_wxyz))
        scene = Scene(held, cage, [WEIGHT], planar="xz")
        assert thickened(scene).object.parts[0].size_m[1] > 0.03
        check_states(scene, rng, counts)
    assert counts[State.BLOCKED] > 0
    assert counts[State.FREE] > 10


def test_a_thin_disc_of_many_sides_keeps_its_sides_and_its_weight() -> None:
    """Corners that may be off the planes of their faces by a micrometre may be off by no more once it is thick."""
    disc = rod_of_facets(0.02, 400, is_round=False)
    sheet = Facets(disc.vertices_m * (1.0, 0.05, 1.0), disc.triangles, 1e-6)
    turned = Load("turned", gravity=(0, 0, -9.81), moments=[Moment((0, 1, 0), 0.01)])
    scene = Scene(Object([], shapes=[sheet], mass_kg=1.0), Cage([(0, 0, 0.05)]), [turned], planar="xz")
    assert thickened(scene) is not scene
    cells = Cells(scene, PlaneFrame(scene))
    for turn in np.linspace(0.0, 0.1, 9):
        assert cells.gap_m(InPlane(0.0, 0.02999, float(turn)), 1e-3) == pytest.approx(1e-5, abs=1e-6)
        assert cells.gap_m(InPlane(0.0, 0.0301, float(turn)), 1e-3) == 0.0


def check_states(scene: Scene, rng: np.random.Generator, counts: dict[State, int]) -> None:
    """Every pose of a blocked cell is in the cage, none of a free one is."""
    frame = PlaneFrame(scene, np.array([[0.0, 0.0, -1.0]]), np.zeros((1, 3)))
    cells = Cells(scene, frame)
    for _ in range(60):
        cell = (int(level := rng.integers(0, 4)), *(int(x) for x in rng.integers(0, 8 << level, 3)))
        state, block = cells.state(cell), cells.block(cell)
        counts[state] += 1
        for _ in range(4):
            at = block.middle._replace(
                u=block.middle.u + rng.uniform(-1, 1) * block.half_m,
                v=block.middle.v + rng.uniform(-1, 1) * block.half_m,
                turn=block.middle.turn + rng.uniform(-1, 1) * block.half_rad,
            )
            least, greatest = frame.potentials(block)
            assert least - 1e-12 <= frame.potential(at) <= greatest + 1e-12
            if state != State.OPEN:
                assert is_free(scene, frame.pose(at)) is (state == State.FREE)


def is_free(scene: Scene, pose: Pose) -> bool:
    try:
        scene.but_for(object=scene.object.starting_at(pose))
    except SceneError:
        return False
    return True


def test_a_ball_on_a_ball_gets_out_by_next_to_no_work() -> None:
    """Its start is the highest pose of a way out; where it leaves what it touches it is raised by less than a
    thousandth of its reach.
    """
    ball = Object([], shapes=[Sphere(0.01)], pose=Pose((0, 0, 0.02)), mass_kg=1.0)
    found = escape_energy(run(Scene(ball, Cage([], shapes=[Sphere(0.01)]), [WEIGHT], planar="xz")), n_motions=4_000)
    assert isinstance(found, EscapeEnergy)
    assert 0.0 <= found.at_least_j < found.at_most_j < 0.05 * 9.81 * 0.01


def test_a_thin_strip_does_not_pass_through_pins_beside_it() -> None:
    """It is half as thick as a hundred-thousandth of its length: play proves that it is caged, and cells cannot."""
    pins = [(x, 0.0, side * 1.1e-5) for x in (-0.04, -0.02, 0.0, 0.02, 0.04) for side in (-1, 1)]
    strip = Object([Box((0.1, 0.01, 2e-5))], mass_kg=1.0)
    scene = Scene(strip, Cage([*pins, (-0.0501, 0, 0), (0.0501, 0, 0)]), [WEIGHT], planar="xz")
    assert play(scene, search_s=0.0).verdict == "caged"
    assert way_out_in_plane(scene, 5_000) is False
    assert searched(scene, 5_000).search.found != Found.WAY


def test_a_hole_that_stands_alone_has_no_outside() -> None:
    hole = Hole(0.011, 0.03, pose_body_shape=Pose((0, 0, 0.0)))
    pin = Object([], shapes=[Cylinder(0.01, 0.02)], pose=Pose((0, 0, -0.01)), mass_kg=1.0)
    floor = Box((0.05, 0.05, 0.01), Pose((0, 0, -0.035)))
    scene = Scene(pin, Cage([], shapes=[hole, floor]), [WEIGHT], planar="xz")
    found = escape_energy(run(scene))
    assert isinstance(found, Unanswered)
    assert "without end" in found.unanswered


def test_round_facets_reach_as_far_as_what_they_stand_for() -> None:
    """Their triangles are within it; and a body of the cage has a frame of its own."""
    rod = rod_of_facets(0.005, 8)
    body = CageBody("post", pose=Pose((0.05, 0.0, -0.04)), shapes=[rod])
    scene = Scene(Object([], shapes=[rod], mass_kg=1.0), Cage([], bodies=[body]), [WEIGHT], planar="xz")
    frame = PlaneFrame(scene)
    assert 0.005 <= frame.reach_m < 2.0 * 0.005
    assert frame.center == pytest.approx((0.05, -0.04), abs=1e-9)


def rod_of_facets(radius_m: float, n_sides: int, is_round: bool = True) -> Facets:
    """A rod 20 mm long along y, of flat ends and a side of triangles that stand for a cylinder."""
    around = 2.0 * math.pi * (np.arange(n_sides) + 0.5) / n_sides
    ring = radius_m * np.stack([np.sin(around), np.zeros(n_sides), np.cos(around)], axis=1)
    ends = [ring + np.array((0.0, 0.01 * side, 0.0)) for side in (-1.0, 1.0)]
    here, ahead = np.arange(n_sides), (np.arange(n_sides) + 1) % n_sides
    side = [np.stack([here, ahead, n_sides + ahead], 1), np.stack([here, n_sides + ahead, n_sides + here], 1)]
    fan = np.stack([np.zeros(n_sides - 2, np.int64), here[1:-1], here[2:]], 1)
    triangles = np.concatenate([*side, fan[:, ::-1], n_sides + fan])
    on = np.where(np.arange(len(triangles)) < 2 * n_sides, 0, -1)
    cylinder = Surface("cylinder", (0.0, 0.0, 0.0), (0.0, 1.0, 0.0), radius_m)
    surfaces, of = ([cylinder], on) if is_round else ([], ())
    return Facets(np.concatenate(ends), triangles, surfaces=surfaces, on=of, name="rod")
