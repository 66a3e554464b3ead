"""The play of one point as outlines in the three planes of the cage, from its extremes in many directions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from cagepose.model.checks import FloatArray
from cagepose.model.scene import Scene
from cagepose.studies.play import PointPlay, play
from cagepose.studies.support import polygon_within

PLANES = (("x", "y"), ("x", "z"), ("y", "z"))
N_DIRECTIONS = 24
"""In each plane, 15 deg apart."""


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
    """Return the corners of what the ends bound; None: one of them has no end."""
    if None in highs or None in lows:
        return None
    return polygon_within(
        normals, np.concatenate([np.array(highs, dtype=np.float64), -np.array(lows, dtype=np.float64)])
    )
