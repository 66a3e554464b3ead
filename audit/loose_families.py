"""Families of random scenes, in which a part has play or falls: each function draws one scene."""

from __future__ import annotations

import math

import numpy as np

from audit.case import FloatArray
from audit.draws import MM, Rng, any_turn, around, beside, build, direction, friction, push, weight
from cagepose import Box, Cage, Force, Load, Object, Pose, Scene

ORIGIN: FloatArray = np.zeros(3)


def near_contact(rng: Rng) -> Scene:
    """One or two boxes with points at 0 to 1e-3 mm from their faces, some before edges."""
    size = rng.uniform(10, 60, 3)
    gaps = (0.0, 1e-9, 1e-8, 3e-8, 1e-7, 1e-6, 1e-5, 1e-3)
    boxes = [(size, ORIGIN)]
    points = around(rng, size, rng.integers(0, 4, 6).tolist(), gaps)
    if rng.random() < 0.4:
        boxes.append((size * rng.uniform(0.2, 1.0, 3), rng.uniform(-0.7, 0.7, 3) * size))
    pose = any_turn(rng)
    return build(boxes, points, [weight(direction(rng))], friction(rng), pose=pose)


def grid(rng: Rng) -> Scene:
    """Whole numbers, as people draw: sizes of 20 mm, points and positions on a grid of 5 mm, loads along axes."""
    n_boxes = int(rng.integers(1, 4))
    boxes = [(_whole(rng, 1, 4, 20.0), ORIGIN)]
    boxes += [(_whole(rng, 1, 4, 20.0), _whole(rng, -4, 4, 10.0)) for _ in range(n_boxes - 1)]
    points = []
    for _ in range(int(rng.integers(4, 15))):
        size, at = boxes[rng.integers(n_boxes)]
        axis, side = int(rng.integers(3)), int(rng.choice([-1, 1]))
        point = 5.0 * np.round(rng.uniform(-0.5, 0.5, 3) * size / 5.0)
        point[axis] = side * (size[axis] / 2 + rng.choice([0.0, 0.0, 0.5, 1.0, 5.0]))
        points.append(at + point)
        if rng.random() < 0.4:
            points.append(points[-1] * (1.0, -1.0, 1.0))
    loads = [weight()]
    if rng.random() < 0.5:
        axis = np.eye(3)[rng.integers(3)] * rng.choice([-1.0, 1.0])
        loads.append(Load("push", force=Force(axis, _whole(rng, -4, 4, 5.0) * MM)))
    center = _whole(rng, -2, 2, 5.0)
    return build(boxes, np.unique(points, axis=0), loads, friction(rng), center_mm=center)


def _whole(rng: Rng, low: int, high: int, unit: float) -> FloatArray:
    """Three whole multiples of a unit."""
    return np.asarray(rng.integers(low, high + 1, 3) * unit, dtype=np.float64)


def needle(rng: Rng) -> Scene:
    """A bar 30 to 1000 times as long as it is thick, between points along it."""
    length = 10 ** rng.uniform(1.5, 3)
    size = np.array([length, rng.uniform(0.5, 2), rng.uniform(0.5, 2)])
    gaps = rng.uniform(0.01, 0.5, 8).tolist()
    counts = [*rng.integers(0, 3, 2), *rng.integers(2, 5, 4)]
    points = around(rng, size, [int(count) for count in counts], gaps)
    loads = [weight(direction(rng)), push(rng, size / 2)][: int(rng.integers(1, 3))]
    return build([(size, ORIGIN)], points, loads, friction(rng), pose=any_turn(rng))


def far_gravity(rng: Rng) -> Scene:
    """A caged box with its centre of gravity outside, 0.6 to 1000 sizes away."""
    size = rng.uniform(10, 50, 3)
    aside = rng.normal(size=3)
    center = aside / np.linalg.norm(aside) * 10 ** rng.uniform(-0.2, 3) * np.linalg.norm(size)
    points = around(rng, size, rng.integers(1, 4, 6).tolist(), rng.uniform(0, 0.3, 6).tolist())
    return build([(size, ORIGIN)], points, [weight(direction(rng))], friction(rng), center_mm=center)


def wedge(rng: Rng) -> Scene:
    """Two or three boxes turned against each other about one axis, between points that they can wedge in."""
    angle = np.radians(rng.choice([1.0, 5.0, 10.0, 30.0, 45.0]) if rng.random() < 0.5 else rng.uniform(0.5, 60))
    size = np.array([rng.uniform(20, 60), rng.uniform(5, 20), rng.uniform(10, 30)])
    turns = [Pose(euler_zyx=(sign * angle, 0.0, 0.0)) for sign in (-1, 1)]
    points = []
    for turn in turns:
        for _ in range(int(rng.integers(1, 4))):
            points.append(turn.transform(beside(rng, size, 1, int(rng.choice([-1, 1])), rng.choice([0.0, 0.1, 1.0]))))
    lids = rng.uniform(-0.4, 0.4, (6, 2)) * size[:2]
    points += [np.array([x, y, side * (size[2] / 2 + 0.1)]) for (x, y), side in zip(lids, [-1, 1] * 3, strict=True)]
    array = np.array(points)
    inside = [(np.abs(turn.inverse_transform(array)) < size / 2 - 1e-9).all(axis=1) for turn in turns]
    parts = [Box(size * MM, turn, f"box{k + 1}") for k, turn in enumerate(turns)]
    loads = [Load("pull", gravity=(*rng.choice([-1.0, 0.0, 1.0], 2), -0.1)), push(rng, size / 2)]
    kept = Cage(array[~np.any(inside, axis=0)] * MM)
    return Scene(Object(parts), kept, loads[: int(rng.integers(1, 3))], friction_coefficient=friction(rng))


