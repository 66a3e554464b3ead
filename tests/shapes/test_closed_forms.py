"""Rests of round and slanted parts that can be worked out by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cagepose import Box, Cage, Capsule, Convex, Load, Object, Pose, Run, Scene, Sphere, load_scene, run
from cagepose.runs.critical import with_critical_friction
from our_scenes import SCENES

DOWN = (0.0, 0.0, -1.0)
ALONG_X = Pose(euler_zyx=(0.0, math.pi / 2.0, 0.0))
ALONG_Y = Pose(euler_zyx=(0.0, 0.0, math.pi / 2.0))


def settled(held: Object, cage: Cage, friction: float = 0.0) -> Run:
    result = run(Scene(held, cage, [Load("weight", gravity=DOWN)], friction_coefficient=friction))
    assert result.verdict == "rests"
    return result


def scene_named(name: str, *values: str) -> Scene:
    (path,) = [path for path in SCENES if path.stem == name]
    return load_scene(path, values)


@pytest.mark.parametrize("radius", [0.002, 0.008, 0.03])
@pytest.mark.parametrize("play", [0.0001, 0.0005, 0.003])
def test_a_bar_between_rollers_tilts_by_its_play(radius: float, play: float) -> None:
    """(h + 2 rho + p) cos t - 2 a sin t = h + 2 rho, to 1e-9 deg."""
    height, arm = 0.01, 0.1
    high, low = height / 2.0 + radius + play, -height / 2.0 - radius
    rollers = [
        Capsule(radius, 0.06, Pose((x, 0.0, z), euler_zyx=ALONG_Y.euler_zyx)) for x in (-arm, arm) for z in (low, high)
    ]
    bar = Object([Box((0.4, 0.04, height))], (0.13, 0.0, 0.0), pose=Pose((0.0, 0.0, play / 2.0)))
    tilt = settled(bar, Cage(shapes=rollers), 0.1).pose.euler_zyx[1]
    left = (height + 2.0 * radius + play) * math.cos(tilt) - 2.0 * arm * math.sin(tilt) - height - 2.0 * radius
    assert abs(math.degrees(left / (2.0 * arm))) < 1e-9


@pytest.mark.parametrize("half_angle_deg", [20.0, 45.0, 75.0])
def test_a_round_bar_lies_in_a_v_of_two_plates(half_angle_deg: float) -> None:
    """Its axis lies r / sin(al) above the apex, and each plate carries W / (2 sin(al))."""
    half_angle, radius, thickness = math.radians(half_angle_deg), 0.01, 0.004
    plates = []
    for side in (1.0, -1.0):
        turned = Pose(euler_zyx=(0.0, 0.0, side * (math.pi / 2.0 - half_angle)))
        plates.append(Box((0.2, 0.1, thickness), turned @ Pose((0.0, side * 0.05, -thickness / 2.0))))
    bar = Object(shapes=[Capsule(radius, 0.05, ALONG_X)], pose=Pose((0.0, 0.003, 0.08)))
    result = settled(bar, Cage(shapes=plates))
    assert result.pose.position_m[2] == pytest.approx(radius / math.sin(half_angle), abs=1e-10)
    forces = dict.fromkeys(("box1", "box2"), 0.0)
    for contact in result.contacts:
        forces[contact.point] += contact.force_normal_n or 0.0
    assert list(forces.values()) == pytest.approx([1.0 / (2.0 * math.sin(half_angle))] * 2, rel=1e-9)


def test_a_ball_rests_on_three_points_and_on_three_balls() -> None:
    """Its centre is sqrt(r^2 - R^2) above the points' plane, sqrt((r + s)^2 - R^2) above balls of radius s."""
    radius, circle, small = 0.02, 0.012, 0.003
    corners = [
        (circle * math.cos(angle), circle * math.sin(angle), 0.0) for angle in (0.3, 0.3 + 2.0943951, 0.3 + 4.1887902)
    ]
    ball = Object(shapes=[Sphere(radius)], pose=Pose((0.001, 0.002, 0.05)))
    height = settled(ball, Cage(corners)).pose.position_m[2]
    assert height == pytest.approx(math.sqrt(radius**2 - circle**2), abs=1e-9)
    balls = Cage(shapes=[Sphere(small, Pose(corner)) for corner in corners])
    height = settled(ball, balls).pose.position_m[2]
    assert height == pytest.approx(math.sqrt((radius + small) ** 2 - circle**2), abs=1e-9)


def board_across(radius: float, height: float, reach: float = 0.3) -> Run:
    """A board across a fixed round bar, its centre of gravity so high above where it touches; with friction."""
    board = Object(
        [Box((reach, 0.05, 0.002))],
        (0.0, 0.0, height - 0.001),
        mass_kg=1.0,
        inertia_kg_m2=np.diag([1e-3, 2e-3, 2e-3]),
        pose=Pose((0.0, 0.0, radius + 0.001)),
    )
    bar = Capsule(radius, 0.2, ALONG_Y)
    return run(Scene(board, Cage(shapes=[bar]), [Load("weight", gravity=DOWN)], friction_coefficient=0.5))


