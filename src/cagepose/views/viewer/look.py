"""How things look, on the page and in pictures alike: paint, light, sizes of marks. The page gets all this as data."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

import numpy as np

from cagepose.model.checks import FloatArray

PAPER = "#f6f7f9"
PAINT = {
    "object": "#6fb7e3",
    "objectEdge": "#0b4f79",
    "objectWall": "#4d90bb",
    "cage": "#d2c6ae",
    "cageEdge": "#6a5a3c",
    "cageWall": "#b3a27f",
    "pin": "#8d8d8d",
    "ghost": "#a9a9a9",
    "free": "#737373",
    "touching": "#e69f00",
    "reached": "#d55e00",
    "force": "#d55e00",
    "normal": "#4d4d4d",
    "load": "#161616",
    "hand": "#007a56",
    "axis": "#cc79a7",
    "section": "#009e73",
    "gap": "#7b2d8e",
    "trace": "#0072b2",
    "grid": "#d3d8de",
}
"""Colours of the object and of what else is shown, in sRGB."""
SKY, GROUND = 1.35, "#b9b2a6"
"""Light from above, and the colour of what comes back from below."""
SUN, SUN_FROM = 1.9, (0.35, -0.55, 1.0)
LAMP, LAMP_FROM = 0.55, (-0.4, 0.5, 1.0)
"""Beside the viewer: right, up, towards the viewer."""
FIELD_DEG = 24.0
"""What a picture sees, from below to above."""
MARGIN = 0.86
"""Share of a picture that what must be seen is fitted to."""
GLASS, LARGE, SEEN_THROUGH = 0.3, 0.6, 0.35
"""How much of a body of the cage is painted that hides the object: one that reaches so many times as far; and of the
object, when it is to be seen through.
"""
FAINT = 0.22
"""How much is painted of a mark that is behind a body."""
BALL, FREE_BALL, ROD, THIN, HEAD = 5.5, 3.5, 2.2, 1.0, (4.5, 13.0)
"""Radii in pixels of contacts, of points that do not touch, of arrows and of lines; radius and length of a tip."""
FORCE, LOAD, TRAVEL, NORMAL, COIL = 90.0, 84.0, 80.0, 30.0, 7.0
"""Lengths in pixels of the longest force and other arrows, and the radius of a spring."""
SECOND_HEAD, LONGEST_SPRING, SHORTEST_FORCE = 0.8, 1.0, 22.0
"""Where a moment's arrow has its other head; the greatest length of a spring, in drawing units; the least length of a
force's arrow, in pixels.
"""
PIN, PIN_OF_CAGE, PIN_SLOPE = 0.05, 0.12, 0.22
"""A cage point as a pin: its length in drawing units, and in reaches of all points, at most; its radius beside that."""
GRID_LINES, BELOW = 12, 0.01
"""From the middle of the ground to one side; how far it lies below all else, in drawing units."""
DISTANCE_OF_EYE = 3.0
"""In radii of the scene: so far off is the eye at least of a picture of a part, or it would stand within the rest."""
INSET, INSET_FROM_EDGE = (0.23, 0.15), (16.0, 52.0)
"""Of a picture of a part, the inset that shows the whole: its size in widths of the picture, and how many pixels it is
from the right edge and from the lower one.
"""
FEW_NAMES = 14
"""If there are more contacts than these, only those are named that press or were just reached."""
LEAST_FORCE = 1e-9
"""In parts of the greatest one of its phase; what is less is rounding."""


def document() -> dict[str, Any]:
    """Return all of it as plain data."""
    return {name.lower(): value for name, value in globals().items() if name.isupper()}


@lru_cache(maxsize=64)
def linear(paint: str) -> tuple[float, float, float]:
    """Return red, green and blue of a hexadecimal colour, each 0 to 1, as light adds up."""
    red, green, blue = (int(paint[place : place + 2], 16) / 255.0 for place in (1, 3, 5))
    return _to_linear(red), _to_linear(green), _to_linear(blue)


def lit(paint: str, normals: FloatArray, axes: FloatArray) -> FloatArray:
    """Return what a surface of some paint looks like, sRGB in bytes, (n, 3): ``normals`` are unit vectors of the world,
    (n, 3), ``axes`` the viewer's right, up and back, (3, 3).
    """
    sun = np.array(SUN_FROM) / math.dist(SUN_FROM, (0.0, 0.0, 0.0))
    lamp = np.array(LAMP_FROM) @ axes / math.dist(LAMP_FROM, (0.0, 0.0, 0.0))
    direct = SUN * np.maximum(normals @ sun, 0.0) + LAMP * np.maximum(normals @ lamp, 0.0)
    share = 0.5 + 0.5 * normals[:, 2:]
    around = SKY * (share + (1.0 - share) * np.array(linear(GROUND)))
    light = np.minimum((direct[:, None] + around) / np.pi * np.array(linear(paint)), 1.0)
    bytes_: FloatArray = 255.0 * np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1.0 / 2.4) - 0.055)
    return bytes_


def ink(paint: str) -> FloatArray:
    """Return a colour in bytes, (3,), as it is."""
    return np.array([int(paint[place : place + 2], 16) for place in (1, 3, 5)], dtype=np.float64)


def _to_linear(value: float) -> float:
    return value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4
