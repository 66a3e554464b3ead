"""How all pictures look, and how they are written to a file.

Colours are those of Okabe and Ito, which colour-blind readers tell apart; a line also has its own dashes and markers, a
band its own hatching, so that black and white prints stay legible.
"""

from __future__ import annotations

import io
import warnings
from collections.abc import Mapping
from typing import Any

from matplotlib import rc_context
from matplotlib.figure import Figure

from cagepose.files.write import MADE_BY

BLACK, GREY, PALE = "#000000", "#6e6e6e", "#d9d9d9"
BLUE, VERMILLION, GREEN = "#0072b2", "#d55e00", "#009e73"
ORANGE, PURPLE, SKY = "#e69f00", "#cc79a7", "#56b4e9"
SAND, BROWN = "#b8a88c", "#5c4d33"
"""Colours of the cage's bodies. They are none of those above, but are told from them by their lightness, too."""

Look = Mapping[str, Any]
"""matplotlib's keywords for how something is drawn."""

SERIES: tuple[Look, ...] = (
    {"color": BLUE, "linestyle": "-", "marker": "o"},
    {"color": VERMILLION, "linestyle": "--", "marker": "s"},
    {"color": GREEN, "linestyle": "-.", "marker": "^"},
)
"""Three lines in one panel: yaw, pitch, roll, or x, y, z."""

POINT_LOOKS: Mapping[str, Look] = {
    "free": {"color": GREY, "markerfacecolor": "white", "markersize": 3.0},
    "touching": {"color": VERMILLION, "markerfacecolor": ORANGE, "markersize": 5.0},
    "reached": {"color": VERMILLION, "markersize": 5.0},
}
"""Cage points, by what they do at the end of an event."""

PAGE_WIDTH_IN = 7.5
"""Fits a page of A4 or letter paper at full size, so that the letters below keep their size in print."""

SETTINGS: Any = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],  # comes with matplotlib: the same picture on every machine
    "font.size": 9.0,
    "axes.titlesize": 9.5,
    "axes.labelsize": 9.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.unicode_minus": True,
    "xtick.labelsize": 8.5,
    "ytick.labelsize": 8.5,
    "legend.fontsize": 8.5,
    "legend.frameon": False,
    "lines.linewidth": 1.4,
    "lines.markersize": 3.2,
    "hatch.linewidth": 0.5,
    "text.parse_math": False,  # a name with dollar signs is no formula
    "svg.hashsalt": "cagepose",  # the same run gives the same file, byte for byte
    "figure.dpi": 100.0,
    "savefig.dpi": 200.0,
}

_METADATA: dict[str, dict[str, str | None]] = {
    ".png": {"Software": MADE_BY},
    ".svg": {"Creator": MADE_BY, "Date": None},
    ".pdf": {"Creator": MADE_BY, "CreationDate": None},
}

_WRITER: dict[str, dict[str, Any]] = {".png": {"pil_kwargs": {"compress_level": 3}}}
"""What goes to the writer of a kind of file: for PNG, half the default level saves 0.1 s and costs a tenth in size."""


def styled() -> Any:
    """Return a context in which pictures are drawn and written in this style; the reader's own settings stay."""
    return rc_context(SETTINGS)


def figure_bytes(figure: Figure, suffix: str) -> bytes:
    """Return a picture as the content of a file of the kind ``suffix``, marked as made by us."""
    stream = io.BytesIO()
    with styled(), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph")  # a name in a script that the font lacks is drawn as boxes
        engine = figure.get_layout_engine()
        if engine is not None:  # laid out once, and not by drawing it all once more before each file: a fifth faster
            engine.execute(figure)
            figure.set_layout_engine(None)
        figure.savefig(stream, format=suffix.removeprefix("."), metadata=_METADATA[suffix], **_WRITER.get(suffix, {}))
    return stream.getvalue()


def inner_svg(content: bytes) -> str:
    """Return an SVG file without what stands before its first tag, to stand within a page."""
    text = content.decode()
    return text[text.index("<svg") :]
