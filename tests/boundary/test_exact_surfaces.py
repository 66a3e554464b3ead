"""Triangles that stand for planes and cylinders: the body is as round as these, beside primitives and closed forms."""

from __future__ import annotations

import math
import time

import numpy as np
import pytest

from boundary.prisms import Corner, cradle, prism
from cagepose import Box, Cage, Cylinder, Facets, Load, Object, Pose, Scene, load_scene, run, save_scene
from cagepose.files.record import from_record, record_of
from cagepose.kernels.boundary.features import CIRCLE, FACE, LINE, SEGMENT, VERTEX
from cagepose.model.boundary.features import boundary_of
from cagepose.model.shape_moments import shape_moments

TOUCH_M = 1e-11
ALONG_Y = Pose((0, 0, 0), euler_zyx=(0.0, 0.0, math.pi / 2.0))
FLOOR = Box((1.0, 1.0, 0.1), Pose((0, 0, -0.05)), "floor")
WEIGHT = [Load("weight", gravity=(0.0, 0.0, -9.81))]


def rounded_bar(wide: float, high: float, radius: float, length: float):
    """A bar along y, whose four long edges are round."""
    x, z = wide / 2.0 - radius, high / 2.0 - radius
    corners = []
    for (cx, cz), (dx, dz) in zip(
        [(-x, -z), (x, -z), (x, z), (-x, z)], [(-1, 0), (0, -1), (1, 0), (0, 1)], strict=True
    ):
        corners.append(Corner((cx + radius * dx, cz + radius * dz), (cx, cz)))
        corners.append(Corner((cx - radius * dz, cz + radius * dx)))
    return prism(corners, length, "bar")


def bar_of_primitives(wide: float, high: float, radius: float, length: float):
    rods = [
        Cylinder(radius, length, Pose((x, 0, z)) @ ALONG_Y, f"rod {k}")
        for k, (x, z) in enumerate(
            (sx * (wide / 2 - radius), sz * (high / 2 - radius)) for sx in (-1, 1) for sz in (-1, 1)
        )
    ]
    flat = Box((wide, length, high - 2 * radius), name="flat")
    return [flat, Box((wide - 2 * radius, length, high), name="upright"), *rods]


def scene(held, cage, pose: Pose, friction: float = 0.0) -> Scene:
    return Scene(Object(shapes=held, pose=pose), Cage(shapes=cage), WEIGHT, friction_coefficient=friction)


def test_features_are_those_of_the_surfaces():
    """A round bar of many triangles has two circles, two faces and one side; a groove has a side with borders."""
    places = [(0.003 * math.cos(angle), 0.003 * math.sin(angle)) for angle in (0.0, 2.0, 4.0)]
    bar = prism([Corner(place, (0.0, 0.0)) for place in places], 0.02)
    kinds = sorted(boundary_of([bar], TOUCH_M).features["kind"].tolist())
    assert kinds == [LINE, FACE, FACE, CIRCLE, CIRCLE]
    found = boundary_of([cradle()], TOUCH_M)
    kinds = found.features["kind"].tolist()
    assert (kinds.count(FACE), kinds.count(CIRCLE), kinds.count(VERTEX)) == (7, 2, 12)
    (side,) = [row for row in found.features if row["kind"] == LINE and row["radius"] != 0.0]
    assert side["radius"] == pytest.approx(-0.005, abs=1e-15)
    assert set(found.bounds["kind"][side["first_bound"] : side["last_bound"]].tolist()) == {SEGMENT}


def test_moments_are_those_of_the_surfaces():
    """A bar with round edges: a rectangle less four corners, each a square less a quarter of a circle."""
    found = shape_moments(rounded_bar(0.02, 0.012, 0.003, 0.05))
    area = 0.02 * 0.012 - (4.0 - math.pi) * 0.003**2
    assert found.volume_m3 == pytest.approx(0.05 * area, rel=1e-11)
    whole = shape_moments(cradle())
    assert whole.volume_m3 == pytest.approx(0.04 * (0.04 * 0.01 - math.pi * 0.005**2 / 2.0), rel=1e-11)
    below = 0.04 * 0.01 * 0.005 - (math.pi * 0.005**2 / 2.0) * (4.0 * 0.005 / (3.0 * math.pi))
    assert whole.centroid_m[2] == pytest.approx(-below / (0.04 * 0.01 - math.pi * 0.005**2 / 2.0), rel=1e-10)


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("radius", [0.001, 0.003, 0.0049])
def test_a_roller_lies_at_the_bottom_of_a_groove(radius, friction):
    """R - r below the groove's axis, wherever it is let go over it; friction may hold a roller that does not turn."""
    roller = Cylinder(radius, 0.03, ALONG_Y, "roller")
    for x, z in ((0.0, 0.5), (0.3, 0.5), (-0.7, 0.4), (0.6, 1.0), (-0.8, 0.2), (0.95, 0.7)):
        found = run(scene([roller], [cradle()], Pose((x * (0.005 - radius), 0.001, z * 1e-3)), friction))
        assert found.verdict == "rests"
        away = np.linalg.norm(found.phases[-1].pose.position_m[[0, 2]])
        assert away == pytest.approx(0.005 - radius, abs=1e-11)


def test_a_roller_that_ends_flush_with_a_groove_falls_into_it_in_few_steps():
    """Its rims cross the arcs of the groove in one plane all the way down: 20 s, where each step is asked for that."""
    roller = Cylinder(0.0049, 0.04, ALONG_Y, "roller")
    made = scene([roller], [cradle()], Pose((0.0, 0.0, 0.005)))
    began = time.process_time()
    found = run(made)
    assert time.process_time() - began < 5.0
    assert found.phases[-1].pose.position_m == pytest.approx([0.0, 0.0, -1e-4], abs=1e-11)


