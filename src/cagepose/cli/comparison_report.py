"""A comparison as text: a table of the variants, then where they differ."""

from __future__ import annotations

import math
from collections.abc import Sequence

from rich.table import Table
from rich.text import Text

from cagepose.cli.console import fits, print_all, screen_width
from cagepose.cli.styles import STYLES, plain_table
from cagepose.files.units import LengthUnit, from_metres
from cagepose.model.wording import number_of, short
from cagepose.studies.comparison import Comparison, Variant
from cagepose.studies.ending import run_kind


def print_comparison(comparison: Comparison, unit: LengthUnit) -> None:
    """Print to standard output, lengths in ``unit``."""
    rows = [_row(variant, unit) for variant in comparison.variants]
    table = plain_table(
        "variant", "verdict", "proof", f"centre of gravity ({unit})", "yaw, pitch, roll (deg)", "events"
    )
    for row in rows:
        table.add_row(*row)
    blocks = []
    for (where, reason), labels in _partings(comparison).items():
        differ = "differs" if len(labels) == 1 else "differ"
        blocks.append("\n".join((*labels, f"    {differ} from stepwise {where}: {reason}")))
    n_others = len(comparison.variants) - 1
    together = n_others - len(comparison.partings)
    if together:
        blocks.append(f"{together} of {n_others} {'has' if together == 1 else 'have'} the same events as stepwise")
    name = comparison.variants[0].run.scene.name
    shown = table if fits(table, screen_width()) else _list(rows, unit)
    print_all(Text(name), "", shown, "", Text("\n\n".join(blocks)))


def _list(rows: Sequence[Sequence[Text]], unit: LengthUnit) -> Table:
    """Return the rows as three lines each, for a screen that is too narrow for the table."""
    table = Table.grid(padding=(0, 2))
    for label, verdict, proof, center, angles, n_events in rows:
        ended = Text.assemble(verdict, f" (proof: {proof}), {number_of(int(n_events.plain), 'event')}")
        table.add_row(label, ended)
        table.add_row("  centre of gravity", Text(f"({center}) {unit}"))
        table.add_row("  yaw, pitch, roll", Text(f"({angles}) deg"))
    return table


def _partings(comparison: Comparison) -> dict[tuple[str, str], list[str]]:
    """Variants that part at one place for one reason are told together."""
    found: dict[tuple[str, str], list[str]] = {}
    for parting in comparison.partings:
        place = "at the end" if parting.first_number is None else f"from event {parting.first_number} on"
        found.setdefault((f"in {parting.phase!r} {place}", parting.reason), []).append(parting.label)
    return found


def _row(variant: Variant, unit: LengthUnit) -> list[Text]:
    run = variant.run
    proof = run.phases[-1].proof
    noise = 1e-12 * float(from_metres(run.scene.size_m, unit))
    center = ", ".join(short(float(from_metres(value, unit)), 6, noise) for value in run.center_of_gravity_world)
    angles = ", ".join(short(math.degrees(angle), 6, 1e-10) for angle in run.pose.euler_zyx)
    held = proof.verdict if proof.stability is None else f"{proof.verdict}, {proof.stability}"
    n_events = sum(len(phase.events) for phase in run.phases)
    return [
        Text(variant.label),
        Text(run.verdict, style=STYLES[run_kind(run)]),
        Text(held),
        Text(center),
        Text(angles),
        Text(str(n_events)),
    ]
