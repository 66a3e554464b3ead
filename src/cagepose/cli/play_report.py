"""A `Play` as text: a table of ranges, what limits them, the verdict on the cage."""

from __future__ import annotations

import math
from collections.abc import Sequence

from rich.table import Table
from rich.text import Text

from cagepose.cli.console import fits, print_all, screen_width
from cagepose.cli.styles import plain_table
from cagepose.cli.tolerances import END_AT_START
from cagepose.files.play_document import LENGTHS
from cagepose.files.units import LengthUnit, from_metres
from cagepose.files.words import LengthWords, line_of
from cagepose.model.wording import duration, short
from cagepose.studies.cage_verdict import CageVerdict, PathStep
from cagepose.studies.play_rest import PlayRest
from cagepose.studies.play_result import Play, PlayEnd

DIGITS_OF_RANGES = (6, 5, 4)
"""Digits of ranges: as many as fit the screen."""
MOST_CLEARANCES = 4
"""So many of the clearances that limit an end are printed; the document has all."""
WORTH_OF_BEST = 0.99
"""Clearances worth this part of the best one are as good to close; slopes say no more of a whole gap."""
MEANING = (
    "exact: no nearby motion goes farther (*: no motion at all, to within 1 %); at least, at most: the search ended"
    " there; certified within: proven bounds of all motions inside the cage"
)
MEANING_WITHOUT_PROOF = (
    "exact: no nearby motion goes farther; at least, at most: the search ended there; unlimited: nothing stops it"
)
SEATED = (
    "how far a small push moves it each way, without friction; the push is 1/10000 of the load, which goes on acting"
)
COLUMNS_OF_LIMITS = ("end", "limited by", "sensitivity to less gap", "sensitivity to more gap", "to halve it")
SENSITIVITY = (
    "sensitivity: by how much the play falls, or grows, for each {} by which one of these gaps is made smaller, or"
    " larger"
)
HALVED = "; to halve it: by how much to make one of these gaps smaller, to first order"
MOST_MOTIONS = 6
"""So many motions of a way out are printed; the document has all."""
STYLES = {"caged": "bold green", "not certified": "bold yellow", "escapes": "bold red"}


def print_play(play: Play, rests: Sequence[PlayRest], unit: LengthUnit) -> None:
    """Print to standard output, lengths in ``unit``, angles in degrees."""
    rows = [(name, name in LENGTHS, ends.low, ends.high) for name, ends in play.freedoms.items()]
    rows += [(_point_name(place, play), True, point.low, point.high) for place, point in enumerate(play.points)]
    width, words = screen_width(), LengthWords(unit, play.scene.size_m)
    tables = [_ranges(rows, words, digits) for digits in DIGITS_OF_RANGES]
    table = next((table for table in tables if fits(table, width)), tables[-1])
    limits = [
        (f"{sign} {name}" if number == 0 else "", ", ".join(points), *worth)
        for name, is_length, low, high in rows
        for sign, end in (("least", low), ("greatest", high))
        for number, (worth, points) in enumerate(_limits(end, is_length, unit).items())
    ]
    can_halve = any(limit[-1] for limit in limits)
    columns = COLUMNS_OF_LIMITS if can_halve else COLUMNS_OF_LIMITS[:-1]
    why = plain_table(*columns)
    for limit in limits:
        why.add_row(*map(Text, limit[: len(columns)]))
    held = f"; held: {' '.join(play.held)}" if play.held else ""
    if play.cage is None:
        print_all(
            Text(f"{play.scene.name}: play from the rest of {play.seated}, in the cage's frame{held}"), "", Text(SEATED)
        )
    else:
        print_all(Text(f"{play.scene.name}: play from the start pose, in the cage's frame{held}"), "")
        _print_cage(play.cage, words)
    is_proven = any(end.certified is not None for _, _, low, high in rows for end in (low, high))
    print_all("", table, "", *_legend(play, words), Text(MEANING if is_proven else MEANING_WITHOUT_PROOF), "")
    if why.row_count:
        print_all(why, "", Text(SENSITIVITY.format(unit) + (HALVED if can_halve else "")), "")
    for rest in rests:
        print_all(_rest(rest, words))
    asked = {rest.phase for rest in rests}
    for load in play.scene.loads if rests else ():
        if load.name not in asked:
            print_all(
                Text(f"{load.name} has more than a weight and one force: cagepose run says where it comes to rest")
            )
    proven = f", certificate {duration(play.certificate_s)}" if play.certificate_s else ""
    print_all(Text(f"analysis {duration(play.analysis_s)}{proven}"))


