"""The terminal, or what stands for it: tables that fit a screen, and plain text in a pipe."""

from __future__ import annotations

import io
import shutil
import sys

from rich.console import Console, RenderableType
from rich.measure import Measurement

PIPED_WIDTH = 100_000
"""Columns when nobody looks at a screen: nothing wraps, nothing is cut; tables still take only what they need."""
TEXT_WIDTH = 100
"""Columns of text for somebody who looks at no terminal, as in a notebook."""


def screen_width() -> int:
    """Return how many columns standard output has."""
    return _console().width


def text_width() -> int:
    """Return how many columns a text should have that somebody may print."""
    return shutil.get_terminal_size().columns if sys.stdout.isatty() else TEXT_WIDTH


def fits(part: RenderableType, width: int) -> bool:
    """Whether a part can be printed in so many columns without wrapping any of it."""
    console = _console()
    whole = console.options.update(max_width=PIPED_WIDTH)
    return Measurement.get(console, whole, part).maximum <= width


def print_all(*parts: RenderableType) -> None:
    """Print to standard output, one part below the other."""
    on_screen, console = sys.stdout.isatty(), _console()
    with console.capture() as captured:
        console.print(*parts, sep="\n")
    text = captured.get()
    sys.stdout.write(text if on_screen else _stripped(text))


def text_of(*parts: RenderableType, width: int) -> str:
    """Return parts as plain text, one below the other."""
    stream = io.StringIO()
    console = Console(file=stream, width=width, highlight=False, markup=False, emoji=False)
    console.print(*parts, sep="\n")
    return _stripped(stream.getvalue()).removesuffix("\n")


def _stripped(text: str) -> str:
    return "".join(f"{line.rstrip()}\n" for line in text.splitlines())


def _console() -> Console:
    on_screen = sys.stdout.isatty()
    return Console(
        file=sys.stdout,
        width=None if on_screen else PIPED_WIDTH,
        force_terminal=on_screen,
        highlight=False,
        markup=False,
        emoji=False,
    )
