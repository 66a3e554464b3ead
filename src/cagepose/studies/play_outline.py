"""The play of one point as outlines in the three planes of the cage, from its extremes in many directions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from cagepose.model.checks import FloatArray
from cagepose.model.scene import Scene
from cagepose.studies.play import PointPlay, play
from cagepose.studies.support import convex_hull

PLANES = (("x", "y"), ("x", "z"), ("y", "z"))
N_DIRECTIONS = 24
"""In each plane, 15 deg apart."""
PARALLEL = 1e-6
"""Sine of the angle between two lines that do not cross."""
ROUNDING = 1e-9
"""Of the largest distance: a crossing that a line cuts off by less is a corner."""


@dataclass(frozen=True, eq=False)
class PointOutline:
    """How far a point goes, seen along one axis of the cage; metres from where it starts.

    Attributes
    ----------
    axes
        Of the picture: "x", "y" or "z", to the right and upward.
    linear, exact, certified
        Corners of the polygon that the ends in all directions bound, (n, 2); None: some have no end, or no proof.
    """

    axes: tuple[str, str]
    linear: FloatArray | None
    exact: FloatArray | None
    certified: FloatArray | None


def point_outlines(scene: Scene, at_object: ArrayLike) -> tuple[PointOutline, PointOutline, PointOutline]:
    """Return the outlines of a point of the object, (3,) metres in its frame, in the planes xy, xz and yz."""
    half = 2.0 * np.pi * np.arange(N_DIRECTIONS // 2) / N_DIRECTIONS
    units = np.stack([np.cos(half), np.sin(half)], axis=1)
    directions = np.zeros((len(PLANES), len(units), 3))
    for plane, axes in enumerate(PLANES):
        directions[plane][:, ["xyz".index(axis) for axis in axes]] = units
    found = play(scene, [at_object], list(directions.reshape(-1, 3)), search_s=0.0).points
    xy, xz, yz = (
        _outline(axes, units, found[plane * len(units) : (plane + 1) * len(units)]) for plane, axes in enumerate(PLANES)
    )
    return xy, xz, yz


def _outline(axes: tuple[str, str], units: FloatArray, points: tuple[PointPlay, ...]) -> PointOutline:
    normals = np.concatenate([units, -units])
    highs, lows = [point.high for point in points], [point.low for point in points]
    linear, exact, certified = (
        _polygon(normals, [getattr(end, kind) for end in highs], [getattr(end, kind) for end in lows])
        for kind in ("linear", "exact", "certified")
    )
    return PointOutline(axes, linear, exact, certified)


def _polygon(normals: FloatArray, highs: list[float | None], lows: list[float | None]) -> FloatArray | None:
    """Return the corners of what lies within all lines: those crossings of two that no third one cuts off."""
    if None in highs or None in lows:
        return None
    heights = np.concatenate([np.array(highs, dtype=np.float64), -np.array(lows, dtype=np.float64)])
    first, second = np.triu_indices(len(normals), 1)
    is_crossing = np.abs(_cross(normals[first], normals[second])) > PARALLEL
    first, second = first[is_crossing], second[is_crossing]
    pairs = np.stack([normals[first], normals[second]], axis=1)
    crossings = np.linalg.solve(pairs, np.stack([heights[first], heights[second]], axis=1)[:, :, None])[:, :, 0]
    within = (crossings @ normals.T <= heights + ROUNDING * np.abs(heights).max()).all(axis=1)
    return convex_hull(crossings[within])


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    crossed: FloatArray = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return crossed
