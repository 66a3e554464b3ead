"""Where a picture shows contacts: it is compared with one that is the same but for them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from PIL import Image

from cagepose.views.viewer.picture import PictureMaker


def without_marks(maker: PictureMaker) -> Image.Image:
    """The picture of the last shot, as if nothing touched."""
    shown = maker.shown
    last = shown.shots[-1]
    bare = replace(last, touches=last.touches.chosen([False] * len(last.touches.points)))
    maker.shown = replace(shown, shots=(*shown.shots[:-1], bare))
    picture = maker.picture(bare)
    maker.shown = shown
    return picture


def is_marked(pictures: tuple[Image.Image, Image.Image], place: np.ndarray) -> bool:
    """Whether there is something in one picture within a few pixels of a place that is not in the other."""
    x, y = place[:2].astype(int)
    one, other = (np.asarray(picture, dtype=float)[y - 4 : y + 5, x - 4 : x + 5] for picture in pictures)
    return bool(np.abs(one - other).max() > 25.0)
