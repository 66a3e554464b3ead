"""The contact forces at the end of every phase as a table."""

from __future__ import annotations

import math
from collections.abc import Sequence

from rich.console import RenderableType
from rich.text import Text

from cagepose.cli.console import fits
from cagepose.cli.styles import plain_table
from cagepose.files.words import LengthWords, force_notes, force_words
from cagepose.model.wording import number_of
from cagepose.runs.load_scaling import force_unit
from cagepose.runs.run import Contact, PhaseRun, Run

MOST_ROWS = 30
"""A table has at most so many contacts, those with the greatest forces; ``--verbose`` prints all."""
APART, NO_FORCE = "", "0"
"""What stands for a contact that is none at the end of a phase, and for one that bears nothing."""


def force_table(run: Run, words: LengthWords, width: int, *, is_verbose: bool) -> list[RenderableType]:
    """Return the forces of all phases beside each other, or one below the other where that does not fit; nothing where
    no phase has any. ``is_verbose``: where each contact is, and contacts without a force, too.
    """
    phases = [phase for phase in run.phases if any(contact.force_normal_n for contact in phase.contacts)]
    if not phases:
        return []
    shown_words = words if is_verbose else None
    whole = _table(run, phases, shown_words)
    tables = [whole] if fits(whole, width) else [_table(run, [phase], shown_words) for phase in phases]
    shares = [Text(f"{phase.name}: {note}") for phase in phases for note in force_notes(phase)]
    parts: list[RenderableType] = []
    for table in tables:
        parts += [table, ""]
    n_all = len({(contact.point, contact.box) for phase in phases for contact in phase.contacts if _bears(contact)})
    if n_all > MOST_ROWS and not is_verbose:
        shares.append(
            Text(f"not shown: {number_of(n_all - MOST_ROWS, 'contact')} with smaller forces (--verbose shows them)")
        )
    return [*parts, *shares, ""] if shares else parts


def _table(run: Run, phases: Sequence[PhaseRun], words: LengthWords | None) -> RenderableType:
    """``words``: write where each contact is, and all of them; None: those that bear the most."""
    table = plain_table("contact", "on", *([] if words is None else [f"at [{words.unit}]"]))
    for phase in phases:
        load = run.scene.loads[run.phases.index(phase)]
        unit = "N" if force_unit(run.scene, load) == "N" else "load"
        table.add_column(f"{phase.name} [{unit}]", justify="left", overflow="fold")
    cells = [_cells(phase, words) for phase in phases]
    for place in _places(run, phases, words):
        table.add_row(*map(Text, (*place, *(of_phase.get(place, APART) for of_phase in cells))))
    return table


def _places(run: Run, phases: Sequence[PhaseRun], words: LengthWords | None) -> list[tuple[str, ...]]:
    """Return what touches what at the end of some phase, in the order of the cage: those that bear the most, or all."""
    greatest: dict[tuple[str, ...], float] = {}
    for contact in (contact for phase in phases for contact in phase.contacts):
        place = _place(contact, words)
        greatest[place] = max(greatest.get(place, 0.0), contact.force_normal_n or 0.0)
    found = list(greatest)
    if words is None:
        found = sorted((place for place in found if greatest[place]), key=lambda place: -greatest[place])[:MOST_ROWS]
    order = {name: index for index, name in enumerate(run.scene.cage.element_names)}
    return sorted(found, key=lambda place: (order[place[0]], place[1:]))


def _place(contact: Contact, words: LengthWords | None) -> tuple[str, ...]:
    """Return the first cells of a contact's row."""
    names = (contact.point, contact.box)
    if words is None:
        return names
    return *names, "" if contact.place_world is None else f"({words.lengths(contact.place_world)})"


def _cells(phase: PhaseRun, words: LengthWords | None) -> dict[tuple[str, ...], str]:
    """Return the forces between each point or shape of the cage and each part of the object, face by face."""
    found: dict[tuple[str, ...], list[str]] = {}
    for contact in phase.contacts:
        found.setdefault(_place(contact, words), []).append(_force(contact))
    return {
        place: " and ".join(text for text in texts if text != NO_FORCE) or NO_FORCE for place, texts in found.items()
    }


def _bears(contact: Contact) -> bool:
    return bool(contact.force_normal_n)


def _force(contact: Contact) -> str:
    tangential = 0.0 if contact.force_tangential_n is None else math.hypot(*contact.force_tangential_n)
    return force_words(contact.force_normal_n or 0.0, tangential)
