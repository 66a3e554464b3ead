"""What travels over the edge of its support begins to tip there, and does not fly across a gap to the next one."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cagepose import Box, Cage, Cylinder, Force, Load, Object, Pose, Scene, run
from quasistatic.paths import path_of

MM = 1e-3
LENGTH, HEIGHT = 100.0, 10.0


def over_a_gap(far_mm: float, kind: str, stop_mm: float = 500.0, start_mm: float = -30.0) -> Scene:
    """A bar on a table that ends at x = 0, pushed along x at the height of its middle toward one that begins at
    ``far_mm``, both at one height: of boxes, or with points at their edges.
    """
    start = Pose((start_mm * MM, 0, HEIGHT / 2 * MM))
    held = Object([Box(np.array([LENGTH, 40, HEIGHT]) * MM)], mass_kg=0.1, pose=start)
    load = Load("push", gravity=(0, 0, -9.81), force=Force((1, 0, 0), (0, 0, 0), 0.5))
    stop = Box(np.array([10, 60, 60]) * MM, Pose(np.array([stop_mm + 5, 0, 30]) * MM), "stop")
    if kind == "points":
        points = [(x, y, 0) for x in (-40, 0, far_mm, far_mm + 40) for y in (-15, 15)]
        return Scene(held, Cage(np.array(points) * MM, shapes=[stop]), [load])
    tables = [Box(np.array([200, 60, 40]) * MM, Pose(np.array([x, 0, -20]) * MM)) for x in (-100, far_mm + 100)]
    return Scene(held, Cage(shapes=[*tables, stop]), [load])


@pytest.mark.parametrize("kind", ["points", "boxes"])
def test_a_bar_tips_where_its_load_leaves_its_support(kind):
    """Without friction a push at its middle turns nothing: it travels to the edge, and then tips ever more."""
    poses = path_of(run(over_a_gap(80.0, kind), "quasistatic").phases[0])
    tilts = np.array([pose.euler_zyx[1] for pose in poses])
    begins = int(np.argmax(tilts > 1e-9))
    assert poses[begins - 1].position_m[0] == pytest.approx(0.0, abs=0.1 * MM)
    assert (np.diff(tilts[begins:]) >= 0.0).all()
    assert tilts[-1] > 0.5


@pytest.mark.parametrize("kind", ["points", "boxes"])
@pytest.mark.parametrize("far_mm", [55.0, 57.0, 70.0])
def test_it_does_not_cross_a_gap_of_more_than_half_its_length(kind, far_mm):
    ended = run(over_a_gap(far_mm, kind, 200.0), "quasistatic")
    assert ended.verdict == "escapes" or abs(ended.pose.euler_zyx[1]) > math.radians(5)


@pytest.mark.parametrize("kind", ["points", "boxes"])
def test_it_crosses_a_gap_of_less(kind):
    """The next table is under its end before its middle comes to the edge."""
    ended = run(over_a_gap(45.0, kind, 100.0), "quasistatic")
    assert ended.verdict == "rests"
    assert ended.pose.position_m == pytest.approx(np.array([50.0, 0.0, 5.0]) * MM, abs=1e-9)


def test_points_at_the_edges_of_tables_and_tables_give_one_rest():
    ends = [run(over_a_gap(52.0, kind), "quasistatic") for kind in ("points", "boxes")]
    assert [end.verdict for end in ends] == ["rests", "rests"]
    assert ends[0].pose.position_m == pytest.approx(ends[1].pose.position_m, abs=1e-6 * MM)
    assert ends[0].pose.euler_zyx[1] == pytest.approx(ends[1].pose.euler_zyx[1], abs=1e-8)
    assert ends[0].pose.euler_zyx[1] > math.radians(5)


@pytest.mark.parametrize("kind", ["points", "boxes"])
@pytest.mark.parametrize("start_mm", [1e-6, 1e-4, 1e-2])
def test_it_ends_alike_from_just_beyond_the_edge(kind, start_mm):
    """There its spin begins with almost nothing, but grows."""
    here, before = (run(over_a_gap(52.0, kind, 200.0, start), "quasistatic") for start in (start_mm, -30.0))
    assert here.verdict == before.verdict == "rests"
    assert here.pose.position_m == pytest.approx(before.pose.position_m, abs=1e-7 * MM)


def test_friction_on_the_way_to_an_edge_holds_it():
    """Smooth points behind, rough ones at the edge, a way c apart: the push F, h above them, is held as soon as these
    carry it, N c = W (c + x) + F h with N = F. At the end of the travel, beyond the edge, the bar would tip.
    """
    held = Object([Box(np.array([300, 40, 10]) * MM)], mass_kg=0.1, pose=Pose((-80 * MM, 0, 5 * MM)))
    points = [(x, y, 0) for x in (-100, 0) for y in (-15, 15)]
    load = Load("push", gravity=(0, 0, -9.81), force=Force((1, 0, 0), (0, 0, 0), 0.3))
    stop = Box(np.array([10, 100, 100]) * MM, Pose(np.array([305, 0, 50]) * MM), "stop")
    cage = Cage(np.array(points) * MM, shapes=[stop])
    ended = run(Scene(held, cage, [load], friction_of={"C3": 1.0, "C4": 1.0}), "quasistatic")
    assert ended.verdict == "may rest"
    assert ended.pose.position_m[0] / MM == pytest.approx(0.3 * (100.0 - 5.0) / (0.1 * 9.81) - 100.0, abs=1e-7)


def test_it_tips_over_a_roller_behind_an_edge_on_a_slope():
    """What carries at the start ends a little before the travel does."""
    slope = math.radians(20.0)
    held = Object([Box(np.array([100, 40, 10]) * MM)], mass_kg=0.1, pose=Pose((-20 * MM, 0, 5 * MM)))
    table = Box(np.array([300, 60, 40]) * MM, Pose(np.array([-170, 0, -20]) * MM))
    roller = Cylinder(6 * MM, 60 * MM, Pose((0, 0, -6 * MM), euler_zyx=(0, 0, math.pi / 2)))
    load = Load("weight", gravity=(9.81 * math.sin(slope), 0, -9.81 * math.cos(slope)))
    path = path_of(run(Scene(held, Cage(shapes=[table, roller]), [load]), "quasistatic").phases[0])
    level = [pose.position_m[0] for pose in path if abs(pose.euler_zyx[1]) < 1e-9]
    assert max(level) <= 0.1 * MM


@pytest.mark.parametrize("beside_mm", [0.0, 3.0, 15.0])
@pytest.mark.parametrize("radius_mm", [30.0, 150.0])
def test_a_bar_tips_where_its_load_leaves_a_round_table(radius_mm, beside_mm):
    """Its long edges cross the rim behind the place where it lies on the rim farthest out: over this it tips."""
    held = Object(
        [Box(np.array([LENGTH, 40, HEIGHT]) * MM)], mass_kg=0.1, pose=Pose((-20 * MM, beside_mm * MM, HEIGHT / 2 * MM))
    )
    table = Cylinder(radius_mm * MM, 40 * MM, Pose((-radius_mm * MM, 0, -20 * MM)))
    load = Load("push", gravity=(0, 0, -9.81), force=Force((1, 0, 0), (0, 0, 0), 0.5))
    ended = run(Scene(held, Cage(shapes=[table]), [load]), "quasistatic")
    level = [pose.position_m[0] for pose in path_of(ended.phases[0]) if pose.rotation[2, 2] > 1.0 - 1e-12]
    assert ended.verdict == "escapes"
    assert max(level) / MM == pytest.approx(math.sqrt(radius_mm**2 - beside_mm**2) - radius_mm, abs=0.1)


@pytest.mark.parametrize(
    ("friction", "around"),
    [(0.0, 0.0), (0.0, 0.3), (0.3, 0.0), (0.3, 0.4), (0.2, -0.5), (0.25, math.pi / 8), (0.1, 0.7)],
)
def test_a_can_that_is_pushed_over_the_edge_of_a_table_tips_there(friction, around):
    """Its foot is a rim that lies flat. Pushed at its middle, friction below it moves its load by mu h/2 ahead: there
    it tips, wherever on the rim that is, and however the rim comes out over the edge.
    """
    radius, height, edge = 60.0 * MM, 150.0 * MM, 400.0 * MM
    table = Box((2 * edge, 2 * edge, 0.1), Pose((0.0, 0.0, -0.05)))
    push = Force((math.cos(around), math.sin(around), 0.0), (0, 0, 0), friction + 0.2)
    load = Load("push", gravity=(0, 0, -1), force=push)
    can = Object(shapes=[Cylinder(radius, height)], mass_kg=1.0, pose=Pose((0, 0, height / 2)))
    ended = run(Scene(can, Cage(shapes=[table]), [load], friction_coefficient=friction), "quasistatic")
    assert ended.verdict == "escapes"
    poses = path_of(ended.phases[0])
    tilts = np.array([math.hypot(*pose.rotation[:2, 2]) for pose in poses])
    begins = int(np.argmax(tilts > 1e-9))
    load_ahead = friction * height / 2 * math.cos(around)
    assert poses[begins - 1].position_m[0] + load_ahead == pytest.approx(edge, abs=0.1 * MM)
    assert tilts.max() > 0.2


@pytest.mark.parametrize(
    ("radius_mm", "height_mm", "friction", "push_n"),
    [(15, 40, 0.5, 1.0), (10, 40, 0.3, 0.5), (12, 30, 0.4, 1.0), (15, 40, 0.3, 0.5), (15, 20, 0.3, 0.5)],
)
def test_a_can_that_friction_brakes_tips_before_the_edge(radius_mm, height_mm, friction, push_n):
    """Friction at its foot, mu W, turns it forward about its middle, h above: from mu h before the edge on it tips
    about that, where the rim comes out of the table at two places.
    """
    table = Box(np.array([60, 100, 10]) * MM, Pose(np.array([-30, 0, -5]) * MM))
    start = Pose(np.array([-10, 0, height_mm / 2]) * MM)
    can = Object(shapes=[Cylinder(radius_mm * MM, height_mm * MM)], mass_kg=1.0 / 9.81, pose=start)
    load = Load("push", gravity=(0, 0, -9.81), force=Force((-1, 0, 0), (0, 0, 0), push_n))
    ended = run(Scene(can, Cage(shapes=[table]), [load], friction_coefficient=friction))
    poses = path_of(ended.phases[0])
    tilts = np.array([abs(pose.euler_zyx[1]) for pose in poses])
    begins = int(np.argmax(tilts > 1e-10))
    assert ended.verdict == "escapes"
    assert poses[begins - 1].position_m[0] == pytest.approx((-60 + friction * height_mm / 2) * MM, abs=0.01 * MM)
    assert (np.diff(tilts[begins : begins + 10]) > 0.0).all()


@pytest.mark.parametrize("height_mm", [-40.0, -20.0, 0.0, 30.0])
@pytest.mark.parametrize("around", [0.0, 0.2, 0.5])
def test_no_can_stays_upright_beyond_the_edge(height_mm, around):
    """A push below its middle holds it upright beyond where its weight alone would tip it, but not beyond its rim."""
    radius, height, edge = 70.0 * MM, 90.0 * MM, 400.0 * MM
    table = Box((2 * edge, 2 * edge, 0.1), Pose((0.0, 0.0, -0.05)))
    push = Force((math.cos(around), math.sin(around), 0.0), (0, 0, height_mm * MM), 0.6)
    load = Load("push", gravity=(0, 0, -1), force=push)
    can = Object(shapes=[Cylinder(radius, height)], mass_kg=1.0, pose=Pose((0, 0, height / 2)))
    ended = run(Scene(can, Cage(shapes=[table]), [load]), "quasistatic")
    assert ended.verdict == "escapes"
    upright = [pose.position_m[0] for pose in path_of(ended.phases[0]) if pose.rotation[2, 2] > 1.0 - 1e-9]
    assert upright[-1] == pytest.approx(edge - 0.6 * height_mm * MM * math.cos(around), abs=2e-3 * radius)


@pytest.mark.parametrize(
    ("friction", "around", "aside_mm"),
    [(0.0, 0.0, 0.0), (0.0, 0.4, 30.0), (0.0, math.pi / 8, 0.0), (0.3, 0.0, 0.0), (0.3, 0.5, -20.0), (0.1, 0.2, 50.0)],
)
def test_a_can_on_a_round_table_tips_where_its_load_comes_to_the_edge(friction, around, aside_mm):
    """Two rims at one height cross at two places: between these each of them lies on the other part's face."""
    radius, height, edge = 60.0 * MM, 150.0 * MM, 300.0 * MM
    ahead = np.array([math.cos(around), math.sin(around)])
    start = (-aside_mm * MM * ahead[1], aside_mm * MM * ahead[0], height / 2)
    load = Load("push", gravity=(0, 0, -1), force=Force((*ahead, 0.0), (0, 0, 0), friction + 0.2))
    can = Object(shapes=[Cylinder(radius, height)], mass_kg=1.0, pose=Pose(start))
    table = Cylinder(edge, 0.1, Pose((0.0, 0.0, -0.05)))
    ended = run(Scene(can, Cage(shapes=[table]), [load], friction_coefficient=friction), "quasistatic")
    assert ended.verdict == "escapes"
    poses = path_of(ended.phases[0])
    begins = int(np.argmax([math.hypot(*pose.rotation[:2, 2]) > 1e-9 for pose in poses]))
    loaded = poses[begins - 1].position_m[:2] + friction * height / 2 * ahead
    assert np.linalg.norm(loaded) == pytest.approx(edge, abs=0.1 * MM)


