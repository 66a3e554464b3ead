"""Parts as people draw them, at the same height and with the same tangent, and in the corners of holes."""

from __future__ import annotations

import math
from collections.abc import Sequence

import pytest

from cagepose import (
    Box,
    Cage,
    Convex,
    Cylinder,
    Force,
    Hole,
    Load,
    Object,
    Pose,
    Run,
    Scene,
    run,
)
from cagepose.model.shapes import Shape

MM = 1e-3
PLATE = Box((0.1, 0.1, 0.02), Pose((0.0, 0.0, -0.01)), name="plate")
WIDE = Box((0.2, 0.2, 0.02), Pose((0.0, 0.0, -0.01)), name="plate")
LEFT = Box((0.05, 0.1, 0.02), Pose((-0.025, 0.0, -0.01)), name="left")
PUCK = Cylinder(20.0 * MM, 10.0 * MM)


def bore(radius: float, depth: float, x: float = 0.0) -> Hole:
    return Hole(radius * MM, depth * MM, in_=["plate"], pose_body_shape=Pose((x * MM, 0.0, 0.0)))


def pushed(
    part: Shape, start: Sequence[float], push: tuple[float, float], solids: Sequence[Shape], holes: Sequence[Hole] = ()
) -> Run:
    """A part of 0.1 kg under its weight, then pushed level with 0.5 N."""
    loads = [
        Load("weight", gravity=(0, 0, -1)),
        Load("push", gravity=(0, 0, -1), force=Force((*push, 0), (0, 0, 0), 0.5)),
    ]
    held = Object(shapes=[part], pose=Pose([MM * value for value in start]), mass_kg=0.1)
    return run(Scene(held, Cage(shapes=solids, holes=holes), loads))


@pytest.mark.parametrize("holes", [[bore(5, 20)], [bore(5, 20, -15.0), bore(5, 20, 15.0)]], ids=["one", "two"])
@pytest.mark.parametrize("push", [(0.0, 1.0), (1.0, 0.0), (-0.6, 0.8)])
def test_a_bar_as_wide_as_the_holes_under_it_slides_off(holes, push):
    assert pushed(Box((0.05, 0.01, 0.005)), (0, 0, 9), push, [PLATE], holes).verdict == "escapes"


@pytest.mark.parametrize(
    "there", [Box((0.05, 0.1, 0.02), Pose((0.03, 0, -0.01))), Cylinder(0.025, 0.02, Pose((0.03, 0, -0.01)))]
)
@pytest.mark.parametrize("part", [PUCK, Box((0.04, 0.04, 0.01))], ids=["puck", "box"])
def test_what_slides_from_one_top_to_another_at_the_same_height_is_not_held(part, there):
    assert pushed(part, (-20, 0, 5), (1.0, 0.0), [LEFT, there]).verdict == "escapes"


@pytest.mark.parametrize(
    ("part", "there", "stop"),
    [
        (PUCK, Cylinder(25 * MM, 10 * MM, Pose((30 * MM, 0, 5 * MM))), -15.0),
        (PUCK, Box((0.02, 0.05, 0.01), Pose((30 * MM, 0, 5 * MM))), 0.0),
        (Box((0.04, 0.04, 0.01)), Cylinder(10 * MM, 10 * MM, Pose((30 * MM, 0, 5 * MM))), 0.0),
    ],
    ids=["cylinders", "puck and box", "box and pin"],
)
def test_parts_of_the_same_height_on_one_floor_hold_each_other(part, there, stop):
    result = pushed(part, (-20, 0, 5), (1.0, 0.0), [WIDE, there])
    assert result.verdict == "rests"
    assert result.pose.position_m[0] == pytest.approx(stop * MM, abs=1e-9)


@pytest.mark.parametrize("side", [10.0, 8.0, 6.0])
@pytest.mark.parametrize("way", [(1.0, 0.0), (math.sqrt(0.5), math.sqrt(0.5))], ids=["a side", "a corner"])
def test_square_pegs_in_a_blind_bore(side, way):
    """Two edges lie on the wall where a side faces the push; where a corner does, that edge alone."""
    result = pushed(Box((side * MM, side * MM, 6 * MM)), (0, 0, -3), way, [PLATE], [bore(10, 10)])
    half = 0.5 * side
    moved = math.sqrt(100.0 - half * half) - half if way[1] == 0.0 else 10.0 - half * math.sqrt(2.0)
    assert result.verdict == "rests"
    assert result.pose.position_m == pytest.approx((moved * MM * way[0], moved * MM * way[1], -7 * MM), abs=1e-9)


def test_a_square_peg_turns_a_side_to_the_push():
    result = pushed(
        Box((8 * MM, 8 * MM, 6 * MM)), (0, 0, -3), (0.928476690885259, 0.371390676354104), [PLATE], [bore(10, 10)]
    )
    assert result.verdict == "rests"
    assert math.hypot(*result.pose.position_m[:2]) == pytest.approx((math.sqrt(84.0) - 4.0) * MM, abs=1e-9)
    assert math.atan2(result.pose.rotation[1, 0], result.pose.rotation[0, 0]) == pytest.approx(math.atan(0.4), abs=1e-6)


@pytest.mark.parametrize(("push", "stop"), [((1.0, 0.0), 2.0), ((-1.0, 0.0), 5.0 - math.sqrt(69.0))])
def test_triangular_pegs_in_a_blind_bore(push, stop):
    corners = [
        (10 * MM * math.cos(angle), 10 * MM * math.sin(angle), height)
        for angle in (0.0, 2.0 * math.pi / 3.0, 4.0 * math.pi / 3.0)
        for height in (-3 * MM, 3 * MM)
    ]
    result = pushed(Convex(corners), (0, 0, -3), push, [PLATE], [bore(12, 10)])
    assert result.verdict == "rests"
    assert result.pose.position_m[0] == pytest.approx(stop * MM, abs=1e-9)
