"""`FrictionLimits` as lines."""

from __future__ import annotations

import math

from cagepose.files.words import LengthWords, friction_words
from cagepose.questions.friction import FrictionLimits, NoMotion

DIGITS = 7
"""Of coefficients that are closed in to a millionth."""


def lines(answer: FrictionLimits, words: LengthWords) -> list[tuple[str, str]]:
    """Return names and texts."""
    scale = answer.present if answer.has_several else None
    if math.isinf(answer.balance):
        balance = "no friction is enough for the contacts to balance the load"
    else:
        balance = f"from {friction_words(answer.balance, scale)} on the contacts can balance the load (exact)"
    tried = f"{answer.n_tried} coefficients, up to {friction_words(answer.up_to, scale, DIGITS)}"
    if not answer.no_motion:
        return [
            ("at the end of", answer.phase),
            ("balance", balance),
            ("no motion", f"not shown at any coefficient ({tried})"),
        ]
    told = [line for found in answer.no_motion for line in _of_range(found, answer, words)]
    return [
        ("at the end of", answer.phase),
        ("balance", balance),
        *(("" if place else "no motion", line) for place, line in enumerate(told)),
        ("tried", tried),
    ]


def _of_range(found: NoMotion, answer: FrictionLimits, words: LengthWords) -> list[str]:
    """Return the range in words, and then what is just below it."""

    def shown(coefficient: float) -> str:
        return friction_words(coefficient, answer.present if answer.has_several else None, DIGITS)

    if found.shown_to == answer.up_to:
        within = f"from {shown(found.shown_from)} on no motion can begin"
    elif found.motion_again_at is None:
        within = f"from {shown(found.shown_from)} to {shown(found.shown_to)} no motion can begin; not shown above"
    else:
        within = (
            f"from {shown(found.shown_from)} to {shown(found.shown_to)} no motion can begin;"
            f" at {shown(found.motion_again_at)} one can"
        )
    if found.motion_at is None or found.motion is None:
        return [within]
    return [within, f"at {shown(found.motion_at)} one can: {words.onset(found.motion)}"]
