"""A `Play` as text: a table of ranges, what limits them, the verdict on the cage."""

from __future__ import annotations

import math
from collections.abc import Sequence

from rich.box import SIMPLE_HEAD
from rich.table import Table
from rich.text import Text

from cagepose.cli.console import print_all
from cagepose.cli.play_document import LENGTHS
from cagepose.files.units import LengthUnit, from_metres
from cagepose.files.words import short
from cagepose.nouns.checks import FloatArray
from cagepose.studies.play import Play, PlayEnd
from cagepose.studies.play_rest import PlayRest

MOST_CLEARANCES = 4
"""Of those that limit an end, so many are printed; the document has all."""
ALIKE = 0.99
"""Clearances worth this part of the best one are as good to close."""
STYLES = {"caged": "bold green", "not certified": "bold yellow", "escapes": "bold red"}


def print_play(play: Play, rests: Sequence[PlayRest], unit: LengthUnit) -> None:
    """Print to standard output, lengths in ``unit``, angles in degrees."""
    table = Table(box=SIMPLE_HEAD, show_edge=False, pad_edge=False, collapse_padding=True)
    for heading in ("", "unit", "linear", "exact", "certified within"):
        table.add_column(heading, overflow="fold")
    why = Table(box=SIMPLE_HEAD, show_edge=False, pad_edge=False, collapse_padding=True)
    for heading in ("end", f"to halve it, {unit}", "limited by", f"less per {unit} closed", f"more per {unit} opened"):
        why.add_column(heading, overflow="fold")
    rows = [(name, name in LENGTHS, ends.low, ends.high) for name, ends in play.freedoms.items()]
    rows += [(_point_name(place, play, unit), True, point.low, point.high) for place, point in enumerate(play.points)]
    for name, is_length, low, high in rows:
        unit_name = str(unit) if is_length else "deg"
        ranges = [
            f"{_value(getattr(low, kind), is_length, unit)} to {_value(getattr(high, kind), is_length, unit)}"
            for kind in ("linear", "exact")
        ]
        is_certified = low.certified is not None and high.certified is not None
        bound = f"{_value(low.certified, is_length, unit)} to {_value(high.certified, is_length, unit)}"
        table.add_row(*(Text(cell) for cell in (name, unit_name, *ranges, bound if is_certified else "-")))
        for sign, end in (("least", low), ("greatest", high)):
            if end.clearances:
                why.add_row(Text(f"{sign} {name}"), *(Text(cell) for cell in _limits(end, is_length, unit)))
    cage = play.cage
    verdict = Text("cage: ")
    verdict.append(cage.verdict, style=STYLES[cage.verdict])
    verdict.append(f" ({cage.reason})")
    print_all(Text(f"{play.scene.name}: play from the start pose, in the cage's frame"), "", verdict)
    if cage.free_directions:
        print_all(Text(f"free directions: {' '.join(cage.free_directions)}"))
    if cage.leaves_at is not None:
        print_all(Text(f"it leaves its face with the object's origin at ({_triple(cage.leaves_at.position_m, unit)})"))
    print_all("", table, "", why, "")
    for rest in rests:
        print_all(_rest(rest, unit))
    print_all(Text(f"analysis {play.analysis_s * 1e3:.3g} ms, certificate {play.certificate_s * 1e3:.3g} ms"))


def _rest(rest: PlayRest, unit: LengthUnit) -> Text:
    """One line: where the load leaves the object, by which points, and what it leaves open."""
    line = Text(f"{rest.phase} presses it ")
    pose = rest.pose_world_object or rest.linear_pose_world_object
    if pose is None:
        return line.append("out: nothing stops the load")
    angles = ", ".join(short(math.degrees(angle), 4, 1e-9) for angle in pose.euler_zyx)
    forces = ", ".join(f"{force.point} {force.force_n:.4g}" for force in rest.exact_forces or rest.forces)
    line.append(f"to ({_triple(pose.position_m, unit)}), yaw, pitch, roll ({angles}) deg, without friction;")
    line.append(f" forces{' [N]' if rest.in_newtons else ''}: {forces}")
    if rest.undetermined:
        line.append(f"; free along {' '.join(freedom.name for freedom in rest.undetermined)}")
    return line


def _triple(lengths_m: FloatArray, unit: LengthUnit) -> str:
    return ", ".join(short(value, 6, 1e-12) for value in from_metres(lengths_m, unit).tolist())


def _point_name(place: int, play: Play, unit: LengthUnit) -> str:
    point = play.points[place]
    at = ", ".join(f"{value:.6g}" for value in from_metres(point.at_object, unit).tolist())
    along = ", ".join(short(value, 4, 1e-12) for value in point.direction_cage.tolist())
    return f"({at}) along ({along})"


def _value(value: float | None, is_length: bool, unit: LengthUnit) -> str:
    if value is None:
        return "no end"
    shown = float(from_metres(value, unit)) if is_length else math.degrees(value)
    return short(shown, 6, 1e-12)


def _limits(end: PlayEnd, is_length: bool, unit: LengthUnit) -> tuple[str, str, str, str]:
    """Return the gap to close for half of an end, the points that limit it, and what their gaps are worth."""
    factor = 1.0 if is_length else math.degrees(1.0) / float(from_metres(1.0, unit))
    shown = end.clearances[:MOST_CLEARANCES]
    names = ", ".join(clearance.point for clearance in shown)
    closing = ", ".join(f"{clearance.closing * factor:.4g}" for clearance in shown)
    opening = ", ".join(short(clearance.opening * factor, 4, 1e-6) for clearance in shown)
    more = len(end.clearances) - len(shown)
    return _halving(end, unit), f"{names}, {more} more" if more else names, closing, opening


def _halving(end: PlayEnd, unit: LengthUnit) -> str:
    """Say which gap to close by how much, to first order, for half of the way from the start to an end."""
    best = end.clearances[0]
    if not end.exact or best.closing <= 0.0:
        return "-"
    gap = float(from_metres(0.5 * abs(end.exact) / best.closing, unit))
    alike = [other.point for other in end.clearances if other.closing >= ALIKE * best.closing][:MOST_CLEARANCES]
    return f"close {'/'.join(alike)} by {gap:.3g}"