def test_the_edges_of_a_groove_hold_what_is_wider():
    """A roller with a greater radius lies on both edges of the groove, sqrt(r^2 - R^2) above them."""
    roller = Cylinder(0.008, 0.02, ALONG_Y, "roller")
    found = run(scene([roller], [cradle()], Pose((0.001, 0, 0.012))))
    assert found.verdict == "rests"
    expected = math.sqrt(0.008**2 - 0.005**2)
    assert found.phases[-1].pose.position_m[[0, 2]] == pytest.approx([0.0, expected], abs=1e-9)


@pytest.mark.parametrize("friction", [0.0, 0.4])
def test_a_bar_with_round_edges_lands_as_one_of_boxes_and_rods(friction, cases):
    rng = np.random.default_rng(3)
    for _ in range(cases(5, 50)):
        wide, high, radius = rng.uniform(0.008, 0.02), rng.uniform(0.008, 0.02), rng.uniform(0.001, 0.0035)
        size = wide, high, radius, 0.03
        pose = Pose((0, 0, 0.05), euler_zyx=(rng.uniform(-3, 3), rng.uniform(-0.3, 0.3), rng.uniform(-0.7, 0.7)))
        ours = run(scene([rounded_bar(*size)], [FLOOR], pose, friction))
        theirs = run(scene(bar_of_primitives(*size), [FLOOR], pose, friction))
        assert ours.verdict == theirs.verdict
        pose, other = ours.phases[-1].pose, theirs.phases[-1].pose
        assert abs(pose.position_m[2] - other.position_m[2]) < 1e-11  # along the floor, without friction, it may go on
        assert np.abs(pose.rotation[2] - other.rotation[2]).max() < 1e-9


def test_a_ball_and_a_post_stand_in_the_end_of_a_slot():
    """A plate with a slot of 6 mm, pushed along it against a post of 4 mm: the post is 1 mm from the end's axis."""
    half, end = 0.003, 0.01
    plate = [
        prism(
            [
                Corner((-0.02, -0.02)),
                Corner((0.02, -0.02)),
                Corner((0.02, -half)),
                Corner((-end, -half)),
                Corner((-end, half)),
                Corner((0.02, half)),
                Corner((0.02, 0.02)),
                Corner((-0.02, 0.02)),
            ],
            0.004,
            "fork",
        )
    ]
    rounded = prism(
        [
            Corner((-0.02, -0.02)),
            Corner((0.02, -0.02)),
            Corner((0.02, -half)),
            Corner((-end, -half), (-end, 0.0)),
            Corner((-end - half, 0.0), (-end, 0.0)),
            Corner((-end, half)),
            Corner((0.02, half)),
            Corner((0.02, 0.02)),
            Corner((-0.02, 0.02)),
        ],
        0.004,
        "fork",
    )
    post = [Cylinder(0.002, 0.02, ALONG_Y, "post")]
    push = [Load("push", gravity=(9.81, 0.0, 0.0))]
    for shapes, expected in (([rounded], end + half - 0.002), (plate, end - 0.002)):
        held = Object(shapes=shapes, pose=Pose((0.001, 0, 0)))
        found = run(Scene(held, Cage(shapes=post), push))
        assert found.verdict == "rests"
        assert found.phases[-1].pose.position_m[0] == pytest.approx(expected, abs=1e-9)


def test_points_meet_a_face_within_its_arcs_alone(cases):
    """A fork with a round end to its slot, and a round nose, falls on single points: by its profile, or past them."""
    half, end, nose = 0.003, 0.004, 0.01
    fork = [
        Corner((-end, -nose)),
        Corner((0.01, -nose)),
        Corner((0.01, -half)),
        Corner((0.0, -half), (0.0, 0.0)),
        Corner((-half, 0.0), (0.0, 0.0)),
        Corner((0.0, half)),
        Corner((0.01, half)),
        Corner((0.01, nose)),
        Corner((-end, nose), (-end, 0.0)),
        Corner((-end - nose, 0.0), (-end, 0.0)),
    ]
    part, rng = prism(fork, 0.005, "fork"), np.random.default_rng(8)
    falls = [Load("weight", gravity=(0.0, -9.81, 0.0))]
    for _ in range(cases(60, 3000)):
        x, z = rng.uniform((-0.016, -0.012), (0.012, 0.012))
        in_slot = (x > 0.0 and abs(z) < half) or math.hypot(x, z) < half
        in_outline = (-end < x < 0.01 and abs(z) < nose) or math.hypot(x + end, z) < nose
        found = run(Scene(Object(shapes=[part]), Cage([(x, -0.02, z)]), falls))
        assert (found.phases[0].events[0].rule == "escapes") == (in_slot or not in_outline), (x, z)


def test_a_scene_keeps_its_surfaces(tmp_path):
    made = scene([rounded_bar(0.02, 0.012, 0.003, 0.03)], [cradle(), FLOOR], Pose((0, 0, 0.05)))
    save_scene(made, tmp_path / "scene.yaml")
    again = load_scene(tmp_path / "scene.yaml")
    for ours, theirs in zip(
        (*made.object.parts, *made.cage.shapes), (*again.object.parts, *again.cage.shapes), strict=True
    ):
        if isinstance(ours, Facets):
            assert ours.surfaces == theirs.surfaces
            assert np.array_equal(ours.on, theirs.on)
            assert np.abs(ours.vertices_m - theirs.vertices_m).max() < 1e-17
    record = record_of(made)
    assert record_of(from_record(Scene, record)) == record
