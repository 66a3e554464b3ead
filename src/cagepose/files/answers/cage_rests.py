"""`CageRests` as lines and as a table."""

from __future__ import annotations

import math

from cagepose.files.words import LengthWords, names_of
from cagepose.model.wording import number_of, short
from cagepose.questions.cage_rests import CageRest, CageRests, turns_freely


def lines(answer: CageRests, words: LengthWords) -> list[tuple[str, str]]:
    """Return names and texts."""
    del words
    n = len(answer.ends_in)
    one = "at the same contacts" if answer.has_friction else "at the same pose"
    told = [
        (
            "rests",
            f"in {number_of(sum(rest.stability is not None for rest in answer.rests), 'way')} under {answer.phase}",
        ),
        ("certainty", f"sampled: let go from {n} poses that are free, of {answer.n_proposed} drawn"),
        ("one row", f"is what ended {one}, but for what the load leaves open"),
    ]
    if answer.not_limited:
        about = "starts lie about the scene's"
        where = f"{about}, turned in any way" if turns_freely(answer.not_limited) else about
        told.append(("no limit", f"{names_of(answer.not_limited)}: the cage sets none there, {where}"))
    return told


def table(answer: CageRests, words: LengthWords) -> list[list[str]]:
    """Return rows of texts, the first one the header."""
    head = [
        "#",
        "share",
        "with 95 %",
        "ends",
        "touches",
        "leaves open",
        f"position ({words.unit})",
        "yaw, pitch, roll (deg)",
    ]
    return [head, *(_row(str(number), rest, len(answer.ends_in), words) for number, rest in enumerate(answer.rests, 1))]


def _row(number: str, rest: CageRest, n: int, words: LengthWords) -> list[str]:
    told = [number, f"{100.0 * rest.n / n:.3g} %", f"{100.0 * rest.low:.3g} to {100.0 * rest.high:.3g} %"]
    if rest.stability is None:
        return [*told, rest.verdict, "", "", "", ""]
    angles = ", ".join(short(math.degrees(angle), 5, 1e-9) for angle in rest.pose.euler_zyx)
    return [
        *told,
        f"{rest.verdict} ({rest.stability})",
        names_of(rest.touching),
        names_of(rest.undetermined),
        f"({words.lengths(rest.pose.position_m)})",
        f"({angles})",
    ]
