"""Ranges in which no motion can begin, as texts."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from cagepose.files.words import LengthWords
from cagepose.questions.no_motion import NoMotion


def range_texts(
    ranges: Sequence[NoMotion], up_to: float, shown: Callable[[float], str], words: LengthWords
) -> list[str]:
    """Return each range in words, and what is just beside it; ``up_to`` is the greatest value that was tried, and
    ``shown`` writes a value.
    """
    texts = []
    for found in ranges:
        end = "on" if found.shown_to == up_to else f"to {shown(found.shown_to)}"
        open_end = "; not shown above" if found.shown_to < up_to and found.motion_again_at is None else ""
        texts.append(f"from {shown(found.shown_from)} {end} no motion can begin{open_end}")
        for value, motion in ((found.motion_at, found.motion), (found.motion_again_at, found.motion_again)):
            if value is not None and motion is not None:
                texts.append(f"at {shown(value)} one can: {words.onset(motion)}")
    return texts or ["not shown at any value that was tried"]
