"""The play of one point as outlines in the three planes of the cage, from its extremes in many directions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from cagepose.model.checks import FloatArray
from cagepose.model.scene import Scene
from cagepose.studies.play import play
from cagepose.studies.play_result import PointPlay
from cagepose.studies.support import polygon_within
from cagepose.studies.tolerances import PARALLEL_SINE

PLANES = (("x", "y"), ("x", "z"), ("y", "z"))
N_DIRECTIONS = 24
"""In each plane, 15 deg apart."""


EXTENT_OF_PICTURE = 1.3
"""In distances of the farthest end. A picture in which some directions have no end goes so far."""
CUT_OFF = 4.0
"""In halves of such a picture: there an outline without end is cut off, so that the cut is not seen."""


@dataclass(frozen=True, eq=False)
class PointOutline:
    """How far a point goes, seen along one axis of the cage; metres from where it starts.

    Attributes
    ----------
    axes
        Of the picture: "x", "y" or "z", to the right and upward.
    linear, exact, certified
        Corners of the polygon that the ends in all directions bound, (n, 2). Where there is no end it is cut off, far
        outside of what is shown. Of exact ends that were not found it has how far the searches came; certified, None:
        some are not proven.
    no_end
        Of the directions, unit vectors, those along which the point goes without end and nothing bounds it, (n, 2).
    not_converged
        Where the searches came along directions whose end was not found, (n, 2).
    shown_m
        How far the picture goes if there is no end in some direction; None: it shows all.
    """

    axes: tuple[str, str]
    linear: FloatArray
    exact: FloatArray
    certified: FloatArray | None
    no_end: FloatArray
    not_converged: FloatArray
    shown_m: float | None


def point_outlines(scene: Scene, at_object: ArrayLike) -> tuple[PointOutline, PointOutline, PointOutline]:
    """Return the outlines of a point of the object, (3,) metres in its frame, in the planes xy, xz and yz."""
    half = 2.0 * np.pi * np.arange(N_DIRECTIONS // 2) / N_DIRECTIONS
    units = np.stack([np.cos(half), np.sin(half)], axis=1)
    directions = np.zeros((len(PLANES), len(units), 3))
    for plane, axes in enumerate(PLANES):
        directions[plane][:, ["xyz".index(axis) for axis in axes]] = units
    found = play(scene, [at_object], list(directions.reshape(-1, 3)), search_s=0.0).points
    xy, xz, yz = (
        _outline(axes, units, found[plane * len(units) : (plane + 1) * len(units)], scene.size_m)
        for plane, axes in enumerate(PLANES)
    )
    return xy, xz, yz


def _outline(axes: tuple[str, str], units: FloatArray, points: tuple[PointPlay, ...], size_m: float) -> PointOutline:
    normals = np.concatenate([units, -units])
    ends = [*(point.high for point in points), *(point.low for point in points)]
    signs = np.repeat([1.0, -1.0], len(points))
    linear, exact, certified = (
        signs * np.array([getattr(end, kind) for end in ends], dtype=np.float64)  # NaN: none
        for kind in ("linear", "reached", "certified")
    )
    if np.isnan(linear).all():  # not known of such shapes
        linear = exact
    heights = np.concatenate([linear, exact])
    has_end = np.isfinite(heights)
    farthest_m = float(np.abs(heights[has_end]).max(initial=0.0)) or 0.5 * size_m
    shown_m = None if has_end.all() else EXTENT_OF_PICTURE * farthest_m
    is_open, bounding = np.isnan(exact), normals[~np.isnan(exact)]
    goes_on = is_open & (normals @ bounding.T <= PARALLEL_SINE).all(axis=1)
    unsure = np.array([end.status == "not converged" for end in ends]) & ~is_open
    return PointOutline(
        axes,
        _polygon(normals, linear, shown_m),
        _polygon(normals, exact, shown_m),
        polygon_within(normals, certified) if np.isfinite(certified).all() else None,
        normals[goes_on],
        (normals * exact[:, None])[unsure],
        shown_m,
    )


def _polygon(normals: FloatArray, heights: FloatArray, shown_m: float | None) -> FloatArray:
    """Return the corners of what the ends bound, cut off where there are none."""
    return polygon_within(normals, heights if shown_m is None else np.fmin(heights, CUT_OFF * shown_m))
