"""Scenes of any size whose run stays the same: a tilted table settles on three points; the others are never reached.

The table is a grid of boxes over one square metre. It starts tilted by a twentieth of a degree about both sides, falls
on the first of three posts under it, turns onto the second and the third, and is at rest. All further points lie below
the level of the posts: they have to be asked about in every sweep, and stop nothing.

- "dense": boxes fill nine tenths of their cells, and the further points lie 5 to 10 mm below them.
- "spread": boxes fill a tenth of their cells, and the further points lie anywhere in the cubic metre below.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Literal

import numpy as np

from bench.rail_case import FloatArray
from cagepose import Box, Cage, Load, Object, Pose, Scene

Kind = Literal["dense", "spread"]

SIDE_M = 1.0
THICKNESS_M = 0.02
TILT_RAD = math.radians(0.05)
FILL = {"dense": 0.9, "spread": 0.1}
POSTS = ((0.35, 0.30), (-0.35, 0.25), (0.05, -0.35))
"""Where the posts would like to stand, as parts of the table's side: around its middle."""


@lru_cache(maxsize=64)  # 512 boxes take seconds to check, and both methods run the same scene
def crowd_scene(kind: Kind, n_boxes: int, n_points: int) -> Scene:
    """Return the table of ``n_boxes`` over three posts and ``n_points - 3`` further points.

    Raises
    ------
    ValueError
        Fewer than four points, or no box.
    """
    if n_points < 4 or n_boxes < 1:
        raise ValueError(f"{n_points} points and {n_boxes} boxes; give at least 4 points and 1 box")
    centers, size = _grid(kind, n_boxes)
    posts = np.array([_under_a_box(np.array(post) * SIDE_M, centers, size) for post in POSTS])
    points = np.vstack([np.column_stack([posts, np.zeros(3)]), _further(kind, n_points - 3)])
    mass_kg, half = 1.0, SIDE_M / 2.0
    held = Object(
        [Box((size[0], size[1], THICKNESS_M), Pose((x, y, 0.0))) for x, y in centers],
        (*posts.mean(axis=0), 0.0),
        pose=Pose((0.0, 0.0, 0.02), euler_zyx=(0.0, TILT_RAD, TILT_RAD)),
        mass_kg=mass_kg,
        inertia_kg_m2=mass_kg * half**2 / 3.0 * np.diag([1.0, 1.0, 2.0]),
    )
    return Scene(held, Cage(points), [Load("weight", gravity=(0.0, 0.0, -9.81))], name=f"{kind} table")


def _grid(kind: Kind, n_boxes: int) -> tuple[FloatArray, tuple[float, float]]:
    """Return the centres of the boxes, (n_boxes, 2), and their edge lengths in the plane, metres."""
    columns = math.ceil(math.sqrt(n_boxes))
    rows = math.ceil(n_boxes / columns)
    cell = np.array([SIDE_M / columns, SIDE_M / rows])
    # In an order that spreads the boxes evenly if the last row is not full.
    cells = np.linspace(0, columns * rows - 1, n_boxes).round().astype(int)
    centers = (np.column_stack([cells % columns, cells // columns]) + 0.5) * cell - SIDE_M / 2.0
    return centers, (float(cell[0] * FILL[kind]), float(cell[1] * FILL[kind]))


def _under_a_box(wanted: FloatArray, centers: FloatArray, size: tuple[float, float]) -> FloatArray:
    """Return the place nearest to the wanted one that lies well under a box."""
    reach = 0.4 * np.array(size)
    nearest = np.clip(wanted, centers - reach, centers + reach)
    best: FloatArray = nearest[np.linalg.norm(nearest - wanted, axis=1).argmin()]
    return best


def _further(kind: Kind, n_points: int) -> FloatArray:
    draw = np.random.default_rng(0)
    across = draw.uniform(-SIDE_M / 2.0, SIDE_M / 2.0, (n_points, 2))
    lowest = -0.010 if kind == "dense" else -SIDE_M
    return np.column_stack([across, draw.uniform(lowest, -0.005, n_points)])