def floor(rng: Rng) -> Scene:
    """A turned or flat part falls on four to twelve points at one height; sometimes a wall stands beside."""
    size = rng.uniform(10, 60, 3)
    reach = 0.5 * size[:2].max()
    rim = np.array([[x, y] for x in (-1, 1) for y in (-1, 1)]) * rng.uniform(0.3, 1.0, 2) * reach
    ground = np.vstack([rim, rng.uniform(-reach, reach, (int(rng.integers(0, 9)), 2))])
    points = np.column_stack([ground, np.zeros(len(ground))])
    if rng.random() < 0.5:
        points = np.vstack([points, [[60.0, y, z] for y in (-15.0, 15.0) for z in (5.0, 20.0)]])
    pose = Pose((0, 0, 0.06), rng.normal(size=4) if rng.random() < 0.4 else None)
    loads = [weight(np.array([rng.choice([0.0, 0.05, 0.2]), 0.0, -1.0])), push(rng, size / 2, with_weight=True)]
    center = rng.uniform(-0.3, 0.3, 3) * size
    held = Object([Box(size * MM, name="box1")], center * MM, pose=pose)
    return Scene(held, Cage(points * MM), loads[: int(rng.integers(1, 3))], friction_coefficient=friction(rng))


def many_loads(rng: Rng) -> Scene:
    """A caged box under two to four phases: weight, pushes, and both at once."""
    size = rng.uniform(20, 60, 3)
    points = around(rng, size, rng.integers(1, 4, 6).tolist(), rng.uniform(0.05, 0.5, 6).tolist())
    n_pushes = int(rng.integers(1, 4))
    pushes = [push(rng, size / 2, f"push {k + 1}", with_weight=rng.random() < 0.4) for k in range(n_pushes)]
    return build([(size, ORIGIN)], points, [weight(), *pushes], friction(rng), pose=any_turn(rng))


def any_scale(rng: Rng) -> Scene:
    """A caged box in sizes from micrometres to kilometres."""
    size = rng.uniform(10, 60, 3)
    points = around(rng, size, rng.integers(1, 4, 6).tolist(), rng.uniform(0.0, 0.4, 6).tolist())
    loads = [weight(direction(rng))]
    scale = 10 ** rng.uniform(-4.5, 4.5)
    return build([(size, ORIGIN)], points, loads, friction(rng), pose=any_turn(rng), scale=scale)


def twins(rng: Rng) -> Scene:
    """A caged box, each point with a near duplicate: 1e-7 to 1e-3 mm away along the face or across it."""
    size = rng.uniform(20, 60, 3)
    points = around(rng, size, rng.integers(1, 3, 6).tolist(), (0.0, 0.1, 0.2))
    shifts = rng.normal(size=points.shape) * 10 ** rng.uniform(-6.5, -3, (len(points), 1))
    outward = np.abs(points) > size / 2 - 1e-9
    moved = points + np.where(outward, np.sign(points) * np.abs(shifts) * rng.integers(0, 2), shifts)
    return build([(size, ORIGIN)], np.vstack([points, moved]), [weight(direction(rng))], friction(rng))


def block(rng: Rng) -> Scene:
    """A block between 8 to 18 points on its six sides, play 0.1 to 1 mm, weight and a push."""
    size = rng.uniform(20, 80, 3)
    counts = [int(count) for count in rng.multinomial(int(rng.integers(8, 19)) - 6, [1 / 6] * 6) + 1]
    points = around(rng, size, counts, rng.uniform(0.1, 1.0, 18).tolist())
    return build([(size, ORIGIN)], points, [weight(), push(rng, size / 2)], friction(rng))


def mixed_friction(rng: Rng) -> Scene:
    """The same, and half of the points have a coefficient of their own, a third of these none."""
    size = rng.uniform(20, 80, 3)
    points = around(rng, size, (rng.multinomial(6, [1 / 6] * 6) + 1).tolist(), rng.uniform(0.1, 1.0, 18).tolist())
    own = rng.choice([math.nan, math.nan, math.nan, 0.0, 0.05, 0.6], len(points))
    return build([(size, ORIGIN)], points, [weight(), push(rng, size / 2)], friction(rng), frictions=own)
