"""The terminal, or what stands for it: tables that fit a screen, and plain text in a pipe."""

from __future__ import annotations

import sys

from rich.console import Console, RenderableType
from rich.measure import Measurement

PIPED_WIDTH = 100_000
"""Columns when nobody looks at a screen: nothing wraps, nothing is cut; tables still take only what they need."""


def fits_screen(part: RenderableType) -> bool:
    """Whether a part can be printed without wrapping any of it."""
    console = _console()
    whole = console.options.update(max_width=PIPED_WIDTH)
    return Measurement.get(console, whole, part).maximum <= console.width


def print_all(*parts: RenderableType) -> None:
    """Print to standard output, one part below the other."""
    on_screen, console = sys.stdout.isatty(), _console()
    with console.capture() as captured:
        console.print(*parts, sep="\n")
    text = captured.get()
    sys.stdout.write(text if on_screen else "".join(f"{line.rstrip()}\n" for line in text.splitlines()))


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
