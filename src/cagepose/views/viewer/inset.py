"""A small picture of the whole in the corner of a picture of a part, with the part framed: `Inset`."""

from __future__ import annotations

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from cagepose.model.checks import FloatArray
from cagepose.views.viewer import look
from cagepose.views.viewer.eye import Eye
from cagepose.views.viewer.labels import Box
from cagepose.views.viewer.look import PAINT
from cagepose.views.viewer.paint_bodies import BodyPainter, Room
from cagepose.views.viewer.paint_marks import MarkPainter
from cagepose.views.viewer.raster import Raster

BORDER, FRAME = "#b8bcc2", "#1a1a1a"
LETTERS = 11.0
"""Height of letters, pixels."""
ARROW = 20.0
"""Pixels: so long is the arrow of a load that is not in the picture itself."""


class Inset:
    """The whole, seen from the same side. What ``bodies`` and `arrow` paint is there until `paste`."""

    def __init__(self, stage: Room, picture: Eye, whole: FloatArray, radius: float, finer: int) -> None:
        """``picture`` is the eye of the picture, ``whole`` all places to be seen, (n, 3), and ``radius`` that of the
        scene, drawing units.
        """
        width = float(picture.size[0])
        across, down = (round(share * width) for share in look.INSET)
        self.corner = (
            round(width - across - look.INSET_FROM_EDGE[0]),
            round(picture.size[1] - down - look.INSET_FROM_EDGE[1]),
        )
        self.picture, self.finer = picture, finer
        self.eye = Eye((across, down), look.DISTANCE_OF_EYE * radius)
        self.eye.fit(radius, lambda: whole)
        self.raster = Raster(across * finer, down * finer)
        self.bodies = BodyPainter(stage, self.eye, self.raster, finer)
        self.names: list[tuple[FloatArray, str]] = []

    @property
    def box(self) -> Box:
        """What it covers of the picture, pixels."""
        return self.corner, (float(self.eye.size[0]), float(self.eye.size[1]))

    def arrow(self, place: FloatArray, direction: FloatArray, name: str) -> None:
        """Paint the arrow of a load that acts at a place along a unit vector, (3,) each, drawing units."""
        tail = place - ARROW * self.eye.pixel(place) * direction
        MarkPainter(self.bodies).arrow(tail, place, look.THIN, PAINT["load"])
        self.names.append((self.eye.pixels(tail)[:2], name))

    def paste(self, image: Image.Image) -> None:
        """Put all into the corner of the picture, and begin anew."""
        small, size = self.raster.shrunk(self.finer), self.eye.size
        pen = ImageDraw.Draw(small)
        middle = self.eye.pixels(self.picture.target)[:2]
        half = self.picture.size / 2.0 * self.picture.pixel() / self.eye.pixel(self.picture.target)
        pen.rectangle((*(middle - half).tolist(), *(middle + half).tolist()), outline=FRAME)
        font = ImageFont.load_default(LETTERS)
        for (x, y), name in self.names:
            left = float(np.clip(x - pen.textlength(name, font) / 2.0, 3.0, size[0] - pen.textlength(name, font) - 3.0))
            pen.text((left, max(2.0, float(y) - LETTERS - 5.0)), name, FRAME, font)
        pen.rectangle((0, 0, small.width - 1, small.height - 1), outline=BORDER)
        image.paste(small, self.corner)
        self.names = []
        self.raster.begin()
