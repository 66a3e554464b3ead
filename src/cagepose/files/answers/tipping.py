"""`Tipping` as lines."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable

from cagepose.files.answers.no_motion import range_texts
from cagepose.files.words import LengthWords
from cagepose.model.wording import short
from cagepose.questions.tipping import Tipping
from cagepose.runs.run import Contact


def lines(answer: Tipping, words: LengthWords) -> list[tuple[str, str]]:
    """Return names and texts."""

    def shown(force_n: float) -> str:
        return f"{short(force_n, 7, 1e-12)} {'N' if answer.in_newtons else 'of the load'}"

    if math.isinf(answer.force_n):
        greatest = "the contacts can balance any"
    else:
        greatest = f"the contacts can balance up to {shown(answer.force_n)} (certain){_refuted(answer)}"
    told = range_texts(answer.no_motion, answer.up_to_n, shown, words)
    return [
        ("at the end of", answer.phase),
        ("force", greatest),
        *_loss(answer, words),
        *(("" if place else "no motion", text) for place, text in enumerate(told)),
        ("tried", f"{answer.n_tried} forces, up to {shown(answer.up_to_n)}"),
        *_lifts_off(answer, shown, words),
    ]


def _refuted(answer: Tipping) -> str:
    """Return by how much more it is known that they cannot."""
    more = answer.not_at_n - answer.force_n
    if math.isinf(more):
        return ""
    return f", but not {more / answer.force_n:.0e} of that more" if answer.force_n else ", and nothing more"


def _loss(answer: Tipping, words: LengthWords) -> list[tuple[str, str]]:
    loss = answer.loss
    if loss is None:
        return []
    n_places = Counter(contact.point for contact in (*loss.opens, *loss.slips, *loss.sticks))
    ways = (("opens", loss.opens), ("slips", loss.slips), ("sticks", loss.sticks))
    told = [f"{way}: {', '.join(_named(one, n_places, words) for one in found)}" for way, found in ways if found]
    return [("then it", f"{loss.kind}: {words.onset(loss.motion)}"), ("", "; ".join(told))]


def _lifts_off(answer: Tipping, shown: Callable[[float], str], words: LengthWords) -> list[tuple[str, str]]:
    n_places = Counter(found.contact.point for found in answer.lifts_off)
    texts = [f"{_named(found.contact, n_places, words)} from {shown(found.force_n)} on" for found in answer.lifts_off]
    return [("without force", f"{', '.join(texts)}, if contacts are equally stiff")] if texts else []


def _named(contact: Contact, n_places: Counter[str], words: LengthWords) -> str:
    """Return the name of a contact, and where it is if there are several of that name."""
    place = contact.place_world
    if n_places[contact.point] == 1 or place is None:
        return contact.point
    return f"{contact.point} at ({words.lengths(place)})"
