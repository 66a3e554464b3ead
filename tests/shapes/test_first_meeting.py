"""First contact of parts along travels, turns and screws, against safe steps by the distances of `convex_bodies`."""

from __future__ import annotations

import math

import numpy as np
import pytest
from cagepose.kernels.collision.first_meeting import Hit, first_meeting

from cagepose import Box, Pose
from cagepose.kernels.shapes.motion import Motion
from cagepose.model.features import shapes_of
from cagepose.model.shapes import Convex, Sphere
from inner_kernels import as_machine_code
from shapes.convex_bodies import CUBE, body_of, gap, placed_at, random_part, random_turn
from shapes.shape_scenes import changed
from shapes.test_distances import TOUCH, geometry_of, placed, random_offset

TOLERANCE = 4.0
"""Touch tolerances: how deep parts may be where nothing was met, and how far apart where something was."""
SHORTEST = 1e-4
"""Fraction of a motion. Sampling that creeps along a contact goes on by this."""


@pytest.fixture(scope="module")
def first():
    return as_machine_code(first_meeting)


def after(motion: Motion, pose: Pose, amount: float) -> Pose:
    """A pose after an amount of a motion: a turn about the axis that stays, and a travel along it."""
    center, velocity = np.array(motion.center), np.array(motion.velocity)
    if motion.rate == 0.0:
        return Pose(pose.position_m + velocity * amount, pose.quaternion_wxyz)
    axis, angle = np.array(motion.axis), motion.rate * amount
    through = center + np.cross(axis, velocity) / motion.rate
    turn = Pose((0, 0, 0), (math.cos(angle / 2.0), *(math.sin(angle / 2.0) * axis)))
    position = through + turn.transform(pose.position_m - through) + axis * (axis @ velocity) * amount
    return Pose(position, (turn @ Pose((0, 0, 0), pose.quaternion_wxyz)).quaternion_wxyz)


def motion_of(center: np.ndarray, velocity: np.ndarray, rate: float, axis: np.ndarray) -> Motion:
    return Motion(tuple(center.tolist()), tuple(velocity.tolist()), rate, tuple(axis.tolist()))


def random_direction(rng: np.random.Generator) -> np.ndarray:
    if rng.random() < 0.4:
        return np.eye(3)[rng.integers(3)] * rng.choice([-1.0, 1.0])
    direction = rng.normal(size=3)
    return direction / np.linalg.norm(direction)


def random_motion(rng: np.random.Generator, pose: Pose, towards: np.ndarray, size: float) -> Motion:
    kind = rng.choice(["travel", "turn", "screw"])
    center, velocity, axis, rate = pose.position_m, np.zeros(3), np.zeros(3), 0.0
    if kind != "turn":
        aimed = towards + rng.normal(size=3) * 0.3 * size
        velocity = aimed if rng.random() < 0.5 else random_direction(rng) * size
    if kind != "travel":
        axis, rate = random_direction(rng), float(rng.uniform(0.1, 2.0))
    if kind == "turn":
        center = center + rng.normal(size=3) * size * rng.choice([0.0, 1.0])
    return motion_of(center, velocity, rate, axis)


def leaves(motion: Motion, meetings) -> bool:
    """Whether a motion leads away at all places where parts touch, clearly."""
    for row in meetings.rows[: meetings.used[0]]:
        away = np.array(motion.velocity) + np.cross(
            motion.rate * np.array(motion.axis), row["place"] - np.array(motion.center)
        )
        if away @ row["normal"] > -1e-5 * np.linalg.norm(away):
            return False
    return True


def fastest(motion: Motion, body) -> float:
    """A speed that no point of a body exceeds."""
    middle = body.corners.mean(axis=0)
    reach = np.linalg.norm(body.corners - middle, axis=1).max() + body.radius
    spin = motion.rate * np.array(motion.axis)
    drift = np.array(motion.velocity) + np.cross(spin, middle - np.array(motion.center))
    return float(np.linalg.norm(drift) + motion.rate * reach)


