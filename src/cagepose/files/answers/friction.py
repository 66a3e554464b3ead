"""`FrictionLimits` as lines."""

from __future__ import annotations

import math

from cagepose.files.answers.no_motion import range_texts
from cagepose.files.words import LengthWords, friction_words
from cagepose.questions.friction import FrictionLimits

DIGITS = 7
"""Of coefficients that are closed in to a millionth."""


def lines(answer: FrictionLimits, words: LengthWords) -> list[tuple[str, str]]:
    """Return names and texts."""
    scale = answer.present if answer.has_several else None
    if math.isinf(answer.balance):
        balance = "no friction is enough for the contacts to balance the load"
    else:
        balance = f"from {friction_words(answer.balance, scale)} on the contacts can balance the load (exact)"
    told = range_texts(answer.no_motion, answer.up_to, lambda value: friction_words(value, scale, DIGITS), words)
    return [
        ("at the end of", answer.phase),
        ("balance", balance),
        *(("" if place else "no motion", text) for place, text in enumerate(told)),
        ("tried", f"{answer.n_tried} coefficients, up to {friction_words(answer.up_to, scale, DIGITS)}"),
    ]
