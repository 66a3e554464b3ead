"""Ends of the play where pushes come to rest: closed forms, the ends that programs find, and samples."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
import pytest
from scipy.optimize import brentq

from audit.caged_families import caged
from cagepose import Box, Cage, Capsule, Cylinder, Hole, Load, Object, Pose, Scene, SceneError, Shape, Sphere, play, run
from cagepose.studies.play_frame import FREEDOMS
from cagepose.studies.pushed_play import PushedPlay
from cagepose.studies.pushes import unseated
from end_oracle import Start, missing

MM = 1e-3
DOWN = (Load("weight", gravity=(0, 0, -1)),)
UP, ALONG_X = Load("up", gravity=(0, 0, 1)), Load("along x", gravity=(1, 0, 0))


def test_pushes_come_as_far_as_linear_programs_and_every_end_is_free_and_stationary(cases):
    """Boxes among points, asked both ways, of which the ends are checked by the oracle of the programs' own tests."""
    rng = np.random.default_rng(31)
    n_ends = n_nearer = 0
    for _ in range(cases(8, 150)):
        scene = caged(rng)
        known, start = play(scene, search_s=0.0), Start(scene)
        pushed = PushedPlay(scene, unseated(scene), []).ranges()
        for name, ends in zip(FREEDOMS, pushed, strict=True):
            pair = known.freedoms[name]
            for sign, end, other in zip((-1.0, 1.0), ends, (pair.low, pair.high), strict=True):
                value, slope = start.value(end.pose_world_object, name)
                assert start.unit(name) * value == pytest.approx(end.reached, abs=1e-9 * start.unit(name))
                gaps, rows = start.gaps(end.pose_world_object)
                assert gaps.max(axis=1).min() >= -1e-11
                assert end.status != "local" or missing(gaps, rows, sign * slope) < 1e-4
                n_ends += 1
                n_nearer += sign * end.reached < sign * other.reached - 1e-7 * start.unit(name)
    assert n_nearer <= 0.02 * n_ends


def between_rollers(height: float, apart: float, radius: float, play_mm: float, length: float = 200.0) -> Scene:
    """A bar of a height between two pairs of rollers, ``apart`` to each side of its middle, with the play shared."""
    rise = height / 2 + radius + play_mm / 2
    upright = Pose(quaternion_wxyz=(math.sqrt(0.5), math.sqrt(0.5), 0, 0))  # the axis of a capsule is z
    rollers = [
        Capsule(radius * MM, 80 * MM, Pose(np.array([x, 0, z]) * MM, upright.quaternion_wxyz))
        for x in (-apart, apart)
        for z in (-rise, rise)
    ]
    return Scene(Object([Box(np.array([length, 40, height]) * MM)]), Cage(shapes=rollers), DOWN)


@pytest.mark.parametrize(("height", "apart", "radius", "free"), [(40, 90, 8, 0.5), (10, 30, 15, 2), (60, 70, 1, 0.05)])
def test_a_bar_tilts_between_rollers_by_the_closed_form(height, apart, radius, free):
    """(h + 2 rho + p) cos t - 2 a sin t = h + 2 rho, p being the whole play."""
    found = play(between_rollers(height, apart, radius, free), search_s=0.0)

    def left(tilt: float) -> float:
        return (height + 2 * radius + free) * math.cos(tilt) - 2 * apart * math.sin(tilt) - height - 2 * radius

    tilt = brentq(left, 0.0, 0.2, xtol=1e-15)
    pitch, rise = found.freedoms["pitch"], found.freedoms["z"]
    assert (pitch.low.exact, pitch.high.exact) == pytest.approx((-tilt, tilt), abs=1e-11)
    assert (rise.low.exact, rise.high.exact) == pytest.approx((-free / 2 * MM, free / 2 * MM), abs=1e-12)
    assert found.freedoms["x"].low.is_open
    assert found.freedoms["y"].high.is_open
    assert found.cage.verdict == "escapes"


def test_closing_a_gap_of_a_roller_brings_the_end_back_as_said():
    scene, by = between_rollers(40, 90, 8, 0.5), 1e-7
    before = play(scene, search_s=0.0).freedoms["pitch"].high
    assert {clearance.point for clearance in before.clearances} == {"capsule2", "capsule3"}
    worth = next(clearance for clearance in before.clearances if clearance.point == "capsule2")
    assert worth.gap_m is None
    key = "cage.shapes[1].position[2]"
    nearer = scene.changed(key, float(scene.cage.shapes[1].pose_body_shape.position_m[2]) - by)
    after = play(nearer, search_s=0.0).freedoms["pitch"].high
    assert (before.exact - after.exact) / by == pytest.approx(worth.closing, rel=1e-4)