@pytest.mark.parametrize("ratio", [0.5, 0.9, 0.999])
def test_a_board_across_a_round_bar_is_stable_below_the_radius(ratio: float) -> None:
    """Rolling lifts its centre of gravity while that is less than R above the contact (second order)."""
    result = board_across(0.05, 0.05 * ratio)
    assert (result.verdict, result.phases[0].proof.stability) == ("rests", "stable")


@pytest.mark.parametrize("ratio", [1.001, 1.1, 3.0])
def test_a_board_across_a_round_bar_is_unstable_above_the_radius(ratio: float) -> None:
    assert board_across(0.05, 0.05 * ratio).phases[0].proof.stability == "unstable"


@pytest.mark.parametrize(("above", "stability"), [(0.999, "stable"), (1.001, "unstable")])
def test_a_round_part_rocks_on_a_round_bar(above: float, stability: str) -> None:
    """Crosswise and along: stable if h < 1 / (1/R1 + 1/R2) (a rocking stone)."""
    fixed, own = 0.05, 0.03
    least = 1.0 / (1.0 / fixed + 1.0 / own)
    rocker = Object(
        shapes=[Convex([(0.0, -0.1, 0.0), (0.0, 0.1, 0.0)], own)],
        center_of_gravity_m=(0.0, 0.0, above * least - own),
        mass_kg=1.0,
        inertia_kg_m2=np.diag([1e-3, 1e-3, 1e-3]),
        pose=Pose((0.0, 0.0, fixed + own)),
    )
    fixed_bars = [Capsule(fixed, 0.05, Pose((0.0, y, 0.0), euler_zyx=ALONG_Y.euler_zyx)) for y in (-0.08, 0.08)]
    scene = Scene(rocker, Cage(shapes=fixed_bars), [Load("weight", gravity=DOWN)], friction_coefficient=0.5)
    assert run(scene).phases[0].proof.stability == stability


def test_a_ladder_of_round_ends_needs_its_friction() -> None:
    """The least coefficient that holds a round bar between floor and wall, the same at both."""
    length, radius, lean = 1.0, 0.03, math.radians(62.0)
    ladder = Object(
        shapes=[Capsule(radius, length)],
        pose=Pose(
            (0.0, 0.0, radius + length * math.sin(lean) / 2.0),
            euler_zyx=(0.0, -(math.pi / 2.0 - lean), 0.0),
        ),
    )
    wall_x = -length * math.cos(lean) / 2.0 - radius
    floor = Box((3.0, 2.0, 0.1), Pose((0.0, 0.0, -0.05)))
    wall = Box((0.1, 2.0, 3.0), Pose((wall_x - 0.05, 0.0, 1.0)))
    scene = Scene(ladder, Cage(shapes=[floor, wall]), [Load("weight", gravity=DOWN)], friction_coefficient=0.9)
    result = with_critical_friction(run(scene))
    assert result.phases[0].proof.critical_friction == pytest.approx(mu_of_ladder(length, radius, lean), abs=1e-9)


def mu_of_ladder(length: float, radius: float, lean: float) -> float:
    """The floor carries N = W / (1 + mu^2), the wall P = mu N, both with friction; moments about the place of the foot:
    W L cos / 2 = P (L sin + r) + mu P (L cos + r).
    """
    along, up, weight = (
        length * math.cos(lean) + radius,
        length * math.sin(lean) + radius,
        length * math.cos(lean) / 2.0,
    )
    roots = np.roots([along - weight, up, -weight])
    return float(max(roots.real))


def test_a_ball_between_three_jaws_centres_itself() -> None:
    """Each jaw carries W / (3 sin 30 deg), and the ball is a radius from each face."""
    result = run(scene_named("chuck"))
    assert result.verdict == "rests"
    assert [contact.force_normal_n for contact in result.contacts] == pytest.approx([0.981 / 1.5] * 3, rel=1e-12)
    assert result.pose.position_m[:2] == pytest.approx([0.0, 0.0], abs=1e-12)
    # the face of the first jaw: through (16, 0, 0) + 4 mm along its normal, which points to the axis and up
    normal = np.array([-math.cos(math.pi / 6.0), 0.0, math.sin(math.pi / 6.0)])
    on_face = np.array([0.016, 0.0, 0.0]) + 0.004 * normal
    assert normal @ (result.pose.position_m - on_face) == pytest.approx(0.012, abs=1e-11)


