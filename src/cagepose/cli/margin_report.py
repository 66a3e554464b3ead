"""A margin, or the limits of what presses, as lines of the table of `cagepose run`."""

from __future__ import annotations

import math
from collections import Counter

from cagepose.cli.tolerances import LEAST_PRESS
from cagepose.files.units import from_metres
from cagepose.files.words import SIDEWAYS_OF_NORMAL, LengthWords
from cagepose.model.checks import FloatArray
from cagepose.model.wording import components, short
from cagepose.runs.run import Run
from cagepose.studies.margin import ContactMargin, Margin
from cagepose.studies.press_limits import press_limits


def margin_lines(margin: Margin | None, words: LengthWords) -> list[tuple[str, str]]:
    """Return names and texts: the extra force, the extra moment, and what each contact may carry."""
    if margin is None:
        return [("margin", "not known: the contacts do not balance the load, or only by forces of unlimited size")]
    arm_unit = f"N {words.unit}" if margin.in_newtons else f"{words.unit} times the load"
    moment = float(from_metres(margin.moment_nm, words.unit))
    n_places = Counter(contact.point for contact in margin.contacts)
    carries = [_carries(contact, words, is_one=n_places[contact.point] == 1) for contact in margin.contacts]
    force_unit = "N" if margin.in_newtons else "of the load"
    return [
        ("margin of force", _extra(margin.force_n, force_unit, "along", margin.force_direction_world)),
        ("margin of moment", _extra(moment, arm_unit, "about", margin.moment_direction_world)),
        ("equal stiffness", ", ".join(carries) or "no contact"),
    ]


def press_lines(run: Run) -> list[tuple[str, str]]:
    """Return names and texts: between which forces what presses in the last phase may press."""
    limits = press_limits(run)
    if not limits:
        return [("may press", "not known: no pressing force was found at which everything is in equilibrium")]
    return [("may press", "; ".join(f"{name} with {_between(*ends)}" for name, ends in limits.items()))]


def _between(least: float, most: float) -> str:
    """``7.42545 N or more``; ``0.2 to 12.5 N``."""
    upward = "N or more" if math.isinf(most) else f"to {short(most, 6, LEAST_PRESS)} N"
    return f"{short(least, 6, LEAST_PRESS)} {upward}"


def _extra(certain: float, unit: str, preposition: str, direction: FloatArray) -> str:
    if math.isinf(certain):
        return "unlimited"
    least = f"{certain:.4g} {unit}" if certain else "none"
    return f"{least}, in the weakest direction: {preposition} ({components(direction)})"


def _carries(contact: ContactMargin, words: LengthWords, *, is_one: bool) -> str:
    """``C1 0.25 (+ 0.05 friction; 0 to 0.5)``; of a name at several places ``floor at (1, 2, 0) 0.25 (0 to 0.5)``."""
    place = contact.place_world
    at = "" if is_one or place is None else f" at ({words.lengths(place)})"
    tangential = math.hypot(*contact.equally_stiff_tangential_n)
    beside = f"+ {tangential:.4g} friction; " if tangential > SIDEWAYS_OF_NORMAL * contact.equally_stiff_n else ""
    greatest = "unlimited" if math.isinf(contact.greatest_n) else f"{contact.greatest_n:.4g}"
    return f"{contact.point}{at} {contact.equally_stiff_n:.4g} ({beside}{contact.least_n:.4g} to {greatest})"
