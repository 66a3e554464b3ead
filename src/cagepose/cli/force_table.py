"""The contact forces at the end of every phase as a table."""

from __future__ import annotations

import math
from collections.abc import Sequence

from rich.console import RenderableType
from rich.text import Text

from cagepose.cli.console import fits
from cagepose.cli.styles import plain_table
from cagepose.files.words import names_of
from cagepose.runs.load_scaling import force_unit
from cagepose.runs.run import Contact, PhaseRun, Run

SIDEWAYS = 1e-9
"""Of a normal force: less than that across it is rounding."""
MOST_ROWS = 30
"""Of contacts, those with the greatest forces; ``--verbose`` prints all."""
APART, NO_FORCE = "", "0"
"""What stands for a contact that is none at the end of a phase, and for one that bears nothing."""


def force_table(run: Run, width: int, *, is_verbose: bool) -> list[RenderableType]:
    """Return the forces of all phases beside each other, or one below the other where that does not fit; nothing where
    no phase has any. ``is_verbose``: contacts without a force, too.
    """
    phases = [phase for phase in run.phases if any(contact.force_normal_n for contact in phase.contacts)]
    if not phases:
        return []
    whole = _table(run, phases, is_verbose=is_verbose)
    tables = [whole] if fits(whole, width) else [_table(run, [phase], is_verbose=is_verbose) for phase in phases]
    shares = [
        Text(f"{phase.name}: one way of many to share the load between {names_of(phase.proof.shared)}")
        for phase in phases
        if phase.proof.shared
    ]
    parts: list[RenderableType] = []
    for table in tables:
        parts += [table, ""]
    n_all = len({(contact.point, contact.box) for phase in phases for contact in phase.contacts if _bears(contact)})
    if n_all > MOST_ROWS and not is_verbose:
        shares.append(Text(f"not shown: {n_all - MOST_ROWS} contacts that bear less (--verbose shows them)"))
    return [*parts, *shares, ""] if shares else parts


def _table(run: Run, phases: Sequence[PhaseRun], *, is_verbose: bool) -> RenderableType:
    table = plain_table("contact", "on")
    for phase in phases:
        load = run.scene.loads[run.phases.index(phase)]
        unit = "N" if force_unit(run.scene, load) == "N" else "load"
        table.add_column(f"{phase.name} [{unit}]", justify="left", overflow="fold")
    cells = [_cells(phase) for phase in phases]
    for place in _places(run, phases, is_verbose=is_verbose):
        table.add_row(*map(Text, (*place, *(of_phase.get(place, APART) for of_phase in cells))))
    return table


def _places(run: Run, phases: Sequence[PhaseRun], *, is_verbose: bool) -> list[tuple[str, str]]:
    """Return what touches what at the end of some phase, in the order of the cage: those that bear the most, or all."""
    greatest: dict[tuple[str, str], float] = {}
    for contact in (contact for phase in phases for contact in phase.contacts):
        place = (contact.point, contact.box)
        greatest[place] = max(greatest.get(place, 0.0), contact.force_normal_n or 0.0)
    found = list(greatest)
    if not is_verbose:
        found = sorted((place for place in found if greatest[place]), key=lambda place: -greatest[place])[:MOST_ROWS]
    order = {name: index for index, name in enumerate(run.scene.cage.element_names)}
    return sorted(found, key=lambda place: (order[place[0]], place[1]))


def _cells(phase: PhaseRun) -> dict[tuple[str, str], str]:
    """Return the forces between each point or shape of the cage and each part of the object, face by face."""
    found: dict[tuple[str, str], list[str]] = {}
    for contact in phase.contacts:
        found.setdefault((contact.point, contact.box), []).append(_force(contact))
    return {
        place: " and ".join(text for text in texts if text != NO_FORCE) or NO_FORCE for place, texts in found.items()
    }


def _bears(contact: Contact) -> bool:
    return bool(contact.force_normal_n)


def _force(contact: Contact) -> str:
    """``72.28 + 9.757 across``: along the normal, and across it."""
    if contact.force_normal_n is None or not _bears(contact):
        return NO_FORCE
    across = 0.0 if contact.force_tangential_n is None else math.hypot(*contact.force_tangential_n)
    beside = f" + {across:.4g} across" if across > SIDEWAYS * contact.force_normal_n else ""
    return f"{contact.force_normal_n:.4g}{beside}"
