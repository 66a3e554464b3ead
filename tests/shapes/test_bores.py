"""Round parts in a bore that is a little wider, pushed across it, one push after the other: each ends where the wall
faces it, within the angle of friction. On the way they slide around along the wall, and some pushes begin along it or
away from it.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from cagepose import Box, Cage, Capsule, Cylinder, Force, Hole, Load, Object, Pose, Scene, Sphere, run
from cagepose.model.shapes import Shape
from quasistatic.paths import path_of

DEPTH = 0.012
PARTS: tuple[tuple[Shape, float, float], ...] = (
    (Cylinder(0.005, 0.004), 0.005, 0.002),
    (Cylinder(0.003, DEPTH), 0.003, 0.5 * DEPTH),
    (Sphere(0.004), 0.004, 0.004),
    (Capsule(0.004, 0.003), 0.004, 0.0055),
)
"""With their radius and half of their height: flat, as long as the bore is deep, round, and round at its ends."""
WIDER = (1e-3, 1e-4, 5e-5, 1e-5)
FLOOR = Box((0.1, 0.1, 0.01), Pose((0.0, 0.0, -0.5 * DEPTH - 0.005)), name="floor")


def pushed(part: tuple[Shape, float, float], play: float, ways: list[float], friction: float, on_floor: bool) -> Scene:
    shape, radius, half = part
    bore = Hole(radius + play, DEPTH, in_=["block"], pose_body_shape=Pose((0, 0, 0.5 * DEPTH)), name="bore")
    weight = (0.0, 0.0, -1.0) if on_floor else None
    loads = [Load("weight", gravity=weight)] if on_floor else []
    for number, way in enumerate(ways):
        force = Force((math.cos(way), math.sin(way), 0.0), (0.0, 0.0, 0.0))
        loads.append(Load(f"push {number}", gravity=weight, force=force))
    start = Pose((0.0, 0.0, half - 0.5 * DEPTH if on_floor else 0.0))
    solids = [Box((0.1, 0.1, DEPTH), name="block"), *([FLOOR] if on_floor else [])]
    held = Object(shapes=[shape], pose=start, mass_kg=0.1)
    return Scene(held, Cage(shapes=solids, holes=[bore]), loads, friction_coefficient=friction)


def test_parts_in_a_bore_end_where_its_wall_faces_the_push(cases, say):
    rng, wrong, verdicts = np.random.default_rng(7), [], {}
    n_scenes = cases(40, 100)
    for number in range(n_scenes):
        play, friction = float(rng.choice(WIDER)), float(rng.choice([0.0, 0.0, 0.2]))
        quarters, n_pushes = rng.random() < 0.6, int(rng.integers(1, 4))
        ways = rng.integers(0, 8, n_pushes) * math.pi / 4.0 if quarters else rng.uniform(0.0, 2.0 * math.pi, n_pushes)
        part = PARTS[rng.integers(len(PARTS))]
        result = run(pushed(part, play, list(map(float, ways)), friction, bool(rng.random() < 0.6)))
        verdicts[result.verdict] = verdicts.get(result.verdict, 0) + 1
        x, y = result.pose.position_m[:2]
        off = abs(math.remainder(math.atan2(y, x) - float(ways[-1]), 2.0 * math.pi))
        if result.verdict not in ("rests", "may rest") or off > math.atan(friction) + 1e-6:
            wrong.append(
                f"{number}: {part[0]}, play {play}, {ways}, friction {friction}: {result.verdict}, {off} rad off"
            )
        elif abs(math.hypot(x, y) - play) > 1e-11:
            wrong.append(f"{number}: {part[0]}, play {play}, {ways}: {math.hypot(x, y)} m beside the axis")
    say(f"{n_scenes} parts pushed in bores: {verdicts}, {len(wrong)} wrong")
    assert not wrong, "\n".join(wrong[:5])


def test_a_part_goes_around_a_narrow_clearance_in_few_steps():
    """A quarter turn of the wall's normal on a way of 0.08 mm: by steps of 0.02 rad, and shorter ones where the place
    of contact passes from arc to arc of the rims, it took 1,013 poses.
    """
    result = run(pushed(PARTS[0], 5e-5, [0.0, 1.5], 0.0, True))
    assert result.verdict == "rests"
    assert len(path_of(result.phases[-1])) <= 40


@pytest.mark.parametrize("part", PARTS)
@pytest.mark.parametrize("play", WIDER)
def test_a_part_crosses_the_bore_from_wall_to_wall(part, play: float) -> None:
    """It begins on the one wall, at a distance of zero, and meets the other in the same search."""
    result = run(pushed(part, play, [1.25 * math.pi, math.pi, 0.0], 0.0, True))
    assert result.verdict == "rests"
    assert result.pose.position_m[:2] == pytest.approx([play, 0.0], abs=1e-10)


@pytest.mark.parametrize(
    ("radius", "depth", "push", "size", "friction"),
    [
        (0.49, 1.0, (0.6766, 0.2385, 0.6967), 0.2, 0.1),
        (0.45, 0.5, (-0.9674, -0.1596, -0.1965), 0.6, 0.3),
        (0.45, 1.0, (1.0, 0.0, 0.0), 0.3, 0.1),
        (0.49, 0.5, (0.0, -1.0, 0.0), 0.2, 0.2),
    ],
)
def test_a_peg_that_stands_in_a_bore_with_friction_is_pushed_to_its_wall_and_no_farther(
    radius: float, depth: float, push: tuple[float, float, float], size: float, friction: float
) -> None:
    """It slides on its flat end, borne by points of the rim between those that are listed. What these have no place for
    at the end of a step excuses nothing that is met before it; and the proof balances the load with them, too.
    """
    plate = Box((6.0, 6.0, depth + 1.0), Pose((0.0, 0.0, -0.5 * depth - 0.5)), name="plate")
    weight = (0.0, 0.0, -1.0)
    loads = [Load("weight", gravity=weight), Load("push", gravity=weight, force=Force(push, (0.1, 0.05, 0.3), size))]
    start = Pose((0.004 * (radius > 0.46), 0.003, 1.0 - depth))
    held = Object(shapes=[Cylinder(radius, 2.0)], center_of_gravity_m=(0, 0, 0), mass_kg=1.0, pose=start)
    bore = Hole(0.5, depth, in_=["plate"])
    result = run(Scene(held, Cage(shapes=[plate], holes=[bore]), loads, friction_coefficient=friction))
    assert result.phases[0].verdict == "rests"
    assert result.verdict in ("rests", "may rest")
    x, y = result.phases[1].pose.transform((0.0, 0.0, -1.0))[:2]
    assert math.hypot(x, y) <= 0.5 - radius + 1e-9


def test_pegs_that_stand_in_a_bore_are_pushed_over_to_its_wall(cases, say) -> None:
    """With friction a peg tips about one point of its flat end, between those that are listed."""
    rng, verdicts = np.random.default_rng(3), {}
    n_pegs = cases(10, 300)
    for _ in range(n_pegs):
        radius, friction, around = float(rng.uniform(0.005, 0.02)), float(rng.uniform(0.2, 0.9)), rng.uniform(0.0, 6.28)
        length = radius * float(rng.uniform(1.0, 6.0))
        depth, play = length * float(rng.uniform(0.2, 0.8)), radius * 10.0 ** float(rng.uniform(-2.5, -0.7))
        way = (math.cos(around), math.sin(around), -float(rng.uniform(0.1, 2.0)))
        push = Force(way, (*rng.uniform(-radius, radius, 2), length * float(rng.uniform(-0.5, 0.5))))
        peg = Object(shapes=[Cylinder(radius, length)], pose=Pose((0, 0, length / 2 - depth)))
        block = Box((8 * radius, 8 * radius, 2 * depth), Pose((0, 0, -depth)), "block")
        bore = Cage(shapes=[block], holes=[Hole(radius + play, depth, in_=["block"])])
        loads = [Load("weight", gravity=(0, 0, -1)), Load("push", forces=[push])]
        verdict = run(Scene(peg, bore, loads, friction_coefficient=friction)).verdict
        verdicts[verdict] = verdicts.get(verdict, 0) + 1
    say(f"{n_pegs} pegs pushed over in bores: {verdicts}")
    assert verdicts.get("limit", 0) + verdicts.get("stalled", 0) <= 1 + n_pegs // 50


def test_a_can_on_the_floor_tips_about_the_point_of_its_rim_ahead_of_the_push() -> None:
    """Friction holds its foot: it turns about the tangent of the rim where the push leads over it, to the 3e-5 rad that
    a point of the rim may be beside the deepest one, which goes in with the square of that.
    """
    radius, height, around = 0.03, 0.12, 0.2
    ahead = np.array([math.cos(around), math.sin(around), 0.0])
    can = Object(shapes=[Cylinder(radius, height)], mass_kg=1.0, pose=Pose((0, 0, height / 2)))
    load = Load("push", gravity=(0, 0, -1), force=Force(ahead, (0, 0, height / 2), 0.4))
    floor = Box((2.0, 2.0, 0.1), Pose((0, 0, -0.05)))
    motion = run(Scene(can, Cage(shapes=[floor]), [load], friction_coefficient=0.8)).phases[0].events[0]
    first = motion.path[1]
    moved = first.transform((0.0, 0.0, -height / 2) + radius * ahead)
    assert moved == pytest.approx(radius * ahead, abs=1e-9)
    tilt = first.rotation[:, 2]
    assert math.atan2(tilt[1], tilt[0]) == pytest.approx(around, abs=3e-5)
