"""What is written on a picture: names of things, what happens, how much it is exaggerated, and a scale."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from PIL import Image, ImageDraw, ImageFont

from cagepose.files.words import LengthWords
from cagepose.runs.changes import mode_of
from cagepose.runs.run import CONTRADICTED, Run
from cagepose.studies.ending import Kind, ending, run_kind
from cagepose.views.drive_words import share_words
from cagepose.views.viewer.labels import Box, Pair, laid_out, leader
from cagepose.views.viewer.look import PAPER
from cagepose.views.viewer.playback import Film, Playback, Shot

LOUD_INK, QUIET_INK = "#000000", "#777777"
"""Inks of names: of loads and contacts, and of cage points that do not touch."""
LEADER_INK = "#8a8a8a"
TITLE_INK, SOFT_INK, SCALE_INK = "#1a1a1a", "#5c5c5c", "#333333"
VERDICT_INK: dict[Kind, str] = {"rest": "#00664a", "open": "#8a6100", "failure": "#a33b00", "elsewhere": "#a33b00"}
MARK = "#e69f00"
SMALL, LARGE = 13.0, 17.0
"""Heights of letters, pixels."""
SCALE_BAR = 100.0
"""The scale bar is at most so long, pixels."""


class Label(NamedTuple):
    """The name of a thing.

    Attributes
    ----------
    place
        Where the thing is, pixels, y down.
    text, ink
        The name and its colour.
    rank
        Names of higher rank choose their places first; one of rank 0 is not moved away to where there is room.
    force
        The force of a contact in words, written behind the name.
    """

    place: Pair
    text: str
    ink: str
    rank: float = 0.0
    force: str = ""


class Caption:
    """Writes on the pictures of one playback."""

    def __init__(self, shown: Film, size: tuple[int, int], units_per_pixel: float) -> None:
        """``size`` is that of a picture in pixels, ``units_per_pixel`` the length of one in the scene's unit."""
        self.shown = shown
        self.width, self.height = size
        self.units_per_pixel = units_per_pixel
        self.small, self.large = (ImageFont.load_default(height) for height in (SMALL, LARGE))

    def write(
        self, image: Image.Image, shot: Shot | None, labels: list[Label], exaggeration: float, taken: Sequence[Box] = ()
    ) -> None:
        """Write on a picture in which play is so many times as large, no names over ``taken``; None for the shot: no
        words above it.
        """
        pen = ImageDraw.Draw(image)
        self._write_names(pen, labels, taken)
        if shot is not None and isinstance(self.shown, Playback):
            self._write_head(pen, self.shown.run, shot)
        self._write_exaggeration(pen, round(exaggeration))
        self._write_scale(pen)

    def _write_head(self, pen: ImageDraw.ImageDraw, run: Run, shot: Shot) -> None:
        pen.text((14.0, 10.0), run.scene.name, TITLE_INK, self.large)
        across = 24.0 + pen.textlength(run.scene.name, self.large)
        ink, verdict = VERDICT_INK[run_kind(run)], ending(run)
        pen.text((across, 10.0), verdict, ink, self.large)
        if run.is_contradicted:
            across += 10.0 + pen.textlength(verdict, self.large)
            pen.text((across, 13.0), CONTRADICTED, ink, self.small)
        pen.text((14.0, 34.0), self._happening(run, shot), SOFT_INK, self.small)

    def _write_names(self, pen: ImageDraw.ImageDraw, labels: list[Label], taken: Sequence[Box]) -> None:
        picture = (self.width, self.height)
        seen = [
            label for label in labels if all(0.0 < at < room for at, room in zip(label.place, picture, strict=True))
        ]
        ranked = sorted(seen, key=lambda label: -label.rank)
        texts = [f"{label.text}  {label.force}".rstrip() for label in ranked]
        sizes = [(pen.textlength(text, self.small), SMALL) for text in texts]
        moving = [label.rank > 0.0 for label in ranked]
        corners = laid_out([label.place for label in ranked], sizes, picture, moving, taken)
        for label, text, size, corner in zip(ranked, texts, sizes, corners, strict=True):
            if corner is not None:
                end = leader(label.place, corner, size)
                if end is not None:
                    pen.line((label.place, end), LEADER_INK)
                self._text(pen, corner, text, label.ink)

    def _happening(self, run: Run, shot: Shot) -> str:
        if shot.row < 0:
            return "start"
        row = self.shown.rows[shot.row]
        words = LengthWords(self.shown.length_unit, self.shown.scene.size_m)
        motion = row.seen
        what = None if motion is None else f"{motion.kind} {words.amount(motion)}"
        far = f"{share_words(shot.share)} of the drive" if shot.share else None
        told = ", ".join(word for word in (mode_of(row.event.rule), what, far, row.verdict) if word)
        return f"{run.phases[row.phase].name}, event {shot.row + 1}: {told}"

    def _write_exaggeration(self, pen: ImageDraw.ImageDraw, times: int) -> None:
        if times == 1:
            pen.text((14.0, self.height - 26.0), "true scale", SOFT_INK, self.small)
            return
        text = f"play and gaps exaggerated x{times}"
        width = pen.textlength(text, self.small)
        pen.rectangle((10.0, self.height - 32.0, 22.0 + width, self.height - 8.0), fill=MARK)
        pen.text((16.0, self.height - 28.0), text, LOUD_INK, self.small)

    def _write_scale(self, pen: ImageDraw.ImageDraw) -> None:
        rough = SCALE_BAR * self.units_per_pixel
        power = 10.0 ** math.floor(math.log10(rough))
        length = next(step * power for step in (5.0, 2.0, 1.0) if step * power <= rough)
        right, below = self.width - 20.0, self.height - 16.0
        left = right - length / self.units_per_pixel
        pen.line((left, below, right, below), fill=SCALE_INK, width=2)
        self._text(pen, (left, below - 20.0), f"{length:.6g} {self.shown.length_unit}", SCALE_INK)

    def _text(self, pen: ImageDraw.ImageDraw, place: Pair, text: str, ink: str) -> None:
        pen.text(place, text, ink, self.small, anchor="la", stroke_width=2, stroke_fill=PAPER)
