"""First contact of parts with sharp or rounded edges, against safe steps by the distances of `convex_bodies`, and in
closed form.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from boundary.asked import Asked
from boundary.motions import TOUCH, motion_of, random_motion, random_offset
from boundary.test_first_to_meet import Tally
from boundary.test_first_to_meet import check as check_first
from cagepose import Box, Pose
from cagepose.kernels.algebra.motion import Motion
from cagepose.kernels.boundary.first_meeting import Hit
from cagepose.model.shapes import Convex, Sphere
from shapes.convex_bodies import CUBE, body_of, gap, placed_at, random_part, random_turn
from shapes.shape_scenes import changed

SLAB, CUBE_2 = Box((4.0, 4.0, 2.0), Pose((0, 0, -1))), Box((2.0, 2.0, 2.0))
DOWN = motion_of(np.zeros(3), np.array((0.0, 0.0, -1.0)), 0.0, np.zeros(3))


def told_of(part, cage_part, pose: Pose, motion: Motion, end: float) -> tuple[Hit | None, str]:
    """Ask the first contact of two parts, and what is wrong with it."""
    body, other = body_of(part), body_of(cage_part)
    asked = Asked([part], [cage_part], TOUCH * max(body.size, other.size))
    return check_first(asked, pose, motion, end, lambda at: gap(body.at(at), other))


def check(part, cage_part, pose: Pose, motion: Motion, end: float) -> Hit | None:
    """Ask the first contact of two parts, and whether it is one, and none comes before."""
    hit, told = told_of(part, cage_part, pose, motion, end)
    assert not told
    return hit


def test_motions_of_sharp_and_rounded_parts(cases, say):
    rng, tally = np.random.default_rng(3), Tally()
    for _ in range(cases(30, 2600)):
        scale = float(rng.choice([1.0, 1.0, 1e-3, 1e3]))
        part, cage_part = (changed(random_part(rng), scale) for _ in range(2))
        body, other = body_of(part), body_of(cage_part)
        size = max(body.size, other.size)
        away = float(rng.choice([0.5, 0.2, 0.05, 1e-2, 1e-3, 1e-5, 1e-7, 0.0])) * size
        pose = placed_at(body, other, random_turn(rng), random_offset(rng), away)
        towards = other.corners.mean(axis=0) - body.at(pose).corners.mean(axis=0)
        motion, end = random_motion(rng, pose, towards, size), float(rng.choice([0.1, 1.0, 3.0]))
        hit, told = told_of(part, cage_part, pose, motion, end)
        tally.note(hit, end, told, (part, pose, cage_part, motion, end))
    tally.conclude("sharp and rounded parts", say)


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
def test_a_cube_falls_on_a_slab(turn, offset, height, radius):
    cube = Convex(CUBE, radius)
    pose = Pose((*offset, 5.0), euler_zyx=turn)
    hit = check(cube, SLAB, pose, DOWN, 10.0)
    if offset != (3.0, 3.0) or radius == 0.1:  # sharp corners may pass each other
        assert hit.amount == pytest.approx(5.0 - height - radius, abs=1e-8)


@pytest.mark.parametrize("radius", [1e-13, 1e-12, 1e-10, 1e-6])
@pytest.mark.parametrize("drop", [3.0, 300.0, 12345.6])
def test_edges_that_are_hardly_rounded_cross_after_the_way_between_them(radius, drop):
    """Two roots, as near as the radius: their discriminant is less than the rounding of its terms."""
    above, below = (Convex(Pose(euler_zyx=turn).transform(CUBE), radius) for turn in ((0, 0.3, 0), (0, 0, 0.7)))
    lowest, highest = -above.vertices_m[:, 2].min(), below.vertices_m[:, 2].max()
    hit = check(above, below, Pose((0.01, 0.02, drop + lowest + highest)), DOWN, 2.0 * drop)
    assert hit.amount == pytest.approx(drop - 2.0 * radius, abs=1e-9 * drop)


@pytest.mark.parametrize("near", [1e-4, 1e-5, 1e-6])
@pytest.mark.parametrize("axis", [(0, 1, 0), (1, 0, 0), (0.6, 0.8, 0)])
def test_edges_that_are_hardly_rounded_and_turn_slowly_meet_where_they_touch(near, axis, cases):
    """Half of them met up to 3e4 touch tolerances early, or not at all, when the search had used up its steps."""
    above = Convex(Pose(euler_zyx=(0, math.pi / 4, 0)).transform(CUBE), 1e-12)
    below = Convex(Pose(euler_zyx=(math.pi / 2, math.pi / 4, 0)).transform(CUBE))
    pose = Pose((0, 0, 2.0 * math.sqrt(2.0) + near))
    for aside in np.geomspace(1e-4, 3e-2, 8)[:: 8 // min(8, cases(2, 40))]:
        for sign in (-1.0, 1.0):
            center = np.array((sign * aside, 0.7 * sign * aside, -1.0))
            check(above, below, pose, motion_of(center, np.zeros(3), 1.0, np.array(axis, dtype=float)), 1.0)


def test_a_cube_that_tips_over_its_edge_lands_on_its_face():
    """Its lower edge touches, and turns where it is; the face lands after the angle that it was raised by."""
    angle = 0.3
    pose = Pose((0.0, 0.0, math.sqrt(2.0) * math.sin(np.pi / 4 + angle)), euler_zyx=(0, angle, 0))
    corners = pose.transform(CUBE)
    lowest = corners[np.isclose(corners[:, 2], 0.0, atol=1e-9)].mean(axis=0)
    asked = Asked([CUBE_2], [SLAB], 4e-9)
    assert asked.place(pose).used[0] >= 2
    for turn, lands in ((-1.0, angle), (1.0, np.pi / 2.0 - angle)):
        motion = motion_of(lowest, np.zeros(3), 1.0, np.array((0.0, turn, 0.0)))
        hit = asked.first(motion, 2.0)
        assert hit.amount == pytest.approx(lands, abs=1e-8)


def test_a_ball_slides_along_a_floor_into_a_wall():
    ball, wall = Sphere(1.0), Box((1.0, 4.0, 4.0), Pose((5.5, 0, 2)))
    asked = Asked([ball], [SLAB, wall], 5e-9)
    asked.place(Pose((0, 0, 1.0)))
    hit = asked.first(motion_of(np.zeros(3), np.array((1.0, 0.0, 0.0)), 0.0, np.zeros(3)), 10.0)
    assert hit.amount == pytest.approx(4.0, abs=1e-12)
    assert asked.cage.own.features[hit.cage_feature].part == 1


@pytest.mark.parametrize("play", [1e-3, 1e-6, 1e-8])
def test_a_bar_turns_in_a_slot_until_its_corners_touch(play):
    """Length 2 a, width 2 b, in a slot of width 2 b + 2 p: a sin t + b cos t = b + p."""
    a, b = 2.0, 0.25
    bar = Box((2 * a, 2 * b, 1.0))
    walls = [Box((8.0, 1.0, 1.0), Pose((0, side * (b + play + 0.5), 0))) for side in (1, -1)]
    asked = Asked([bar], walls, 1e-9)
    asked.place(Pose())
    hit = asked.first(motion_of(np.zeros(3), np.zeros(3), 1.0, np.array((0.0, 0.0, 1.0))), 1.0)
    assert a * math.sin(hit.amount) + b * math.cos(hit.amount) == pytest.approx(b + play, abs=1e-12)


def test_edges_that_begin_parallel_do_not_touch_where_their_lines_cross():
    """Two boxes are in line with each other at first, and a thousandth of their size apart."""
    part, cage_part = Box((0.000568673, 0.000213907, 0.0009823)), Box((0.00055105, 0.000914763, 0.000514868))
    pose = Pose((0.000767347, 0.0, -0.000365364), (0.5, 0.5, 0.5, 0.5))
    axis = np.array((-0.6828572797330864, -0.24960590801563143, 0.6865878139023598))
    center = np.array((0.0008319189332212737, 0.000717186997976134, -0.0020505198662423836))
    hit = check(part, cage_part, pose, motion_of(center, np.zeros(3), 1.0437845456989039, axis), 0.1)
    assert hit is not None
    assert hit.amount == pytest.approx(0.005, abs=0.001)
