"""A run as a picture (PNG) or a film (GIF, MP4), as the content of a file. Needs no display."""

from __future__ import annotations

import io
from fractions import Fraction

from PIL import Image
from PIL.PngImagePlugin import PngInfo

from cagepose.files.units import LengthUnit
from cagepose.files.write import MADE_BY
from cagepose.runs.run import Run
from cagepose.views.viewer.picture import PictureMaker
from cagepose.views.viewer.playback import Playback, playback
from cagepose.views.viewer.stage import Stage

SHOTS_PER_MOTION = 10
FILM_SIZE = (720, 480)
"""Pixels. At the size of a picture, the rail's 83 shots are 810 kB instead of 590 kB, and take a quarter longer."""
N_FOR_PALETTE = 8
QUALITY = "23"
"""Quality of a video, on its encoder's scale. The rail's has 430 kB; with 18 it would have 670, and look as true."""
SHOT_MS, PAUSE_MS, END_MS = 80, 640, 2480
"""How long a shot stands, the last of an event, and the last of all; videos have a whole number of shots for each."""


def png_bytes(shown: Playback, phase: int | None = None) -> bytes:
    """Return the end of a run, or of one of its phases, as a picture, small motions exaggerated as far as that looks
    right.
    """
    last = next(shot for shot in reversed(shown.shots) if phase in (None, shot.phase))
    notes = PngInfo()
    notes.add_text("Software", MADE_BY)
    stream = io.BytesIO()
    PictureMaker(Stage(shown)).picture(last).save(stream, "PNG", pnginfo=notes, optimize=True)
    return stream.getvalue()


def gif_bytes(run: Run, length_unit: LengthUnit) -> bytes:
    """Return a whole run as a film that starts again when it is over."""
    pictures, durations = _film(run, length_unit)
    palette = _palette(pictures)
    flat = [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures]
    stream = io.BytesIO()
    flat[0].save(
        stream, "GIF", save_all=True, append_images=flat[1:], duration=durations, loop=0, comment=MADE_BY.encode()
    )
    return stream.getvalue()


def mp4_bytes(run: Run, length_unit: LengthUnit) -> bytes:
    """Return a whole run as a film of H.264, which browsers, slides and players show. Needs PyAV."""
    import av

    pictures, durations = _film(run, length_unit)
    stream = io.BytesIO()
    with av.open(stream, "w", "mp4") as file:
        file.metadata["comment"] = MADE_BY
        film = file.add_stream("libx264", Fraction(1000, SHOT_MS), {"crf": QUALITY, "preset": "slow"})
        film.width, film.height = FILM_SIZE
        film.pix_fmt = "yuv420p"  # all that most players know
        for picture, duration in zip(pictures, durations, strict=True):
            frame = av.VideoFrame.from_image(picture)
            for _ in range(round(duration / SHOT_MS)):  # some players know no pictures of different duration
                frame.pts = None
                file.mux(film.encode(frame))
        file.mux(film.encode(None))
    return stream.getvalue()


def _film(run: Run, length_unit: LengthUnit) -> tuple[list[Image.Image], list[int]]:
    """Return the pictures of a film, and for how many milliseconds each stands."""
    shown = playback(run, length_unit, SHOTS_PER_MOTION)
    maker = PictureMaker(Stage(shown), size=FILM_SIZE)
    durations = [SHOT_MS] * len(shown.shots)
    durations[0] = PAUSE_MS
    for row in shown.rows:
        durations[row.last_shot] = PAUSE_MS
    durations[-1] = END_MS
    return [maker.picture(shot) for shot in shown.shots], durations


def _palette(pictures: list[Image.Image]) -> Image.Image:
    """Return a picture with the colours of all, so that none flickers: some pictures below each other."""
    some = pictures[:: max(1, len(pictures) // N_FOR_PALETTE)]
    width, height = some[0].size
    together = Image.new("RGB", (width, height * len(some)))
    for index, picture in enumerate(some):
        together.paste(picture, (0, height * index))
    return together.quantize(256)
