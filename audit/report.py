"""Tables of counts, the list of failures, and each failing scene as a file."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table
from ruamel.yaml import YAML

from audit.case import Failure
from audit.draws import FRICTIONS
from audit.families import FAMILIES, make_case
from audit.oracles import CRASH, ENDING, NOT_SHOWN, ORACLES, TIME, Finding
from audit.scene_yaml import scene_yaml

KNOWN = Path(__file__).parent / "known.yaml"
MOST_LISTED = 20
"""Failures of one oracle that are printed; all of them are in the file of failures."""
VERDICTS = ("rests", "may rest", NOT_SHOWN, "escapes", "stalled", "limit")
FAILED = ("stalled", "limit", "")
"""Verdicts of runs without an answer; the last one is that of an exception."""
OTHER = "other"


@dataclass(frozen=True)
class Known:
    """A failure that is known, or with the index None all of a family's with one oracle, and why it is there."""

    family: str
    index: int | None
    oracle: str
    reason: str


KnownFailures = dict[tuple[str, int | None, str], Known]
"""By family, index and oracle."""


def read_known(path: Path = KNOWN) -> KnownFailures:
    """Return the known failures of a file."""
    entries = YAML(typ="safe").load(path.read_text(encoding="utf-8"))["known"]
    found = [Known(**entry) for entry in entries]
    return {(entry.family, entry.index, entry.oracle): entry for entry in found}


def show_endings(console: Console, findings: Sequence[Finding]) -> None:
    """How runs end, by family; and beside it, by friction, those without an answer."""
    table = Table(title="How runs end; and, by friction, not shown + failed of runs", title_justify="left")
    table.add_column("family")
    for heading in ("runs", *VERDICTS, *(f"mu {mu:g}" for mu in FRICTIONS), OTHER):
        table.add_column(heading, justify="right")
    for family in (*FAMILIES, "all"):
        mine = [finding for finding in findings if family in (finding.family, "all")]
        verdicts = Counter(finding.verdict for finding in mine)
        cells = [str(len(mine)), *(str(verdicts[verdict] or "") for verdict in VERDICTS)]
        for mu in (*FRICTIONS, None):
            of_mu = [f for f in mine if f.friction == mu or (mu is None and f.friction not in FRICTIONS)]
            open_ones = sum(f.verdict == NOT_SHOWN for f in of_mu)
            failed = sum(f.verdict in FAILED for f in of_mu)
            cells.append(f"{open_ones} + {failed} / {len(of_mu)}" if of_mu else "")
        table.add_row(family, *cells, end_section=family == FAMILIES[-1])
    console.print(table)


def show_oracles(console: Console, findings: Sequence[Finding]) -> None:
    """Cases that fail, by family and oracle: a point where all pass, nothing where none could be asked."""
    names = (ENDING, TIME, CRASH, *ORACLES)
    table = Table(title="Cases that fail, by oracle (a point: none of those asked)", title_justify="left")
    table.add_column("family")
    for name in names:
        table.add_column(name, justify="right")
    asked = Counter((f.family, name) for f in findings for name in f.asked)
    failed = Counter(key for f in findings for key in {(f.family, failure.oracle) for failure in f.failures})
    for family in FAMILIES:
        cells = [str(failed[family, name] or ".") if asked[family, name] else "" for name in names]
        table.add_row(family, *cells, end_section=family == FAMILIES[-1])
    for title, counts in (("fail", failed), ("asked", asked)):
        table.add_row(title, *(str(sum(counts[family, name] for family in FAMILIES)) for name in names))
    console.print(table)


def show_times(console: Console, findings: Sequence[Finding]) -> None:
    times = np.array([finding.solve_s for finding in findings])
    times = times[np.isfinite(times)]
    if len(times):
        median, most = np.quantile(times, [0.5, 0.999]) * 1e3
        slowest = sorted(findings, key=lambda finding: -np.nan_to_num(finding.solve_s))[:5]
        named = ", ".join(f"{finding.family}:{finding.index} {finding.solve_s:.3g} s" for finding in slowest)
        console.print(f"Time of a run: median {median:.3g} ms, 99.9th percentile {most:.3g} ms; slowest: {named}")


def show_failures(console: Console, failures: Sequence[Failure], folder: Path, seed: int, known: KnownFailures) -> bool:
    """List the failures, write their scenes, and return whether there is one that is not known."""
    is_known = {failure: _known_as(failure, known) is not None for failure in failures}
    lines = []
    for failure in failures:
        entry = _known_as(failure, known)
        reason = f" (known: {entry.reason})" if entry else ""
        lines.append(f"{failure.oracle:9} {failure.family}:{failure.index}  {failure.text}{reason}")
    if failures:
        _write_scenes(failures, folder, seed)
        (folder / "failures.txt").write_text("\n".join(lines) + "\n", encoding="utf-8")
    listed = Counter[str]()
    for failure, line in zip(failures, lines, strict=True):
        listed[failure.oracle] += 1
        if listed[failure.oracle] <= MOST_LISTED:
            console.print(line, markup=False, highlight=False, soft_wrap=True)
    for oracle, count in listed.items():
        if count > MOST_LISTED:
            console.print(f"{oracle:9} ... and {count - MOST_LISTED} more")
    if failures:
        console.print(
            f"All failures: {folder / 'failures.txt'}; their scenes: {folder}/FAMILY-INDEX.yaml", soft_wrap=True
        )
        console.print("Ask one of them again: python -m audit --case FAMILY:INDEX", soft_wrap=True)
    return not all(is_known.values())


def _known_as(failure: Failure, known: KnownFailures) -> Known | None:
    one = known.get((failure.family, failure.index, failure.oracle))
    return one or known.get((failure.family, None, failure.oracle))


def show_mended(console: Console, findings: Sequence[Finding], known: KnownFailures) -> None:
    """Name known failures that were asked about and fail no longer."""
    asked = {(finding.family, finding.index, name) for finding in findings for name in finding.asked}
    failed = {(failure.family, failure.index, failure.oracle) for finding in findings for failure in finding.failures}
    for family, index, oracle in sorted(key for key in asked - failed if key in known):
        console.print(f"{oracle} {family}:{index} fails no longer: remove it from {KNOWN.name}")


def _write_scenes(failures: Sequence[Failure], folder: Path, seed: int) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    remarks: dict[tuple[str, int], list[str]] = {}
    for failure in failures:
        remarks.setdefault((failure.family, failure.index), []).append(f"{failure.oracle}: {failure.text}")
    for (family, index), texts in remarks.items():
        case = make_case(family, index, seed)
        again = f"python -m audit --case {family}:{index}" + (f" --seed {seed}" if seed else "")
        expected = [f"By hand: {case.ending}"] if case.ending else []
        text = scene_yaml(case.scene, f"{family} {index}", [f"Ask again: {again}", *expected, *texts])
        (folder / f"{family}-{index}.yaml").write_text(text, encoding="utf-8")