def test_two_holes_that_end_one_way_are_each_worth_all_of_it_closed_and_nothing_opened():
    """A plate on two bolts with 0.3 mm: either bolt moved by d inwards brings the end back by d. It tilts by 2e-6 rad
    in 0.01 mm of height, so that the push has arms of 5e-8 m about both, which shared it by 0.42 and 0.58."""
    plate = Box(np.array([60, 20, 4]) * MM, Pose(np.array([0, 0, 2]) * MM), "plate")
    holes = [Hole(3.3 * MM, 4 * MM, pose_body_shape=Pose(np.array([x, 0, 4]) * MM), in_=["plate"]) for x in (-20, 20)]
    sheets = [Box(np.array([100, 60, 10]) * MM, Pose(np.array([0, 0, z]) * MM)) for z in (-5, 9.01)]
    bolts = [Cylinder(3 * MM, 20 * MM, Pose(np.array([x, 0, 2]) * MM)) for x in (-20, 20)]
    scene = Scene(Object(shapes=[plate, *holes]), Cage(shapes=[*sheets, *bolts]), DOWN)
    ends = play(scene, search_s=0.0).freedoms["x"]
    for end in (ends.low, ends.high):
        assert [end.reached, len(end.clearances)] == pytest.approx([math.copysign(0.3 * MM, end.reached), 2])
        for clearance in end.clearances:
            assert (clearance.closing, clearance.opening) == pytest.approx((1.0, 0.0), abs=0.01)


def test_a_ball_amid_six_balls_goes_between_three_of_them_and_turns_for_ever():
    """A ball of 10 mm amid balls of 5 mm that are 0.2 mm away. By hand, it goes farthest along x where it touches
    three, at (x, x, x) with 3 x^2 - 2 d x + d^2 - 15^2 = 0, d = 15.2; on top of one of them it comes to 0.2 alone."""
    around = [Sphere(5 * MM, Pose(np.array(axis) * sign * 15.2 * MM)) for axis in np.eye(3) for sign in (-1, 1)]
    found = play(Scene(Object(shapes=[Sphere(10 * MM)]), Cage(shapes=around), DOWN), search_s=0.1)
    farthest = (15.2 - math.sqrt(15.2**2 - 3 * (15.2**2 - 15**2))) / 3
    assert farthest > 0.202
    for name in "xyz":
        ends = found.freedoms[name]
        assert (ends.low.exact, ends.high.exact) == pytest.approx((-farthest * MM, farthest * MM), rel=1e-9)
    assert all(found.freedoms[name].high.is_open for name in ("roll", "pitch", "yaw"))
    assert found.cage.verdict == "not certified"
    assert found.cage.reason.startswith("bounds can be proven only for boxes of the object")


def test_the_way_out_is_free_and_leads_out():
    """Over a sill, where it tips, below a high lid."""
    sill = Capsule(3 * MM, 60 * MM, Pose(np.array([14, 0, -7]) * MM, (math.sqrt(0.5), math.sqrt(0.5), 0, 0)), "sill")
    lid = Box(np.array([100, 100, 10]) * MM, Pose((0, 0, 45 * MM)), "lid")
    scene = walled(("floor", "left", "front", "back"), [lid, sill])
    found = play(scene, search_s=0.0)
    assert found.cage.verdict == "escapes"
    assert found.cage.reason.startswith("pushed ")
    assert found.cage.reason.endswith("it gets out")
    assert found.freedoms["x"].high.is_open
    assert found.cage.path
    for step in found.cage.path:
        pose = step.pose_world_object
        there = {"position": pose.position_m.tolist(), "quat_wxyz": pose.quaternion_wxyz.tolist()}
        outside = scene.changed("object.pose", there)  # is refused where anything overlaps
    assert run(Scene(outside.object, outside.cage, [ALONG_X, UP])).verdict == "escapes"


WALLS = {
    "floor": ((100, 100, 10), (0, 0, -15)),
    "left": ((10, 60, 20), (-16, 0, 0.2)),
    "right": ((10, 60, 20), (18, 0, 0.2)),
    "back": ((80, 10, 20), (0, 17, 0.2)),
    "front": ((80, 10, 20), (0, -17, 0.2)),
}
"""Sizes and middles, mm: around a cube of 20 mm on the floor, 1 and 3 mm away along x, 2 mm along y."""


