"""The cage: proven, left by a path, or neither."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from audit.caged_families import GRAVITY, caged, caged_seams
from cagepose import Box, Cage, Object, Play, Scene, SceneError, play
from cagepose.kernels.collision.contacts import deepest_boxes
from cagepose.studies.cage_verdict import search_way_out
from cagepose.studies.play_frame import FREEDOMS, PlayFrame
from rails import exact_tilt_deg, rail_scene

MM = 1e-3


def with_points(scene: Scene, kept: list[int]) -> Scene:
    cage = scene.cage
    names = [cage.names[index] for index in kept]
    return Scene(scene.object, Cage(cage.points_cage[kept], names, cage.pose_world_cage), scene.loads)


def greatest(found: Play, name: str) -> float:
    value = found.freedoms[name].high.exact
    assert value is not None
    return value


def assert_is_way_out(scene: Scene, found: Play) -> None:
    """No point is inside anywhere on the way, and at its end the object is clear of all points."""
    assert found.cage.path
    pose = scene.object.pose_world_object
    for step in found.cage.path:
        for fraction in np.linspace(0, 1, 200):
            depths, _ = deepest_boxes(scene.boxes, *step.motion.pose_at(pose, float(fraction)).as_tuples())
            assert depths.max() < 1e-9
        pose = step.pose_world_object
    last = found.cage.path[-1].motion
    assert last.kind == "travel"
    for far in (10.0, 100.0):
        depths, _ = deepest_boxes(scene.boxes, *replace(last, distance_m=far).pose_at(pose, 1.0).as_tuples())
        assert depths.max() < 0


def test_the_rail_has_the_play_that_hand_formulas_give():
    """Vertical play 1, side play 1.06, stops 1 mm away, rollers at x = +-91.5 and y = +-31.55, plate 1 mm thick.

    Linear: pitch 0.5/91.5, yaw 0.53/91.5 = 1.06/183, roll 0.5/31.55 rad. Exact pitch and roll: where
    (g/2) cos t - (l/2) sin t = 1/2 with l the spacing. The pin, 600 mm behind and 60.747 below, goes to the side by
    the yaw times 600, plus 0.53 - (0.53 / 91.5) * 0 at no shift: all of the side play is used up by the yaw, so
    linearly 600 * 0.53/91.5 + 60.747 * 0.5/31.55.
    """
    found = play(rail_scene(), [np.array([-600, 20, -60.747]) * MM], [(0, 1, 0)])
    linear = {name: ends.high.linear for name, ends in found.freedoms.items()}
    assert linear["x"] == pytest.approx(1 * MM, rel=1e-9)
    assert linear["y"] == pytest.approx(0.53 * MM, rel=1e-9)
    assert linear["z"] == pytest.approx(0.5 * MM, rel=1e-9)
    assert linear["roll"] == pytest.approx(0.5 / 31.55, rel=1e-9)
    assert linear["pitch"] == pytest.approx(0.5 / 91.5, rel=1e-9)
    assert linear["yaw"] == pytest.approx(1.06 / 183, rel=1e-9)
    assert math.degrees(greatest(found, "pitch")) == pytest.approx(exact_tilt_deg(1.0, 183.0), rel=1e-11)
    assert math.degrees(greatest(found, "pitch")) == pytest.approx(0.313084, abs=1e-6)
    assert math.degrees(greatest(found, "roll")) == pytest.approx(exact_tilt_deg(1.0, 63.1), rel=1e-11)
    assert found.points[0].high.linear == pytest.approx((600 * 0.53 / 91.5 + 60.747 * 0.5 / 31.55) * MM, rel=1e-9)
    for ends in found.freedoms.values():
        assert ends.low.exact == pytest.approx(-ends.high.exact, rel=1e-9)  # the rail is its own mirror image


@pytest.mark.parametrize("play_mm", [1.0, 0.1, 0.01])
def test_linear_and_exact_play_differ_by_second_order(play_mm):
    found = play(rail_scene(play_mm=play_mm))
    pitch = found.freedoms["pitch"].high
    difference = pitch.linear - pitch.exact
    # (g/2) cos t - (l/2) sin t = 1/2 with g = 1 + p, solved for t to the third order.
    t = pitch.linear
    assert difference == pytest.approx(t**2 * (1.0 + play_mm) / 2 / 183.0 - t**3 / 6, rel=1e-3)


def test_the_rail_is_caged_with_bounds_within_a_fifth_of_its_play():
    found = play(rail_scene(), [np.array([-600, 20, -60.747]) * MM])
    assert found.cage.verdict == "caged"
    assert found.cage.path is None
    for ends in [*found.freedoms.values(), *found.points]:
        for end in (ends.low, ends.high):
            assert abs(end.exact) <= abs(end.certified) <= 1.2 * abs(end.exact)


def test_without_its_stops_the_rail_is_free_along_x_and_slides_out():
    scene = with_points(rail_scene(), list(range(12)))
    found = play(scene)
    assert found.cage.verdict == "escapes"
    assert found.cage.free_directions == ("x",)
    assert found.freedoms["x"].high.exact is None
    assert found.freedoms["x"].high.is_open
    assert math.degrees(greatest(found, "pitch")) == pytest.approx(exact_tilt_deg(1.0, 183.0), rel=1e-9)
    assert_is_way_out(scene, found)


def test_a_gap_that_is_widened_until_a_point_passes_lets_the_rail_out():
    """With 8 mm of vertical play the side rollers pass below the webs, which reach 3 mm down."""
    scene = rail_scene(play_mm=8.0)
    found = play(scene)
    assert found.cage.verdict == "escapes"
    assert_is_way_out(scene, found)


def test_without_its_webs_the_rail_is_not_certified_and_the_side_rollers_are_named():
    rail = rail_scene()
    boxes = [box for box in rail.object.boxes if "web" not in box.name]
    scene = Scene(Object(boxes, rail.object.center_of_gravity_m), rail.cage, rail.loads)
    found = play(scene, search_s=0.0)
    assert found.cage.verdict == "not certified"
    assert found.cage.reason.startswith("C9 may run off its face of right guide")
    # There the roller is beside the guide's edge, which is 0.5 mm above and below it.
    pose = found.cage.leaves_at
    guide = next(box for box in boxes if box.name == "right guide")
    roller = guide.pose_object_box.inverse_transform(pose.inverse_transform(scene.cage.points_world()[8]))
    assert abs(roller[2]) > 0.45 * MM


@pytest.mark.parametrize(("thickness_mm", "verdict"), [(2.0, "caged"), (0.02, "not certified")])
def test_a_plate_must_be_thicker_than_what_linearising_leaves_out(thickness_mm, verdict):
    """A plate of 60 mm with 0.5 mm above, below and beside it: where it is thin, a point may come out behind it."""
    half = thickness_mm / 2
    points = [(x, y, side * (half + 0.5)) for x in (-25, 25) for y in (-25, 25) for side in (-1, 1)]
    points += [(side * 30.5, y, 0) for side in (-1, 1) for y in (-20, 20)]
    points += [(x, side * 30.5, 0) for side in (-1, 1) for x in (-20, 20)]
    plate = Object([Box(np.array([60, 60, thickness_mm]) * MM, name="plate")])
    found = play(Scene(plate, Cage(np.array(points) * MM), GRAVITY), search_s=0.0)
    assert found.cage.verdict == verdict, found.cage.reason
    if verdict != "caged":
        assert "may come out behind its face of plate" in found.cage.reason


def test_a_cage_that_is_too_wide_for_any_proof_says_how_far_the_object_turns():
    """A cube 20 mm wide with 8 points 6 mm from each face: sixty degrees and more at the first look."""
    points = [side * 16 * np.eye(3)[axis] + offset for axis in range(3) for side in (-1, 1) for offset in corners(axis)]
    found = play(Scene(Object([Box(np.full(3, 20 * MM))]), Cage(np.array(points) * MM), GRAVITY), search_s=0.0)
    assert found.cage.verdict == "not certified"
    assert "the object turns by up to" in found.cage.reason


def corners(axis: int) -> list[np.ndarray]:
    across = [np.eye(3)[(axis + step) % 3] for step in (1, 2)]
    return [8 * (i * across[0] + j * across[1]) for i in (-1, 1) for j in (-1, 1)]


def test_a_ball_joint_of_eight_points_is_too_loose_for_the_proof():
    """A cube between points in front of the middle of its faces turns freely: nothing is certified."""
    points = [side * 6 * axis for axis in np.eye(3) for side in (-1, 1)]
    found = play(Scene(Object([Box(np.full(3, 10 * MM))]), Cage(np.array(points) * MM), GRAVITY), search_s=0.1)
    assert found.cage.verdict != "caged"
    assert set(found.cage.free_directions) == {"roll", "pitch", "yaw"}
    assert found.freedoms["x"].high.linear == pytest.approx(1 * MM)


def walk(scene: Scene, found: Play, seconds: float) -> int:
    """Assert that no station of the search's tree passes a certified bound; return how many there are.

    Each is reached from the start by motions that are free of collision all the way.
    """
    frame = PlayFrame(scene)
    stations, n_stations, is_out, _ = search_way_out(scene, frame, seconds)
    assert not is_out
    turns = Rotation.from_quat(stations["quaternion"][:n_stations][:, [1, 2, 3, 0]])
    yaw, pitch, roll = turns.as_euler("ZYX").T
    starts = frame.pose_frame_object.transform(np.array([np.zeros(3), *(point.at_object for point in found.points)]))
    shifts = [turns.apply(start) + frame.length_m * stations["position"][:n_stations] - start for start in starts]
    values = dict(zip(FREEDOMS, (*shifts[0].T, roll, pitch, yaw), strict=True))
    for name, ends in found.freedoms.items():
        assert ends.low.certified <= values[name].min(), name
        assert values[name].max() <= ends.high.certified, name
    for point, shift in zip(found.points, shifts[1:], strict=True):
        assert point.low.certified <= (shift @ point.direction_cage).min()
        assert (shift @ point.direction_cage).max() <= point.high.certified
    return n_stations


def test_a_hundred_thousand_collision_free_motions_of_the_rail_stay_within_the_certified_bounds():
    """The tree ends at 100,000 stations; ten such walks with other seeds were run by hand."""
    scene = rail_scene()
    found = play(scene, [np.array([-600, 20, -60.747]) * MM])
    assert walk(scene, found, 60.0) > 99_000


def test_random_walks_in_random_caged_scenes_stay_within_the_certified_bounds(cases):
    rng = np.random.default_rng(9)
    n_proven = 0
    for _ in range(cases(20, 100)):
        scene = caged(rng)
        found = play(scene, [rng.uniform(-50, 50, 3) * MM], [rng.normal(size=3)], search_s=0.0)
        if found.cage.verdict == "caged":
            n_proven += walk(scene, found, 0.05) > 100
    assert n_proven > 3


def test_random_walks_in_adversarial_scenes_stay_within_the_certified_bounds(cases):
    rng = np.random.default_rng(11)
    n_proven, n_asked, n_scenes = 0, 0, cases(40, 120)
    while n_asked < n_scenes:
        try:
            scene = caged_seams(rng)
        except SceneError:  # a point of one box starts inside another
            continue
        n_asked += 1
        found = play(scene, [rng.uniform(-1, 1, 3) * scene.size_m], [rng.normal(size=3)], search_s=0.0)
        if found.cage.verdict == "caged":
            n_proven += 1
            walk(scene, found, 0.02)
            for ends in (*found.freedoms.values(), *found.points):
                for end in (ends.low, ends.high):
                    assert end.exact is None or abs(end.exact) <= abs(end.certified)
    assert n_proven > n_scenes // 12


def test_no_certified_scene_is_escaped_and_no_extreme_passes_its_bound(cases):
    rng = np.random.default_rng(10)
    n_proven, n_scenes = 0, cases(40, 100)
    for _ in range(n_scenes):
        found = play(caged(rng), search_s=0.0)
        if found.cage.verdict == "caged":
            n_proven += 1
            for ends in found.freedoms.values():
                assert ends.low.certified <= ends.low.exact <= ends.high.exact <= ends.high.certified
    assert n_proven > n_scenes // 3