@pytest.mark.parametrize("gap_mm", [40.0, 50.0, 55.0, 57.0])
@pytest.mark.parametrize("yaw", [0.0, 0.1, math.pi / 8])
@pytest.mark.parametrize("friction", [0.0, 0.2])
def test_a_can_crosses_a_gap_of_less_than_its_radius(gap_mm, yaw, friction):
    """Its rim comes out from under the first edge at one point: there it lies flat on that no more, and goes on."""
    radius, height = 60.0 * MM, 30.0 * MM
    tables = [Box((0.4, 0.6, 0.04), Pose((x, 0, -0.02))) for x in (-0.2, gap_mm * MM + 0.2)]
    stop = Box((0.01, 0.2, 0.06), Pose((0.165, 0, 0.03)), "stop")
    push = Force((1.0, 0.0, 0.0), (0, 0, 0), friction + 0.2)
    load = Load("push", gravity=(0, 0, -1), force=push)
    can = Object(
        shapes=[Cylinder(radius, height)], mass_kg=1.0, pose=Pose((-0.02, 0, height / 2), euler_zyx=(yaw, 0, 0))
    )
    ended = run(Scene(can, Cage(shapes=[*tables, stop]), [load], friction_coefficient=friction), "quasistatic")
    assert ended.verdict in ("rests", "may rest")
    assert ended.pose.position_m == pytest.approx(np.array([0.1, 0.0, height / 2]), abs=1e-9)
    assert math.hypot(*ended.pose.rotation[:2, 2]) < 1e-9