def walled(names: Iterable[str], others: Iterable[Shape] = ()) -> Scene:
    walls = [Box(np.array(WALLS[name][0]) * MM, Pose(np.array(WALLS[name][1]) * MM), name) for name in names]
    return Scene(Object([Box((20 * MM,) * 3)]), Cage(shapes=[*walls, *others]), DOWN, friction_coefficient=0.3)


def test_what_is_heavy_on_one_side_is_lifted_straight_out():
    """By its origin it turns at once, and catches on the walls."""
    arm = Box(np.array([60, 10, 5]) * MM, Pose(np.array([40, 0, 13]) * MM))
    cube = walled(WALLS)
    found = play(Scene(Object([*cube.object.boxes, arm]), cube.cage, DOWN), search_s=0.0)
    assert (found.cage.verdict, found.cage.reason) == ("escapes", "pushed along +z, it gets out")
    assert found.freedoms["z"].high.is_open


def test_why_a_room_that_pushes_do_not_leave_is_not_proven_to_be_closed():
    """A cube of 10 mm with 1 mm on every side, and a window of 9.99 mm: points of its frame alone do not close it."""
    walls = {
        "left": ((10, 60, 60), (-11, 0, 0)),
        "front": ((60, 10, 60), (0, -11, 0)),
        "back": ((60, 10, 60), (0, 11, 0)),
        "floor": ((60, 60, 10), (0, 0, -11)),
        "lid": ((60, 60, 10), (0, 0, 11)),
        "above": ((10, 60, 60), (11, 0, 34.995)),
        "below": ((10, 60, 60), (11, 0, -34.995)),
    }
    room = [Box(np.array(size) * MM, Pose(np.array(middle) * MM), name) for name, (size, middle) in walls.items()]
    found = play(Scene(Object([Box((10 * MM,) * 3)]), Cage(shapes=room), DOWN), search_s=0.1)
    assert not found.cage.free_directions
    assert found.cage.reason.startswith("the proof takes points within the cage's shapes")


def test_a_seated_cube_goes_to_the_walls_and_not_up():
    found = play(walled(WALLS), seated="weight")
    assert found.cage is None
    assert found.verdict == "seated"
    known = {"x": (-1, 3), "y": (-2, 2), "z": (0, 0)}
    for name, ends in known.items():
        pair = found.freedoms[name]
        assert (pair.low.exact, pair.high.exact) == pytest.approx(np.array(ends) * MM, abs=1e-9)
    for name in ("roll", "pitch"):
        assert found.freedoms[name].high.exact == pytest.approx(0.0, abs=1e-9)
    assert found.freedoms["yaw"].high.exact > math.radians(5)


def test_seats_are_phases_that_come_to_rest():
    scene = walled(["floor"])
    with pytest.raises(SceneError, match="give one of them"):
        play(scene, seated="wind")
    lifted = Scene(scene.object, scene.cage, [UP])
    assert run(lifted).verdict == "escapes"
    with pytest.raises(SceneError, match="does not come to rest"):
        play(lifted, seated="up")


def test_a_seat_that_friction_alone_keeps_is_refused():
    slope = Load("down the slope", gravity=(0.2, 0, -1))
    held = walled(["floor"])
    scene = Scene(held.object, held.cage, [slope], friction_coefficient=0.3)
    assert run(scene).verdict == "rests"
    with pytest.raises(SceneError, match="friction alone keeps it there"):
        play(scene, seated="down the slope")


def test_a_shaft_that_is_held_in_its_bore_does_not_get_out():
    """A push along the wall, from where another push has brought it to the wall, led through it."""
    block, lid = Box(np.array([100, 100, 12]) * MM, name="block"), np.array([100, 100, 4]) * MM
    ends = [Box(lid, Pose((0, 0, side * 8.2 * MM))) for side in (-1, 1)]
    bore = Hole(5.1 * MM, 12 * MM, in_=["block"], pose_body_shape=Pose((0, 0, 6 * MM)))
    shaft = Object(shapes=[Cylinder(5 * MM, 12 * MM)])
    found = play(Scene(shaft, Cage(shapes=[block, *ends], holes=[bore]), DOWN), search_s=0.0)
    assert found.cage.verdict == "not certified"
    for name, far in (("x", 0.1), ("y", 0.1), ("z", 0.2)):
        pair = found.freedoms[name]
        assert (pair.low.reached, pair.high.reached) == pytest.approx((-far * MM, far * MM), abs=1e-9)
    assert found.freedoms["yaw"].high.is_open