def check(first, part, cage_part, pose: Pose, motion: Motion, end: float) -> Hit | None:
    """Ask the first contact, and whether it is one, and none comes before; None: parts that touch do not all leave."""
    body, other = body_of(part), body_of(cage_part)
    size = max(body.size, other.size)
    touch_m = TOUCH * size
    geometry = geometry_of(shapes_of([part]), shapes_of([cage_part]), touch_m)
    placement = placed(geometry, pose)
    if placement.meetings.used[0] > 0 and not leaves(motion, placement.meetings):
        return None
    hit = Hit(*first(geometry, placement, motion, end, 0.0, 0.0))
    until = min(hit.amount, end)
    told = f"{part} at {pose}, {cage_part}, {motion} to {end}: {hit}"
    amount, speed = 0.0, fastest(motion, body.at(pose))
    while amount < until * (1.0 - 1e-9):
        apart = gap(body.at(after(motion, pose, amount)), other)
        assert apart >= -TOLERANCE * touch_m, f"{told}; deep by {-apart / touch_m} touch tolerances at {amount}"
        amount += max(apart / speed, SHORTEST * end)
    there = gap(body.at(after(motion, pose, until)), other)
    assert there >= -TOLERANCE * touch_m, told
    if hit.amount <= end:
        assert there <= TOLERANCE * touch_m, f"{told}; {there / touch_m} touch tolerances too early"
    return hit


def test_random_motions(first, cases, say):
    rng = np.random.default_rng(3)
    n_cases, seen = cases(30, 2600), {"met": 0, "not met": 0, "pressed": 0}
    for _ in range(n_cases):
        scale = float(rng.choice([1.0, 1.0, 1e-3, 1e3]))
        part, cage_part = (changed(random_part(rng), scale) for _ in range(2))
        body, other = body_of(part), body_of(cage_part)
        size = max(body.size, other.size)
        away = float(rng.choice([0.5, 0.2, 0.05, 1e-2, 1e-3, 1e-5, 1e-7, 0.0])) * size
        pose = placed_at(body, other, random_turn(rng), random_offset(rng), away)
        towards = other.corners.mean(axis=0) - body.at(pose).corners.mean(axis=0)
        motion, end = random_motion(rng, pose, towards, size), float(rng.choice([0.1, 1.0, 3.0]))
        hit = check(first, part, cage_part, pose, motion, end)
        seen["pressed" if hit is None else "met" if hit.amount <= end else "not met"] += 1
    say(f"first contact of {n_cases} motions: {seen}")


SLAB, CUBE_2 = Box((4.0, 4.0, 2.0), Pose((0, 0, -1))), Box((2.0, 2.0, 2.0))
DOWN = motion_of(np.zeros(3), np.array((0.0, 0.0, -1.0)), 0.0, np.zeros(3))


@pytest.mark.parametrize("radius", [0.0, 1e-12, 0.1])
@pytest.mark.parametrize(
    ("turn", "offset", "height"),
    [
        ((0, 0, 0), (0, 0), 1.0),  # face on face
        ((0.3, 0, 0), (0, 0), 1.0),
        ((0, np.pi / 4, 0), (0, 0), math.sqrt(2.0)),  # edge on face
        ((0, np.arctan(math.sqrt(0.5)), np.pi / 4), (0, 0), math.sqrt(3.0)),  # corner on face
        ((0, 0, 0), (3.0, 3.0), 1.0),  # corner over corner
        ((0, 0, 0), (2.9999999, 0), 1.0),  # edge on edge
    ],
)
def test_a_cube_falls_on_a_slab(first, turn, offset, height, radius):
    cube = Convex(CUBE, radius)
    pose = Pose((*offset, 5.0), euler_zyx=turn)
    hit = check(first, cube, SLAB, pose, DOWN, 10.0)
    if offset != (3.0, 3.0) or radius == 0.1:  # sharp corners may pass each other
        assert hit.amount == pytest.approx(5.0 - height - radius, abs=1e-8)


@pytest.mark.parametrize("radius", [1e-13, 1e-12, 1e-10, 1e-6])
@pytest.mark.parametrize("drop", [3.0, 300.0, 12345.6])
def test_edges_that_are_hardly_rounded_cross_after_the_way_between_them(first, radius, drop):
    """Two roots, as near as the radius: their discriminant is less than the rounding of its terms."""
    above, below = (Convex(Pose(euler_zyx=turn).transform(CUBE), radius) for turn in ((0, 0.3, 0), (0, 0, 0.7)))
    lowest, highest = -above.vertices_m[:, 2].min(), below.vertices_m[:, 2].max()
    hit = check(first, above, below, Pose((0.01, 0.02, drop + lowest + highest)), DOWN, 2.0 * drop)
    assert hit.amount == pytest.approx(drop - 2.0 * radius, abs=1e-9 * drop)


