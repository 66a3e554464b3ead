"""What each event of a run reaches, and what it leaves."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from cagepose.runs.run import Event, PhaseRun, Run


class Change(NamedTuple):
    """An event, its number in the run from 1 on, its phase, and the names that touch from it on, and no more."""

    number: int
    event: Event
    phase: PhaseRun
    reached: tuple[str, ...]
    left: tuple[str, ...]


def changes_of(run: Run) -> Iterator[Change]:
    """Yield what changes with each event; of what touches from the start on, the first reaches what it hits alone."""
    number = 0
    before: tuple[str, ...] = ()
    for phase in run.phases:
        for event in phase.events:
            number += 1
            is_new = set(event.hit if number == 1 else (*event.hit, *(set(event.contacts) - set(before))))
            reached = tuple(name for name in event.contacts if name in is_new)
            left = tuple(name for name in before if name not in event.contacts)
            yield Change(number, event, phase, reached, left)
            before = event.contacts
