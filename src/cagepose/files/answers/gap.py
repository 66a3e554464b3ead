"""`CriticalGap` as lines."""

from __future__ import annotations

from cagepose.files.words import LengthWords
from cagepose.model.wording import number_of
from cagepose.questions.gap import CriticalGap

DIGITS = 7


def lines(answer: CriticalGap, words: LengthWords) -> list[tuple[str, str]]:
    """Return names and texts; values are as in the scene's file."""
    del words
    caged, escapes = "proven at no value that was tried", "no way out was found at any value that was tried"
    if answer.caged_at is not None:
        caged = f"at {answer.caged_at:.{DIGITS}g} (proven)"
    if answer.escapes_at is not None:
        escapes = f"at {answer.escapes_at:.{DIGITS}g} (by a way that was found)"
    what = "poses" if answer.in_plane else "motions"
    tried = f"{number_of(answer.n_tried, 'value')}, up to {answer.n_motions} {what} at each"
    return [("caged", caged), ("escapes", escapes), ("tried", tried)]
