"""Draw faces, lines, rods and balls into an array, nearer ones over farther ones. Needs no display, no graphics.

Coordinates are pixels: x to the right, y down, z towards the viewer.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from cagepose.model.checks import FloatArray

Color = tuple[float, float, float]
"""Red, green, blue, each 0 to 1."""
BACKGROUND: Color = (0.965, 0.969, 0.976)
DIM = 0.62
"""How bright a face is that is seen from its edge; 1: one seen from before."""
LARGE_FACE = 5000.0
"""Pixels: a flat face of more is filled by itself, which takes a tenth of the time for each pixel."""
LONGEST_PART = 60.0
"""Pixels: a rod is drawn in parts, since the window of a long one across the picture would hold mostly other things."""


class Raster:
    """A picture in the making.

    Attributes
    ----------
    colors
        (height, width, 3), bytes.
    heights
        How near each pixel's thing is to the viewer, (height, width).
    """

    def __init__(self, width: int, height: int) -> None:
        self.colors = np.full((height, width, 3), _ink(BACKGROUND), dtype=np.uint8)
        self.heights = np.full((height, width), -np.inf, dtype=np.float32)
        self.keep()

    def keep(self) -> None:
        """Let each further picture begin with what has been drawn so far."""
        self._kept = self.colors.copy(), self.heights.copy()

    def begin(self) -> None:
        """Begin another picture, in the same memory: to ask for new one takes 20 ms."""
        np.copyto(self.colors, self._kept[0])
        np.copyto(self.heights, self._kept[1])

    def face(self, corners: FloatArray, color: Color, opacity: float, lit: float | None = None) -> None:
        """Fill a flat convex face, corners (n, 3), that can be seen through: it does not count as before anything. How
        bright it is follows from its slope, if ``lit`` does not say so.
        """
        (ax, ay, az), (bx, by, bz) = (corners[1] - corners[0]).tolist(), (corners[-1] - corners[0]).tolist()
        normal = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx  # np.cross takes some 80 us
        if abs(normal[2]) < 1e-9:
            return
        if lit is None:
            lit = DIM + (1.0 - DIM) * abs(normal[2]) / math.hypot(*normal)
        _, rows, left, right = _rows_within(corners[None, :, :2], self.heights.shape)
        counts = right - left
        starts = rows * self.heights.shape[1]
        pixels = np.arange(counts.sum()) + np.repeat(starts + left - np.cumsum(counts) + counts, counts)
        slope, fall = -normal[0] / normal[2], -normal[1] / normal[2]
        row_heights = corners[0, 2] + fall * (rows - corners[0, 1]) - slope * (corners[0, 0] + starts)
        heights = slope * pixels + np.repeat(row_heights, counts)
        pixels = pixels[heights > self.heights.ravel()[pixels]]
        for plane, ink in zip(self.colors.reshape(-1, 3).T, lit * _ink(color), strict=True):
            mixed = np.rint((1.0 - opacity) * np.arange(256.0) + opacity * ink).astype(np.uint8)  # with each byte there
            plane[pixels] = mixed[plane[pixels]]

    def triangles(self, corners: FloatArray, lit: FloatArray, color: Color, opacity: float) -> None:
        """Fill triangles, corners (m, 3, 3), none before another, that can be seen through like a `face`. ``lit``,
        (m, 3), is how bright each corner is.
        """
        first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        areas = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
        is_large = (np.abs(areas) > 2.0 * LARGE_FACE) & (np.ptp(lit, axis=1) < 1e-9)
        for face, brightness in zip(corners[is_large], lit[is_large, 0].tolist(), strict=True):
            self.face(face, color, opacity, brightness)
        is_seen = (np.abs(areas) > 1e-9) & ~is_large
        corners, lit, first, second, areas = (values[is_seen] for values in (corners, lit, first, second, areas))
        which, rows, left, right = _rows_within(corners[:, :, :2], self.heights.shape)
        counts = right - left
        in_row = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
        across, down, which = np.repeat(left, counts) + in_row, np.repeat(rows, counts), np.repeat(which, counts)
        steps = np.stack([across, down], axis=1) - corners[which, 0, :2]
        # Shares of the second and the third corner in a pixel.
        u = (steps[:, 0] * second[which, 1] - steps[:, 1] * second[which, 0]) / areas[which]
        v = (steps[:, 1] * first[which, 0] - steps[:, 0] * first[which, 1]) / areas[which]
        pixels = down * self.heights.shape[1] + across
        is_before = corners[which, 0, 2] + u * first[which, 2] + v * second[which, 2] > self.heights.ravel()[pixels]
        pixels, which, u, v = (values[is_before] for values in (pixels, which, u, v))
        shade = lit[which, 0] + u * (lit[which, 1] - lit[which, 0]) + v * (lit[which, 2] - lit[which, 0])
        colors = self.colors.reshape(-1, 3)
        colors[pixels] = np.rint((1.0 - opacity) * colors[pixels] + opacity * shade[:, None] * _ink(color))

    def lines(self, starts: FloatArray, ends: FloatArray, color: Color) -> None:
        """Draw straight lines, two pixels wide, from ``starts`` to ``ends``, (n, 3) each."""
        steps = np.ceil(np.abs(ends - starts)[:, :2].max(axis=1)).astype(int) + 1
        place = np.arange(steps.sum()) - np.repeat(np.cumsum(steps) - steps, steps)
        ways = ((ends - starts) / steps[:, None]).T
        x, y, heights = (
            np.repeat(start, steps) + place * np.repeat(way, steps) for start, way in zip(starts.T, ways, strict=True)
        )
        across, down = x.astype(int), y.astype(int)
        inside = (across >= 0) & (down >= 0) & (across < self.heights.shape[1] - 1) & (down < self.heights.shape[0] - 1)
        corners = (down * self.heights.shape[1] + across)[inside]
        above = heights[inside].astype(np.float32) + 1.0  # before the face that it bounds
        colors, covered, ink = self.colors.reshape(-1, 3), self.heights.ravel(), _ink(color)
        for pixels in (corners, corners + 1, corners + self.heights.shape[1], corners + self.heights.shape[1] + 1):
            seen = above > covered[pixels]
            colors[pixels[seen]] = ink
            covered[pixels[seen]] = above[seen]

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
        colors[seen] = np.rint(shade[seen][:, None] * _ink(color))
        heights[seen] = height[seen]

    def ball(self, middle: FloatArray, radius: float, color: Color) -> None:
        """Draw a ball."""
        self.rod(middle, middle, radius, color)

    def shrunk(self, factor: int) -> Image.Image:
        """Return the picture, each pixel the mean of ``factor`` by ``factor``."""
        return Image.fromarray(self.colors).reduce(factor)

    def _window(self, low: FloatArray, high: FloatArray) -> tuple[slice, slice, NDArray[Any], NDArray[Any]] | None:
        """Return rows and columns of the pixels between two corners, and their middles; None: outside the picture."""
        height, width = self.heights.shape
        left, right = max(int(low[0]), 0), min(int(high[0]) + 1, width)
        top, bottom = max(int(low[1]), 0), min(int(high[1]) + 1, height)
        if left >= right or top >= bottom:
            return None
        x, y = np.arange(left, right) + 0.5, np.arange(top, bottom)[:, None] + 0.5
        return slice(top, bottom), slice(left, right), x, y


def _ink(color: Color) -> FloatArray:
    """Return a colour in bytes, (3,)."""
    return 255.0 * np.array(color)


def _rows_within(
    corners: FloatArray, shape: tuple[int, ...]
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Return, for each row of each convex face, corners (m, n, 2): which face, the row, its first pixel, and the one
    after the last.
    """
    starts, ends = corners, np.roll(corners, -1, axis=1)
    tops, bottoms = (
        np.ceil(edge).clip(0, shape[0]).astype(np.int64)
        for edge in (corners[:, :, 1].min(axis=1), corners[:, :, 1].max(axis=1))
    )
    counts = bottoms - tops
    which = np.repeat(np.arange(len(corners)), counts)
    rows = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts) + tops[which]
    down = rows[:, None]
    crosses = (np.minimum(starts, ends)[which, :, 1] <= down) & (down < np.maximum(starts, ends)[which, :, 1])
    drops = np.where(starts[:, :, 1] == ends[:, :, 1], 1.0, ends[:, :, 1] - starts[:, :, 1])
    slants = (ends - starts)[:, :, 0] / drops
    places = starts[which, :, 0] + (down - starts[which, :, 1]) * slants[which]
    left, right = (
        np.ceil(side).clip(0, shape[1]).astype(np.int64)
        for side in (np.where(crosses, places, np.inf).min(axis=1), np.where(crosses, places, -np.inf).max(axis=1))
    )
    return which, rows, left, np.maximum(left, right)
