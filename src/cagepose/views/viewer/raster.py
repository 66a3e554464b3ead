"""Draw faces, lines, rods and balls into an array, nearer ones over farther ones. Needs no display, no graphics.

Coordinates are pixels: x to the right, y down, z the nearer the greater. Colours are bytes.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from cagepose.model.checks import FloatArray
from cagepose.views.viewer.look import FAINT, PAPER, ink

Keep = Callable[[FloatArray], NDArray[np.bool_]]
LIFT_OF_LINE = 1.0
"""How much nearer a line counts as than it is."""
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
        self.colors = np.full((height, width, 3), ink(PAPER), dtype=np.uint8)
        self.heights = np.full((height, width), -np.inf, dtype=np.float32)
        self.keep()

    def keep(self) -> None:
        """Let each further picture begin with what has been drawn so far."""
        self._kept = self.colors.copy(), self.heights.copy()

    def begin(self) -> None:
        """Begin another picture, in the same memory: to ask for new one takes 20 ms."""
        np.copyto(self.colors, self._kept[0])
        np.copyto(self.heights, self._kept[1])

    def face(self, corners: FloatArray, color: FloatArray, opacity: float = 1.0, keep: Keep | None = None) -> None:
        """Fill a flat convex face, corners (n, 3), with a colour, (3,). One that can be seen through does not count as
        before anything. ``keep`` says of pixels with their nearness, (m, 3), which of them are not left out.
        """
        (ax, ay, az), (bx, by, bz) = (corners[1] - corners[0]).tolist(), (corners[-1] - corners[0]).tolist()
        normal = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx  # np.cross takes some 80 us
        if abs(normal[2]) < 1e-9:
            return
        _, rows, left, right = _rows_within(corners[None, :, :2], self.heights.shape)
        counts = right - left
        starts = rows * self.heights.shape[1]
        pixels = np.arange(counts.sum()) + np.repeat(starts + left - np.cumsum(counts) + counts, counts)
        slope, fall = -normal[0] / normal[2], -normal[1] / normal[2]
        row_heights = corners[0, 2] + fall * (rows - corners[0, 1]) - slope * (corners[0, 0] + starts)
        heights = slope * pixels + np.repeat(row_heights, counts)
        is_seen = heights > self.heights.ravel()[pixels]
        if keep is not None:
            is_seen &= keep(np.stack([*divmod(pixels, self.heights.shape[1])[::-1], heights], axis=1))
        pixels = pixels[is_seen]
        if opacity == 1.0:
            self.heights.reshape(-1)[pixels] = heights[is_seen]
            self.colors.reshape(-1, 3)[pixels] = np.rint(color)
            return
        for plane, shade in zip(self.colors.reshape(-1, 3).T, color, strict=True):
            mixed = np.rint((1.0 - opacity) * np.arange(256.0) + opacity * shade).astype(
                np.uint8
            )  # with each byte there
            plane[pixels] = mixed[plane[pixels]]

    def triangles(
        self, corners: FloatArray, colors: FloatArray, opacity: float = 1.0, keep: Keep | None = None
    ) -> None:
        """Fill triangles, corners (m, 3, 3), with the colours of their corners, (m, 3, 3), like a `face` each."""
        first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        areas = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
        is_large = (np.abs(areas) > 2.0 * LARGE_FACE) & (np.ptp(colors, axis=1).max(axis=1) < 0.5)
        for face, color in zip(corners[is_large], colors[is_large, 0], strict=True):
            self.face(face, color, opacity, keep)
        is_seen = (np.abs(areas) > 1e-9) & ~is_large
        corners, colors, first, second, areas = (values[is_seen] for values in (corners, colors, first, second, areas))
        which, rows, left, right = _rows_within(corners[:, :, :2], self.heights.shape)
        counts = right - left
        in_row = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
        across, down, which = np.repeat(left, counts) + in_row, np.repeat(rows, counts), np.repeat(which, counts)
        steps = np.stack([across, down], axis=1) - corners[which, 0, :2]
        # Shares of the second and the third corner in a pixel.
        u = (steps[:, 0] * second[which, 1] - steps[:, 1] * second[which, 0]) / areas[which]
        v = (steps[:, 1] * first[which, 0] - steps[:, 0] * first[which, 1]) / areas[which]
        pixels = down * self.heights.shape[1] + across
        heights = corners[which, 0, 2] + u * first[which, 2] + v * second[which, 2]
        is_before = heights > self.heights.ravel()[pixels]
        if keep is not None:
            is_before &= keep(np.stack([across, down, heights], axis=1))
        # The nearest one of a pixel comes last, and stays.
        order = np.nonzero(is_before)[0]
        order = order[np.argsort(heights[order], kind="stable")]
        pixels, which, u, v = pixels[order], which[order], u[order, None], v[order, None]
        shade = colors[which, 0] + u * (colors[which, 1] - colors[which, 0]) + v * (colors[which, 2] - colors[which, 0])
        painted = self.colors.reshape(-1, 3)
        painted[pixels] = np.rint((1.0 - opacity) * painted[pixels] + opacity * shade)
        if opacity == 1.0:
            self.heights.reshape(-1)[pixels] = heights[order]

    def lines(self, starts: FloatArray, ends: FloatArray, color: FloatArray) -> None:
        """Draw straight lines, two pixels wide, from ``starts`` to ``ends``, (n, 3) each."""
        starts, ends = self._within(starts, ends)
        steps = np.ceil(np.abs(ends - starts)[:, :2].max(axis=1)).astype(int) + 1
        place = np.arange(steps.sum()) - np.repeat(np.cumsum(steps) - steps, steps)
        ways = ((ends - starts) / steps[:, None]).T
        x, y, heights = (
            np.repeat(start, steps) + place * np.repeat(way, steps) for start, way in zip(starts.T, ways, strict=True)
        )
        across, down = x.astype(int), y.astype(int)
        inside = (across >= 0) & (down >= 0) & (across < self.heights.shape[1] - 1) & (down < self.heights.shape[0] - 1)
        corners = (down * self.heights.shape[1] + across)[inside]
        above = heights[inside].astype(np.float32) + LIFT_OF_LINE  # before the face that it bounds
        colors, covered = self.colors.reshape(-1, 3), self.heights.reshape(-1)
        for pixels in (corners, corners + 1, corners + self.heights.shape[1], corners + self.heights.shape[1] + 1):
            seen = above > covered[pixels]
            colors[pixels[seen]] = color
            covered[pixels[seen]] = above[seen]

    def rod(
        self,
        start: FloatArray,
        end: FloatArray,
        radius: float,
        color: FloatArray,
        end_radius: float | None = None,
        *,
        faint: float = FAINT,
    ) -> None:
        """Draw a round rod, or a cone if it ends with another radius. What is behind a body shows through,
        ``faint``.
        """
        last = radius if end_radius is None else end_radius
        n_parts = 1 + int(np.linalg.norm((end - start)[:2]) / LONGEST_PART)
        cuts = np.linspace(0.0, 1.0, n_parts + 1)
        for cut, next_cut in zip(cuts[:-1].tolist(), cuts[1:].tolist(), strict=True):
            first, second = start + cut * (end - start), start + next_cut * (end - start)
            self._part(first, second, radius + cut * (last - radius), radius + next_cut * (last - radius), color, faint)

    def _part(
        self, start: FloatArray, end: FloatArray, radius: float, last: float, color: FloatArray, faint: float
    ) -> None:
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
        covers = within & (aside <= thick)
        seen, hidden = covers & (height > heights), covers & (height <= heights)
        colors[hidden] = np.rint((1.0 - faint) * colors[hidden] + faint * color)
        colors[seen] = np.rint(shade[seen][:, None] * color)
        heights[seen] = height[seen]

    def ball(self, middle: FloatArray, radius: float, color: FloatArray) -> None:
        """Draw a ball."""
        self.rod(middle, middle, radius, color)

    def shrunk(self, factor: int) -> Image.Image:
        """Return the picture, each pixel the mean of ``factor`` by ``factor``."""
        return Image.fromarray(self.colors).reduce(factor)

    def _within(self, starts: FloatArray, ends: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the parts of straight lines, (n, 3) each, that are in the picture."""
        low, high = np.zeros(len(starts)), np.ones(len(starts))
        for axis, room in ((0, self.heights.shape[1]), (1, self.heights.shape[0])):
            way = ends[:, axis] - starts[:, axis]
            with np.errstate(divide="ignore", invalid="ignore"):
                cuts = np.sort(np.stack([-starts[:, axis] / way, (room - starts[:, axis]) / way]), axis=0)
            inside = (starts[:, axis] >= 0.0) & (starts[:, axis] <= room)
            first, last = (
                np.where(way == 0.0, np.where(inside, end, np.nan), cut)
                for end, cut in zip((0.0, 1.0), cuts, strict=True)
            )
            low, high = np.fmax(low, first), np.fmin(high, last)
            high[np.isnan(first)] = -1.0
        kept = low < high
        way = (ends - starts)[kept]
        return starts[kept] + low[kept, None] * way, starts[kept] + high[kept, None] * way

    def _window(self, low: FloatArray, high: FloatArray) -> tuple[slice, slice, NDArray[Any], NDArray[Any]] | None:
        """Return rows and columns of the pixels between two corners, and their middles; None: outside the picture."""
        height, width = self.heights.shape
        left, right = max(int(low[0]), 0), min(int(high[0]) + 1, width)
        top, bottom = max(int(low[1]), 0), min(int(high[1]) + 1, height)
        if left >= right or top >= bottom:
            return None
        x, y = np.arange(left, right) + 0.5, np.arange(top, bottom)[:, None] + 0.5
        return slice(top, bottom), slice(left, right), x, y


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