def _print_cage(cage: CageVerdict, words: LengthWords) -> None:
    verdict = Text("cage: ")
    verdict.append(cage.verdict, style=STYLES[cage.verdict])
    print_all(verdict.append(f" ({cage.reason})"))
    if cage.verdict == "escapes":
        print_all(Text("it can leave the cage: the limits below hold near the start only"))
    if cage.free_directions:
        print_all(Text(f"free directions: {' '.join(cage.free_directions)}"))
    if cage.leaves_at is not None:
        print_all(
            Text(f"it loses its last contact with the object's origin at ({words.lengths(cage.leaves_at.position_m)})")
        )
    if cage.path is not None:
        print_all(Text(f"escape path: {_way_out(cage.path, words)}"))


def _ranges(rows: Sequence[tuple[str, bool, PlayEnd, PlayEnd]], words: LengthWords, digits: int) -> Table:
    """Return the table of ranges: names, whether they are lengths, and both ends."""
    ends = [end for _, _, low, high in rows for end in (low, high)]
    has_linear = any(end.linear is not None for end in ends) or all(end.is_open for end in ends)
    has_certified = any(end.certified is not None for end in ends)
    kinds = ["linear"] * has_linear + ["exact"] + ["certified within"] * has_certified
    table = plain_table("", "unit", *kinds)
    for name, is_length, low, high in rows:

        def written(value: float | None, is_length: bool = is_length) -> str:
            return _value(value, is_length, words, digits)

        is_certified = low.certified is not None and high.certified is not None
        ranges = {
            "linear": f"{written(low.linear)} to {written(high.linear)}",
            "exact": f"{_exact(low, 'at most', is_length, words, digits)} to"
            f" {_exact(high, 'at least', is_length, words, digits)}",
            "certified within": f"{written(low.certified)} to {written(high.certified)}" if is_certified else "-",
        }
        cells = (name, str(words.unit) if is_length else "deg", *(ranges[kind] for kind in kinds))
        table.add_row(*(Text(cell) for cell in cells))
    return table


def _legend(play: Play, words: LengthWords) -> list[Text]:
    """Say which points are meant."""
    places = {_place_of(place, play): point.at_object for place, point in enumerate(play.points)}
    return [Text(f"{name}: ({words.lengths(at)}) {words.unit} in the object's frame") for name, at in places.items()]


def _rest(rest: PlayRest, words: LengthWords) -> Text:
    """One line: where the load leaves the object, by which points, and what it leaves open."""
    line = Text(f"{rest.phase} ")
    pose, forces = rest.pose_world_object, rest.exact_forces
    if pose is not None:
        line.append("presses the object ")
    else:
        pose, forces = rest.linear_pose_world_object, rest.forces
        if pose is None:
            return line.append("presses the object out: nothing stops it")
        line.append("finds no rest nearby", style="yellow").append("; to first order it would press the object ")
    angles = ", ".join(short(math.degrees(angle), 4, 1e-9) for angle in pose.euler_zyx)
    line.append(f"to ({words.lengths(pose.position_m)}), yaw, pitch, roll ({angles}) deg, without friction;")
    amounts = ", ".join(f"{force.point} {force.force_n:.4g}" for force in forces)
    line.append(f" forces{' [N]' if rest.in_newtons else ''}: {amounts}")
    if rest.undetermined:
        line.append(f"; to first order free to move in {' '.join(freedom.name for freedom in rest.undetermined)}")
    return line