def test_a_box_as_a_hull_and_a_point_as_a_tiny_ball_give_the_same_answer() -> None:
    for name in ("rail-pitch", "v-groove", "connector", "wedge"):
        scene = scene_named(name)
        held = scene.object
        twin = Object(
            center_of_gravity_m=held.center_of_gravity_m,
            mass_kg=held.mass_kg or 1.0,
            inertia_kg_m2=held.gyration_m2 * (held.mass_kg or 1.0),
            pose=held.pose_world_object,
            shapes=[Convex(box.corners_object(), name=box.name) for box in held.boxes],
        )
        old = run(scene)
        new = run(
            Scene(twin, scene.cage, scene.loads, friction_coefficient=scene.friction_coefficient, metric=scene.metric)
        )
        assert new.verdict == old.verdict
        assert np.abs(new.pose.position_m - old.pose.position_m).max() < 1e-9 * scene.size_m
        turn = (
            Pose(quaternion_wxyz=old.pose.quaternion_wxyz).rotation.T
            @ Pose(quaternion_wxyz=new.pose.quaternion_wxyz).rotation
        )
        assert np.abs(turn - np.eye(3)).max() < 1e-9


def test_a_block_with_a_ball_tips_to_rest_on_a_floor() -> None:
    """A corner that comes down beside one that stands is reached, not what friction held on the way (it stalled)."""
    random, floor = np.random.default_rng(0), Box((0.3, 0.3, 0.02), Pose((0.0, 0.0, -0.07)))
    for _ in range(25):
        block = Box((0.02, 0.03, 0.04), Pose(random.uniform(-0.01, 0.01, 3), random.normal(size=4)))
        ball = Sphere(random.uniform(0.005, 0.02), Pose(random.uniform(-0.02, 0.02, 3)))
        held = Object(
            shapes=[block, ball],
            center_of_gravity_m=(0.0, 0.0, 0.0),
            mass_kg=1.0,
            inertia_kg_m2=np.diag([1e-4, 1.3e-4, 1.7e-4]),
        )
        settled(held, Cage(shapes=[floor]), 0.5)


def test_the_seam_of_flush_boxes_is_no_edge() -> None:
    """A ball over it may rest anywhere, as over a face; at an edge it would roll off."""
    tables = [Box((0.1, 0.2, 0.02), Pose((x, 0.0, -0.01))) for x in (-0.05, 0.05)]
    for at in (0.0, 0.001):
        ball = Object(shapes=[Sphere(0.01)], pose=Pose((at, 0.0, 0.01)))
        assert settled(ball, Cage(shapes=tables), 0.5).phases[0].proof.stability == "marginal"


@pytest.mark.parametrize("sideways", [-0.004, 0.004])
@pytest.mark.parametrize(("height", "is_stable"), [(-0.0059, True), (0.0031, False), (0.0061, False)])
def test_a_ball_rolls_along_a_groove_while_friction_carries(sideways: float, height: float, is_stable: bool) -> None:
    """It turns about the line u of its two contacts: stable where its centre of gravity is below that, across u."""
    radius, steep, flat = 0.02, math.radians(70.0), math.radians(30.0)
    plates = []
    for side, angle in ((-1.0, steep), (1.0, flat)):
        turned = Pose(euler_zyx=(0.0, 0.0, side * angle))
        plates.append(Box((0.4, 0.2, 0.01), turned @ Pose((0.0, side * 0.1, -0.005))))
    normals = np.array([[math.sin(steep), math.cos(steep)], [-math.sin(flat), math.cos(flat)]])
    centre = np.array([0.0, *np.linalg.solve(normals, [radius, radius])])
    along = np.array([0.0, *(normals[0] - normals[1])])
    along /= np.linalg.norm(along)
    off = np.array([0.0, sideways, height])
    assert ((off - (off @ along) * along)[2] < 0.0) == is_stable
    ball = Object(
        shapes=[Sphere(radius)], center_of_gravity_m=off, mass_kg=1.0, inertia_kg_m2=np.eye(3) * 1e-4, pose=Pose(centre)
    )
    scene = Scene(ball, Cage(shapes=plates), [Load("weight", gravity=DOWN)], friction_coefficient=2.0)
    found = run(scene).phases[0].proof.stability
    assert found in (("stable", "marginal") if is_stable else ("unstable",))


@pytest.mark.parametrize("turned", [0.0, 0.5])
@pytest.mark.parametrize("n", [6, 12, 24])
def test_a_prism_stands_on_its_equal(n: int, turned: float) -> None:
    """With all its corners, or all crossings of its edges: there was no room for so many meetings, and it escaped."""
    angles = np.arange(n) * 2.0 * math.pi / n
    rim = np.array([0.02 * np.cos(angles), 0.02 * np.sin(angles)]).T
    prism = Convex([(*place, z) for place in rim for z in (-0.01, 0.01)])
    below = Pose(euler_zyx=(turned * 2.0 * math.pi / n, 0.0, 0.0)).transform(prism.vertices_m)
    result = settled(Object(shapes=[prism], pose=Pose((0.0, 0.0, 0.05))), Cage(shapes=[Convex(below)]), 0.3)
    assert result.pose.position_m[2] == pytest.approx(0.02, abs=1e-12)
    assert len(result.contacts) == (n if turned == 0.0 else 2 * n)
