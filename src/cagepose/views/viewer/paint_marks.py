"""Marks in a picture: rods, arrows, balls, and pins."""

from __future__ import annotations

import numpy as np

from cagepose.model.checks import FloatArray
from cagepose.views.viewer import look
from cagepose.views.viewer.look import PAINT, ink
from cagepose.views.viewer.paint_bodies import BodyPainter


class MarkPainter:
    """Paints marks at places, (3,) in drawing units, over the bodies of a picture. Widths are in the picture's pixels,
    so that marks look alike from near and far.
    """

    def __init__(self, bodies: BodyPainter) -> None:
        self.eye, self.raster, self.finer = bodies.eye, bodies.raster, bodies.finer
        self.pixels = bodies.pixels

    def rod(
        self, start: FloatArray, end: FloatArray, pixels: float, paint: str, end_pixels: float | None = None
    ) -> None:
        """Paint a rod of a radius, or a cone that has another one at its end."""
        first, last = self.pixels(np.stack([start, end]))
        last_radius = None if end_pixels is None else end_pixels * self.finer
        self.raster.rod(first, last, pixels * self.finer, ink(paint), last_radius)

    def arrow(self, tail: FloatArray, tip: FloatArray, pixels: float, paint: str) -> None:
        """Paint an arrow with a shaft of a radius; one shorter than a pixel is none."""
        length, pixel = float(np.linalg.norm(tip - tail)), self.eye.pixel(tip)
        if length < pixel:
            return
        head = min(look.HEAD[1] * pixel, 0.7 * length)
        neck = tip - head / length * (tip - tail)
        self.rod(tail, neck, pixels, paint)
        self.rod(neck, tip, max(look.HEAD[0], 2.3 * pixels), paint, 0.0)

    def ball(self, place: FloatArray, pixels: float, paint: str) -> None:
        """Paint a ball of a radius."""
        self.raster.ball(self.pixels(place), pixels * self.finer, ink(paint))

    def pin(self, tip: FloatArray, way: FloatArray) -> None:
        """Paint a pin from its tip along a way as long as it is, in drawing units: a body of the cage, which hides."""
        base = tip + way
        radius = look.PIN_SLOPE * float(np.linalg.norm(way)) / self.eye.pixel(base) * self.finer
        first, last = self.pixels(np.stack([tip, base]))
        self.raster.rod(first, last, 0.0, ink(PAINT["pin"]), radius, faint=0.0)