def _place_of(place: int, play: Play) -> str:
    """Number the points of the object, of which each is asked about along several directions."""
    different = list(dict.fromkeys(tuple(point.at_object.tolist()) for point in play.points))
    return f"point {different.index(tuple(play.points[place].at_object.tolist())) + 1}"


def _point_name(place: int, play: Play) -> str:
    direction = play.points[place].direction_cage
    axes = [axis for axis, part in zip("xyz", direction.tolist(), strict=True) if part == 1.0]
    along = axes[0] if axes else f"({', '.join(short(value, 4, 1e-12) for value in direction.tolist())})"
    return f"{_place_of(place, play)} along {along}"


def _value(value: float | None, is_length: bool, words: LengthWords, digits: int) -> str:
    if value is None:
        return "unlimited"
    if is_length:
        return short(float(from_metres(value, words.unit)), digits, words.noise)
    return short(math.degrees(value), digits, 1e-10)


def _exact(end: PlayEnd, bound: str, is_length: bool, words: LengthWords, digits: int) -> str:
    """Return an end; of one that was not found how far the search came, as a ``bound``."""
    value = _value(end.reached, is_length, words, digits)
    return f"{bound} {value}" if end.status == "not converged" else f"{value}*" if end.status == "proven" else value


def _limits(end: PlayEnd, is_length: bool, unit: LengthUnit) -> dict[tuple[str, str, str], list[str]]:
    """Return the points whose gaps limit an end, by what these are worth and how much of one to close to halve it."""
    factor = 1.0 if is_length else math.degrees(1.0) / float(from_metres(1.0, unit))
    by_m, alike = _halving(end)
    by = f"{float(from_metres(by_m, unit)):.3g} {unit}"
    takes_several = "several gaps" if by_m > 0.0 and not alike else ""
    found: dict[tuple[str, str, str], list[str]] = {}
    for clearance in end.clearances[:MOST_CLEARANCES]:
        closing, opening = f"{clearance.closing * factor:.4g}", short(clearance.opening * factor, 4, 1e-6)
        halved = by if clearance.point in alike else takes_several
        found.setdefault((closing, opening, halved), []).append(clearance.point)
    if len(end.clearances) > MOST_CLEARANCES:
        found[next(reversed(found))].append(f"{len(end.clearances) - MOST_CLEARANCES} more")
    return found


def _halving(end: PlayEnd) -> tuple[float, list[str]]:
    """Return by how much to close one gap, to first order, for half of the way from the start to an end, and the points
    of which each alone does it; none: no gap is so wide. Zero: there is nothing to halve.
    """
    usable = [gap for gap in end.clearances if 0.0 < gap.closing < math.inf and gap.gap_m is not None]
    if end.exact is None or abs(end.exact) < END_AT_START or not usable:
        return 0.0, []
    best = max(clearance.closing for clearance in usable)
    by_m = 0.5 * abs(end.exact) / best
    return by_m, [
        gap.point
        for gap in usable
        if gap.closing >= WORTH_OF_BEST * best and (gap.gap_m or 0.0) >= WORTH_OF_BEST * by_m
    ]


def _way_out(path: Sequence[PathStep], words: LengthWords) -> str:
    """``turn about (0, 0, 1) by 90 deg, travel along (1, 0, 0) by 5 mm; then no contact is ahead``."""
    if not path:
        return "no contact is ahead from the start"
    motions = [step.motion for step in path[:MOST_MOTIONS]]
    ways = {"travel": "along", "turn": "about", "screw": "about"}
    told = [f"{motion.kind} {ways[motion.kind]} {line_of(motion)} by {words.amount(motion, 4)}" for motion in motions]
    more = [f"{len(path) - len(motions)} more"] if len(path) > len(motions) else []
    return f"{', '.join(told + more)}; then no contact is ahead"
