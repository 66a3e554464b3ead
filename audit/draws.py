"""Pieces that the families of scenes are drawn from. Lengths are in millimetres until a scene is built."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from audit.case import FloatArray
from cagepose import Box, Cage, Force, Load, Object, Pose, Scene

MM = 1e-3
Sized = tuple[FloatArray, FloatArray]
"""Size and position of a box."""
FRICTIONS = (0.0, 0.1, 0.2, 0.4)
Rng = np.random.Generator


def friction(rng: Rng) -> float:
    """One of the usual coefficients; one in eight is any number from 0 to 1."""
    return float(rng.uniform()) if rng.random() < 0.125 else float(rng.choice(FRICTIONS))


def direction(rng: Rng) -> FloatArray:
    """Down, along an axis, or anywhere."""
    kind = rng.random()
    if kind < 0.4:
        return np.array([0.0, 0.0, -1.0])
    return np.eye(3)[rng.integers(3)] * rng.choice([-1.0, 1.0]) if kind < 0.6 else rng.normal(size=3)


def weight(down: FloatArray | None = None) -> Load:
    return Load("weight", gravity=(0.0, 0.0, -1.0) if down is None else down)


def push(rng: Rng, reach_mm: FloatArray, name: str = "push", *, with_weight: bool = False) -> Load:
    """A force within the box of half sizes ``reach_mm`` about the object's origin."""
    force = Force(direction(rng), rng.uniform(-1.0, 1.0, 3) * reach_mm * MM)
    return Load(name, gravity=(0.0, 0.0, -1.0) if with_weight else None, force=force)


def beside(rng: Rng, size_mm: FloatArray, axis: int, side: int, gap_mm: float, near_edge: float = 0.0) -> FloatArray:
    """A point before one face of a box at the origin; with the chance ``near_edge``, before one of its edges."""
    point = rng.uniform(-0.45, 0.45, 3) * size_mm
    if rng.random() < near_edge:
        along = (axis + int(rng.integers(1, 3))) % 3
        point[along] = np.copysign(size_mm[along] / 2, point[along])
    point[axis] = side * (size_mm[axis] / 2 + gap_mm)
    return point


def around(rng: Rng, size_mm: FloatArray, counts: Sequence[int], gaps_mm: Sequence[float]) -> FloatArray:
    """Points before the faces -x, +x, -y, ... of a box, ``counts`` of them; each at one of the gaps."""
    points = [
        beside(rng, size_mm, face // 2, 2 * (face % 2) - 1, float(rng.choice(gaps_mm)), 0.1)
        for face, count in enumerate(counts)
        for _ in range(count)
    ]
    return np.array(points)


def any_turn(rng: Rng) -> Pose:
    """A pose within 20 mm of the origin; half of them are not turned."""
    return Pose(rng.uniform(-20, 20, 3) * MM, rng.normal(size=4) if rng.random() < 0.5 else None)


def build(
    boxes_mm: Sequence[Sized],
    points_mm: FloatArray,
    loads: Sequence[Load],
    mu: float,
    *,
    center_mm: FloatArray | None = None,
    pose: Pose | None = None,
    scale: float = 1.0,
    mass_kg: float | None = None,
    frictions: FloatArray | None = None,
) -> Scene:
    """Build a scene from boxes (size, position) and points, all in the object's frame at the start.

    Points inside a box are left out. Coefficients of friction may be those of the points: NaN where it is that of all.
    """
    outside = [((np.abs(points_mm - at) >= size / 2 - 1e-9).any(axis=1)) for size, at in boxes_mm]
    is_kept = np.all(outside, axis=0)
    kept = points_mm[is_kept]
    of_points = np.full(len(points_mm), np.nan) if frictions is None else frictions
    start = pose or Pose()
    parts = [Box(size * MM * scale, Pose(at * MM * scale), f"box{k + 1}") for k, (size, at) in enumerate(boxes_mm)]
    center = None if center_mm is None else center_mm * MM * scale
    placed = Pose(start.position_m * scale, start.quaternion_wxyz)
    return Scene(
        Object(parts, center, pose=placed, mass_kg=mass_kg),
        Cage(placed.transform(kept * MM * scale)),
        loads,
        friction_coefficient=mu,
        friction_of={f"C{k + 1}": own for k, own in enumerate(of_points[is_kept].tolist()) if own >= 0.0},
    )
