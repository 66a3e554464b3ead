"""Draw faces, lines, rods and balls into an array, nearer ones over farther ones. Needs no display, no graphics.

Coordinates are pixels: x to the right, y down, z towards the viewer.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from cagepose.nouns.checks import FloatArray

Color = tuple[float, float, float]
"""Red, green, blue, each 0 to 1."""
BACKGROUND: Color = (0.965, 0.969, 0.976)
LONGEST_PART = 60.0
"""Pixels: a rod is drawn in parts, since the window of a long one across the picture would hold mostly other things."""


class Raster:
    """A picture in the making.

    Attributes
    ----------
    colors
        (height, width, 3), 0 to 1.
    heights
        How near each pixel's thing is to the viewer, (height, width).
    """

    def __init__(self, width: int, height: int) -> None:
        self.colors = np.full((height, width, 3), BACKGROUND, dtype=np.float32)
        self.heights = np.full((height, width), -np.inf, dtype=np.float32)

    def face(self, corners: FloatArray, color: Color, opacity: float) -> None:
        """Fill a flat convex face, corners (n, 3), that can be seen through: it does not count as before anything."""
        normal = np.cross(corners[1] - corners[0], corners[-1] - corners[0])
        low = np.floor(corners[:, :2].min(axis=0)).astype(int).clip(0, self.heights.shape[::-1])
        high = np.ceil(corners[:, :2].max(axis=0)).astype(int).clip(0, self.heights.shape[::-1])
        width, height = (high - low).tolist()
        if abs(normal[2]) < 1e-9 or width == 0 or height == 0:
            return
        mask = Image.new("1", (width, height))
        ImageDraw.Draw(mask).polygon([tuple(corner) for corner in (corners[:, :2] - low).tolist()], fill=1)
        y, x = np.nonzero(np.asarray(mask))
        slopes = -normal[:2] / normal[2]
        y, x = y + low[1], x + low[0]
        heights = corners[0, 2] + slopes[0] * (x - corners[0, 0]) + slopes[1] * (y - corners[0, 1])
        seen = heights > self.heights[y, x]
        y, x = y[seen], x[seen]
        self.colors[y, x] += opacity * (np.array(color, dtype=np.float32) - self.colors[y, x])

    def lines(self, starts: FloatArray, ends: FloatArray, color: Color) -> None:
        """Draw straight lines, two pixels wide, from ``starts`` to ``ends``, (n, 3) each."""
        steps = np.ceil(np.abs(ends - starts)[:, :2].max(axis=1)).astype(int) + 1
        which = np.repeat(np.arange(len(starts)), steps)
        place = np.arange(len(which)) - np.repeat(np.cumsum(steps) - steps, steps)
        points = starts[which] + (place / steps[which])[:, None] * (ends - starts)[which]
        for across, down in ((0, 0), (1, 0), (0, 1), (1, 1)):
            x, y = points[:, 0].astype(int) + across, points[:, 1].astype(int) + down
            inside = (x >= 0) & (y >= 0) & (x < self.heights.shape[1]) & (y < self.heights.shape[0])
            x, y, heights = x[inside], y[inside], points[inside, 2] + 1.0  # before the face that it bounds
            seen = heights > self.heights[y, x]
            self.colors[y[seen], x[seen]] = color
            np.maximum.at(self.heights, (y[seen], x[seen]), heights[seen])

    def rod(
        self, start: FloatArray, end: FloatArray, radius: float, color: Color, end_radius: float | None = None
    ) -> None:
        """Draw a round rod, or a cone if it ends with another radius."""
        last = radius if end_radius is None else end_radius
        n_parts = 1 + int(np.linalg.norm((end - start)[:2]) / LONGEST_PART)
        cuts = np.linspace(0.0, 1.0, n_parts + 1)
        for cut, next_cut in zip(cuts[:-1].tolist(), cuts[1:].tolist(), strict=True):
            first, second = start + cut * (end - start), start + next_cut * (end - start)
            self._part(first, second, radius + cut * (last - radius), radius + next_cut * (last - radius), color)

    def _part(self, start: FloatArray, end: FloatArray, radius: float, last: float, color: Color) -> None:
        """Draw a short rod, whose window holds little else."""
        reach = max(radius, last)
        window = self._window(np.minimum(start, end)[:2] - reach, np.maximum(start, end)[:2] + reach)
        if window is None:
            return
        rows, columns, x, y = window
        way = (end - start)[:2]
        square = float(way @ way)
        along = np.zeros(np.broadcast(x, y).shape)
        if square > 0.0:
            along = ((x - start[0]) * way[0] + (y - start[1]) * way[1]) / square
        within = (along >= 0.0) & (along <= 1.0)
        thick = radius + along * (last - radius)
        aside = np.hypot(x - start[0] - along * way[0], y - start[1] - along * way[1])
        bulge = np.sqrt(np.maximum(thick**2 - aside**2, 0.0))
        shade = 0.55 + 0.45 * bulge / np.maximum(thick, 1e-9)
        height = start[2] + along * (end[2] - start[2]) + bulge
        heights, colors = self.heights[rows, columns], self.colors[rows, columns]
        seen = within & (aside <= thick) & (height > heights)
        colors[seen] = shade[seen][:, None] * np.array(color)
        heights[seen] = height[seen]

    def ball(self, middle: FloatArray, radius: float, color: Color) -> None:
        """Draw a ball."""
        self.rod(middle, middle, radius, color)

    def shrunk(self, factor: int) -> Image.Image:
        """Return the picture, each pixel the mean of ``factor`` by ``factor``."""
        return Image.fromarray(np.rint(255.0 * self.colors.clip(0.0, 1.0)).astype(np.uint8)).reduce(factor)

    def _window(self, low: FloatArray, high: FloatArray) -> tuple[slice, slice, NDArray[Any], NDArray[Any]] | None:
        """Return rows and columns of the pixels between two corners, and their middles; None: outside the picture."""
        height, width = self.heights.shape
        left, right = max(int(low[0]), 0), min(int(high[0]) + 1, width)
        top, bottom = max(int(low[1]), 0), min(int(high[1]) + 1, height)
        if left >= right or top >= bottom:
            return None
        x, y = np.arange(left, right) + 0.5, np.arange(top, bottom)[:, None] + 0.5
        return slice(top, bottom), slice(left, right), x, y
