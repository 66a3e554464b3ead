"""`EscapeEnergy` as lines."""

from __future__ import annotations

import math

from cagepose.files.words import LengthWords, line_of
from cagepose.model.wording import short
from cagepose.questions.escape import EscapeEnergy

NOISE_DEG = 1e-9
"""Angles below this are told as 0."""


def lines(answer: EscapeEnergy, words: LengthWords) -> list[tuple[str, str]]:
    """Return names and texts."""
    told = [("at the end of", answer.phase)]
    if math.isinf(answer.at_least_j):
        return [*told, ("energy", "no work gets it out: it is proven to be caged")]
    tried = ("asked", f"at {answer.n_tried} poses") if answer.in_plane else ("tried", f"{answer.n_tried} motions")
    unit = f"N {words.unit}" if answer.in_newtons else f"{words.unit} times the load"
    least, most = (words.scaled(energy, 0.0) for energy in (answer.at_least_j, answer.at_most_j))
    if math.isinf(answer.at_most_j):
        energy = "not known: no way out was found, and no proof that there is none"
        if answer.at_least_j > 0.0:
            energy = f"at least {least} {unit}, as no way out takes less; none was found"
        return [*told, ("energy", energy), tried]
    energy = f"at most {most} {unit}, by a way that was found; no lower bound is known"
    if answer.at_least_j > 0.0:
        energy = f"at least {least} {unit}, as no way out takes less; at most {most}, by a way that was found"
    if answer.at_most_j == 0.0:
        energy = "none: a way out was found that nowhere goes against the load"
    steps = [
        ("way out" if number == 0 else "", f"{step.motion.kind} {line_of(step.motion)} {words.amount(step.motion)}")
        for number, step in enumerate(answer.path)
    ]
    assert answer.top is not None  # there is a path
    angles = ", ".join(short(math.degrees(angle), 4, NOISE_DEG) for angle in answer.top.euler_zyx)
    top = f"at ({words.lengths(answer.top.position_m)}) {words.unit}, yaw pitch roll ({angles}) deg"
    return [*told, ("energy", energy), ("highest", top), *steps, tried]
