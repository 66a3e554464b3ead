"""The work of checking a scene grows about as its parts do: four times as many take not much more than four times."""

from __future__ import annotations

import sys
from itertools import combinations

import numpy as np
import pytest

from cagepose import Box, Cage, Convex, Hole, Load, Object, Pose, Scene, SceneError, Sphere
from cagepose.model.near_pairs import near_pairs
from cagepose.model.parts import MOST_PAIRS
from cagepose.runs.actions import load_size

DOWN = Load("weight", gravity=(0, 0, -9.81))
FLOOR = Cage(shapes=[Box((50, 50, 1), Pose((0, 0, -2)), name="floor")])
LINEAR = 4.0


def steps_of(call):
    """How many bytecodes of Python are run."""
    n_steps = 0

    def traced(frame, event, _):
        nonlocal n_steps
        frame.f_trace_opcodes, frame.f_trace_lines = True, False
        n_steps += event == "opcode"
        return traced

    before = sys.gettrace()
    sys.settrace(traced)
    try:
        call()
    finally:
        sys.settrace(before)
    return n_steps


def wall(n):
    """Cubes in rows of ten, each flush with those beside it."""
    places = [(index % 10, 0, index // 10) for index in range(n)]
    return Scene(Object([Box((1, 1, 1), Pose(place)) for place in places]), FLOOR, [DOWN])


def balls(n):
    places = [(2.0 * (index % 10), 0, 2.0 * (index // 10)) for index in range(n)]
    return Scene(Object(shapes=[Sphere(1.0, Pose(place)) for place in places]), FLOOR, [DOWN])


def perforated(n):
    plate = Box((100, 400, 1), Pose((45, 150, 0)), name="plate")
    holes = [
        Hole(2.0, 1.0, pose_body_shape=Pose((10.0 * (index % 10), 10.0 * (index // 10), 0.5)), in_=["plate"])
        for index in range(n)
    ]
    return Scene(Object([plate], holes=holes), FLOOR, [DOWN])


def round_hull(n):
    points = np.random.default_rng(n).normal(size=(n, 3))
    ball = Convex(points / np.linalg.norm(points, axis=1, keepdims=True))
    return Scene(Object(shapes=[ball]), FLOOR, [DOWN])


def sizes_of_loads(n):
    loads = [Load(f"{index}", gravity=(0, 0, -1.0 - index)) for index in range(n)]
    scene = Scene(Object([Box((1, 1, 1))]), FLOOR, loads)
    return [load_size(scene, phase, Pose()) for phase in range(n)]


@pytest.mark.parametrize(
    ("made", "n"), [(wall, 30), (balls, 40), (perforated, 30), (round_hull, 100), (sizes_of_loads, 40)]
)
def test_four_times_as_many_take_far_less_than_sixteen_times_the_work(made, n):
    made(5)
    few, many = (steps_of(lambda count=count: made(count)) for count in (n, 4 * n))
    print(f"{made.__name__}: {few:,} steps for {n}, {many / few:.1f} times as many for {4 * n}")
    assert many / few < 1.6 * LINEAR


@pytest.mark.parametrize("seed", range(20))
def test_near_pairs_are_those_of_all_pairs_that_meet(seed):
    """Of boxes of all sizes, some of them on a grid, so that faces touch exactly."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(0, 300))
    low = rng.integers(0, 8, (n, 3)) / 1.0 if seed % 2 else rng.uniform(0.0, 8.0, (n, 3))
    high = low + (rng.integers(0, 2, (n, 3)) if seed % 2 else 10.0 ** rng.uniform(-3.0, 1.0, (n, 3)))
    meet = [
        [one, other]
        for one, other in combinations(range(n), 2)
        if (low[one] <= high[other]).all() and (low[other] <= high[one]).all()
    ]
    assert near_pairs(low, high).tolist() == meet


def test_a_crowd_is_refused_with_its_numbers():
    cubes = [Box((1, 1, 1), Pose((0.001 * index, 0, 0))) for index in range(700)]
    assert len(cubes) * (len(cubes) - 1) // 2 > MOST_PAIRS
    with pytest.raises(
        SceneError, match="has more than 200,000 pairs of parts that overlap or touch, of its 700 parts"
    ):
        Object(cubes)
