"""Robot models of the kinds that people publish, made here, and how tests import them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

Corner = tuple[float, float, float]

BOX_SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
"""Of corners in the order of `box_corners`, seen from outside."""


def box_corners(low: Corner, high: Corner) -> list[Corner]:
    return [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]


def obj(corners: Sequence[Corner], sides: Sequence[Sequence[int]]) -> str:
    """Return an OBJ file."""
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in corners]
    return "\n".join([*lines, *(f"f {' '.join(str(corner + 1) for corner in side)}" for side in sides)]) + "\n"


def box_obj(low: Corner, high: Corner) -> str:
    return obj(box_corners(low, high), BOX_SIDES)


def frame_obj(outer: float, inner: float, height: float) -> str:
    """Return a square frame with a square hole through it, which ends at z = 0."""
    corners = [
        (x * half, y * half, z)
        for half in (outer, inner)
        for z in (-height, 0.0)
        for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))
    ]
    sides = []
    for k in range(4):
        j = (k + 1) % 4
        sides += [(k, j, 4 + j, 4 + k), (8 + j, 8 + k, 12 + k, 12 + j)]
        sides += [(4 + k, 4 + j, 12 + j, 12 + k), (j, k, 8 + k, 8 + j)]
    return obj(corners, sides)


def post_obj(n_sides: int, radius: float, height: float) -> str:
    """Return a prism of many sides that stands on z = 0."""
    corners = [
        (radius * math.cos(2.0 * math.pi * k / n_sides), radius * math.sin(2.0 * math.pi * k / n_sides), z)
        for z in (0.0, height)
        for k in range(n_sides)
    ]
    around = [(k, (k + 1) % n_sides, n_sides + (k + 1) % n_sides, n_sides + k) for k in range(n_sides)]
    ends = [tuple(range(n_sides))[::-1], tuple(range(n_sides, 2 * n_sides))]
    fans = [(end[0], one, two) for end in ends for one, two in pairwise(end[1:])]
    return obj(corners, [*around, *fans])


def peg_urdf(mesh: str, held: str = "peg", z: float = 0.01) -> str:
    """Return a table with its top at z = 0, and a link of a mesh above it."""
    return f"""<robot name="p"><link name="world"/>
<link name="table"><collision><origin xyz="0 0 -0.05"/><geometry><box size="0.2 0.2 0.1"/></geometry></collision></link>
<link name="{held}">
<visual><geometry><mesh filename="nowhere/{held}.dae"/></geometry></visual>
<inertial><mass value="0.02"/><inertia ixx="1e-6" iyy="1e-6" izz="1e-6" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><mesh filename="{mesh}"/></geometry></collision></link>
<joint name="a" type="fixed"><parent link="world"/><child link="table"/></joint>
<joint name="b" type="floating"><parent link="world"/><child link="{held}"/><origin xyz="0 0 {z}"/></joint>
</robot>"""


def mjcf(world: str, more: str = "", asset: str = "") -> str:
    """Return MJCF with a floor whose top is at z = 0."""
    floor = '<geom name="floor" type="plane" size="1 1 1"/>'
    return f"<mujoco><asset>{asset}</asset><worldbody>{floor}{world}</worldbody>{more}</mujoco>"


def written(folder: Path, **files: str) -> Path:
    """Write files whose names have __ for / and _dot_ for the dot; return the last."""
    for name, text in files.items():
        path = folder / name.replace("__", "/").replace("_dot_", ".")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return path
