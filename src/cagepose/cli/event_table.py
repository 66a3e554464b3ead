"""The events of a run as text: a table, or two lines for each where that does not fit the screen."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from cagepose.cli.console import fits
from cagepose.cli.styles import plain_table, verdict_style
from cagepose.files.words import LengthWords, line_of, names_of
from cagepose.model.load import Load
from cagepose.runs.changes import Change, changes_of, mode_of
from cagepose.runs.run import AT_REST, Run

DRIVEN = "driven"
"""The rule of an event in which bodies of the cage are driven."""
MOST_NAMES = 12
"""A row names at most so many points and shapes; ``--verbose`` prints all."""


def event_table(run: Run, words: LengthWords, width: int, *, is_verbose: bool) -> list[RenderableType]:
    """Return what to print for the events; ``is_verbose``: with all that touches after each."""
    table = _table(run, words, is_verbose=is_verbose)
    return [table] if fits(table, width) else _lists(run, words, is_verbose=is_verbose)


def _table(run: Run, words: LengthWords, *, is_verbose: bool) -> Table:
    rows = list(changes_of(run))
    has_left, loads = any(row.left for row in rows), _driven(run)
    to = ["driven to"] if loads else []
    mode = "rule" if run.method == "stepwise" else "mode"
    table = plain_table("#", "phase", mode, *to, "motion", "direction / axis", "amount", "new contacts")
    if has_left:
        table.add_column("lost contacts", overflow="fold")
    if is_verbose:
        table.add_column("all contacts", overflow="fold")
    last = run.phases[0]
    for row in rows:
        if row.phase is not last:
            table.add_section()
        last, motion = row.phase, row.seen
        line, amount = ("", "") if motion is None else (line_of(motion), words.amount(motion))
        names = (row.reached, row.left) if has_left else (row.reached,)
        cells = [Text(line), Text(amount), *(Text(listed(of_event, is_verbose=is_verbose)) for of_event in names)]
        if is_verbose:
            cells.append(Text(names_of(row.event.contacts)))
        depth = [Text(_depth(row, loads, words))] if loads else []
        first = (str(row.number), row.phase.name, mode_of(row.event.rule))
        table.add_row(*map(Text, first), *depth, _what(row), *cells)
    return table


def _lists(run: Run, words: LengthWords, *, is_verbose: bool) -> list[RenderableType]:
    """Return the same in two lines for each event: what moved, and what touches now and no more."""
    rows, loads = list(changes_of(run)), _driven(run)
    widths = len(str(len(rows))), max(len(mode_of(row.event.rule)) for row in rows)
    parts: list[RenderableType] = []
    for phase in run.phases:
        table = Table.grid(padding=(0, 2))
        table.add_column(justify="right", min_width=widths[0])
        table.add_column(min_width=widths[1])
        for row in (row for row in rows if row.phase is phase):
            told = _told(row, loads, words, is_verbose=is_verbose)
            table.add_row(Text(str(row.number)), Text(mode_of(row.event.rule)), told)
        parts += [*([""] if parts else []), Text(f"{phase.name}:"), table]
    return parts


def _told(row: Change, loads: Mapping[str, Load], words: LengthWords, *, is_verbose: bool) -> Text:
    told, motion = _what(row), row.seen
    if motion is not None:
        told.append(f" {words.amount(motion)} {'along' if motion.kind == 'travel' else 'about'} {line_of(motion)}")
    if row.event.rule == DRIVEN:
        told.append(f", driven to {_depth(row, loads, words)}")
    for sign, names in (("+", row.reached), ("-", row.left)):
        if names:
            told.append(f"\n{sign} {listed(names, is_verbose=is_verbose)}")
    if is_verbose:
        told.append(f"\ntouching {names_of(row.event.contacts) or 'nothing'}")
    return told


def listed(names: Sequence[str], *, is_verbose: bool) -> str:
    """Return names in a row, of many the first alone unless all are asked for."""
    if is_verbose or len(names) <= MOST_NAMES:
        return names_of(names)
    return f"{names_of(names[:MOST_NAMES])} and {len(names) - MOST_NAMES} more"


def _what(row: Change) -> Text:
    """The motion, or what the phase came to where nothing moved; beside a body that is driven the object stands."""
    if row.seen is not None:
        return Text(row.seen.kind)
    verdict = row.phase.verdict if row.event is row.phase.events[-1] else None
    if row.event.rule == DRIVEN and (verdict is None or verdict in AT_REST):
        return Text("stands still")
    return Text(verdict or "-", style=verdict_style(verdict) if verdict else "")


def _driven(run: Run) -> dict[str, Load]:
    """Return the loads that drive bodies, or let them press, by the names of their phases."""
    return {load.name: load for load in run.scene.loads if load.drive or load.press}


def _depth(row: Change, loads: Mapping[str, Load], words: LengthWords) -> str:
    """Return how far the bodies have got after an event; empty in a phase that moves none."""
    load, press = loads.get(row.phase.name), row.phase.press
    if press is not None and row.phase.drive is None:
        return f"{words.lengths(press.ways_at(row.event.share).values())} {words.unit}"
    return "" if load is None else words.depth(load, row.event.share)
