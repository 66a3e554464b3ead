"""``cagepose design``: find the loosest value of one number that keeps a wish."""

from __future__ import annotations

import os
import sys
import time
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from cagepose.cli.options import FILE, FileName, Switch, refusal

if TYPE_CHECKING:
    from cagepose.sampling.design_results import DesignResults
    from cagepose.sampling.trade_off import TradeOffPoint


def design_command(
    file: Annotated[FileName, Parameter(help="Design file (YAML or JSON).")],
    /,
    *,
    out: Annotated[
        FileName | None, FILE, Parameter(help="Folder for numbers, curve and scene; created if it does not exist.")
    ] = None,
    workers: Annotated[
        int | None, Parameter(help="How many threads or processes to use; left out: one for each core.")
    ] = None,
    json: Annotated[bool, Switch, Parameter(help="Print what was found as JSON instead of a table.")] = False,
) -> int:
    """Print what each value that was tried gives, and the loosest one that meets the target."""
    if workers is not None and workers < 1:
        sys.stderr.write(f"cagepose: --workers is {workers}; give 1 or more. See: cagepose design --help\n")
        return 2
    from cagepose.errors import printable
    from cagepose.files.write import json_text
    from cagepose.model.wording import duration, number_of
    from cagepose.sampling.design import Design

    began = time.perf_counter()
    results = Design.load(file).run(workers=workers or os.cpu_count() or 1, progress=_tell)
    n_values, seconds = len(results.trade_off.points), time.perf_counter() - began
    told = f"cagepose: {number_of(n_values, 'value')}, {number_of(results.n_runs, 'run')} in {duration(seconds)}"
    sys.stderr.write(f"\r{told:60}\n" if sys.stderr.isatty() else f"{told}\n")
    if json:
        sys.stdout.write(json_text(results.document()))
    else:
        _print(results)
    if out is None:
        return 0
    try:
        written = results.write(out)
    except OSError as error:
        sys.stderr.write(refusal(f"--out {out}", error) + "\n")
        return 2
    if not json:
        sys.stdout.write(printable(f"wrote {', '.join(written)}") + "\n")
    return 0


def _tell(point: TradeOffPoint) -> None:
    if sys.stderr.isatty():
        text = f"cagepose: at {point.value:.5g}: {point.reached:.5g}"
        sys.stderr.write(f"\r{text:60}")
        sys.stderr.flush()


def _print(results: DesignResults) -> None:
    from cagepose.cli.console import print_all
    from cagepose.cli.styles import plain_table

    study, wish = results.file.study, results.file.model.wish
    has_interval = wish.share is not None
    columns = ("yield", "95 % interval") if has_interval else ("capture range",)
    table = plain_table(study.varied[-1].key, *columns, "meets the target")
    for point in results.trade_off.points:
        low, high = (results.reached_text(limit) for limit in (point.low, point.high))
        limits = (f"{low} to {high}",) if has_interval else ()
        kept = "yes" if point.reached >= wish.at_least else "no"
        table.add_row(f"{point.value:.5g}", results.reached_text(point.reached), *limits, kept)
    print_all(f"{study.nominal.scene.name}: {results.wish_text()}", "", table, "", results.sentence())