@pytest.mark.parametrize("near", [1e-4, 1e-5, 1e-6])
@pytest.mark.parametrize("axis", [(0, 1, 0), (1, 0, 0), (0.6, 0.8, 0)])
def test_edges_that_are_hardly_rounded_and_turn_slowly_meet_where_they_touch(first, near, axis, cases):
    """Half of them met up to 3e4 touch tolerances early, or not at all, when the search had used up its steps."""
    above = Convex(Pose(euler_zyx=(0, math.pi / 4, 0)).transform(CUBE), 1e-12)
    below = Convex(Pose(euler_zyx=(math.pi / 2, math.pi / 4, 0)).transform(CUBE))
    pose = Pose((0, 0, 2.0 * math.sqrt(2.0) + near))
    for aside in np.geomspace(1e-4, 3e-2, 8)[:: 8 // min(8, cases(2, 40))]:
        for sign in (-1.0, 1.0):
            center = np.array((sign * aside, 0.7 * sign * aside, -1.0))
            check(first, above, below, pose, motion_of(center, np.zeros(3), 1.0, np.array(axis, dtype=float)), 1.0)


def test_a_cube_that_tips_over_its_edge_lands_on_its_face(first):
    """Its lower edge touches, and turns where it is; the face lands after the angle that it was raised by."""
    angle = 0.3
    pose = Pose((0.0, 0.0, math.sqrt(2.0) * math.sin(np.pi / 4 + angle)), euler_zyx=(0, angle, 0))
    corners = pose.transform(CUBE)
    lowest = corners[np.isclose(corners[:, 2], 0.0, atol=1e-9)].mean(axis=0)
    geometry = geometry_of(shapes_of([CUBE_2]), shapes_of([SLAB]), 4e-9)
    placement = placed(geometry, pose)
    assert placement.meetings.used[0] >= 2
    for turn, lands in ((-1.0, angle), (1.0, np.pi / 2.0 - angle)):
        motion = motion_of(lowest, np.zeros(3), 1.0, np.array((0.0, turn, 0.0)))
        hit = Hit(*first(geometry, placement, motion, 2.0, 0.0, 0.0))
        assert hit.amount == pytest.approx(lands, abs=1e-8)


def test_a_ball_slides_along_a_floor_into_a_wall(first):
    ball, wall = Sphere(1.0), Box((1.0, 4.0, 4.0), Pose((5.5, 0, 2)))
    geometry = geometry_of(shapes_of([ball]), shapes_of([SLAB, wall]), 5e-9)
    placement = placed(geometry, Pose((0, 0, 1.0)))
    motion = motion_of(np.zeros(3), np.array((1.0, 0.0, 0.0)), 0.0, np.zeros(3))
    hit = Hit(*first(geometry, placement, motion, 10.0, 0.0, 0.0))
    assert (hit.amount, hit.point) == (pytest.approx(4.0, abs=1e-12), 1)


@pytest.mark.parametrize("play", [1e-3, 1e-6, 1e-8])
def test_a_bar_turns_in_a_slot_until_its_corners_touch(first, play):
    """Length 2 a, width 2 b, in a slot of width 2 b + 2 p: a sin t + b cos t = b + p."""
    a, b = 2.0, 0.25
    bar = Box((2 * a, 2 * b, 1.0))
    walls = [Box((8.0, 1.0, 1.0), Pose((0, side * (b + play + 0.5), 0))) for side in (1, -1)]
    geometry = geometry_of(shapes_of([bar]), shapes_of(walls), 1e-9)
    motion = motion_of(np.zeros(3), np.zeros(3), 1.0, np.array((0.0, 0.0, 1.0)))
    hit = Hit(*first(geometry, placed(geometry, Pose()), motion, 1.0, 0.0, 0.0))
    assert a * math.sin(hit.amount) + b * math.cos(hit.amount) == pytest.approx(b + play, abs=1e-12)


def test_edges_that_begin_parallel_do_not_touch_where_their_lines_cross(first):
    """Two boxes are in line with each other at first, and a thousandth of their size apart."""
    part, cage_part = Box((0.000568673, 0.000213907, 0.0009823)), Box((0.00055105, 0.000914763, 0.000514868))
    pose = Pose((0.000767347, 0.0, -0.000365364), (0.5, 0.5, 0.5, 0.5))
    axis = np.array((-0.6828572797330864, -0.24960590801563143, 0.6865878139023598))
    center = np.array((0.0008319189332212737, 0.000717186997976134, -0.0020505198662423836))
    hit = check(first, part, cage_part, pose, motion_of(center, np.zeros(3), 1.0437845456989039, axis), 0.1)
    assert hit is not None
    assert hit.amount == pytest.approx(0.005, abs=0.001)
