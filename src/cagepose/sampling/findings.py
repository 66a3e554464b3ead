"""What a study says, all of it: `Findings`, and the same as plain data for JSON."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

import cagepose
from cagepose.files.progress import tell
from cagepose.runs.methods import chosen_method
from cagepose.runs.run import AT_REST, FAILURES
from cagepose.sampling.capture_map import CaptureMap, capture_maps
from cagepose.sampling.chosen_runs import ChosenRun, chosen_runs
from cagepose.sampling.contact_table import ContactTable, contact_table
from cagepose.sampling.distribution import Distribution, distribution_of
from cagepose.sampling.results import StudyResults
from cagepose.sampling.runner import Runner
from cagepose.sampling.sample import Sample
from cagepose.sampling.sensitivity import Sensitivity, sensitivities
from cagepose.sampling.statistics import Statistics, statistics_of
from cagepose.sampling.tolerances import ToleranceRow, tolerance_rows
from cagepose.studies.likelihood import wilson


@dataclass(frozen=True)
class Findings:
    """Everything that the report shows.

    Attributes
    ----------
    results, n_planned, distributions
        The rows, how many there will be, and how each number varies.
    statistics, tolerances, contacts, chosen
        What the rows say, and runs of their own beside them.
    sensitivities, maps
        From designs of their own; none that the study does not ask for.
    """

    results: StudyResults
    n_planned: int
    distributions: tuple[Distribution, ...]
    statistics: Statistics
    tolerances: tuple[ToleranceRow, ...]
    sensitivities: tuple[Sensitivity, ...]
    maps: tuple[CaptureMap, ...]
    contacts: ContactTable
    chosen: tuple[ChosenRun, ...]


def findings_of(results: StudyResults, workers: int | None = None) -> Findings:
    """Return what the rows of a study say, with the runs that this needs beside them; ``workers`` as for `Study.run`.

    Raises
    ------
    StudyFolderError
        The rows cannot be read, or there are none.
    """
    study, columns = results.study, results.columns
    results.require_rows()
    runner = Runner(study, workers)
    distributions = tuple(distribution_of(one) for one in study.varied)
    try:
        tell("cagepose: the report: what the rows say, and tolerances")
        statistics = statistics_of(results)
        tolerances = tuple(tolerance_rows(runner, columns, distributions, statistics.spreads))
        indices, maps = tuple[Sensitivity, ...](), tuple[CaptureMap, ...]()
        if study.model.sensitivities:
            tell("cagepose: the report: which number matters, by runs of its own")
            indices = tuple(sensitivities(runner, columns, distributions, study.model.sample.seed))
        if study.model.map:
            tell("cagepose: the report: the capture map, by runs of its own")
            maps = capture_maps(runner, columns, distributions, study.model.map)
        tell("cagepose: the report: contacts, typical and worst runs")
        return Findings(
            results,
            Sample(study.model.sample, distributions).n_runs,
            distributions,
            statistics,
            tolerances,
            indices,
            maps,
            contact_table(results, runner, statistics),
            tuple(chosen_runs(results, statistics)),
        )
    finally:
        tell("")
        runner.close()


def document(findings: Findings) -> dict[str, Any]:
    """Return the findings as plain data: dict, list, str, int, finite float, bool and None."""
    results, statistics = findings.results, findings.statistics
    study = results.study
    document: dict[str, Any] = {
        "version": cagepose.__version__,
        "scene": study.nominal.scene.name,
        "method": chosen_method(study.nominal.scene).name,
        "units": {"length": study.nominal.length_unit, "force": findings.contacts.unit},
        "runs": statistics.n_runs,
        "accept": study.model.accept,
        "yield": _share(statistics.n_accepted, statistics.n_runs),
        "good_but_not_at_rest": statistics.n_accepted_moving,
        "at_rest": {name: n for name, n in statistics.verdicts.most_common() if name in AT_REST},
        "failed": {name: n for name, n in statistics.verdicts.most_common() if name in FAILURES},
        "verdicts": {name: _share(n, statistics.n_runs) for name, n in statistics.verdicts.most_common()},
        "varied": [
            {"key": one.key, "nominal": one.nominal, "low": spread.low, "high": spread.high, "sigma": spread.sigma}
            for one, spread in zip(study.varied, findings.distributions, strict=True)
        ],
        "tolerances": [_tolerance(row, results) for row in findings.tolerances],
        "sensitivities": [_sensitivity(found, results) for found in findings.sensitivities],
        "contacts": {
            "forces_of_runs": findings.contacts.n_runs,
            "rows": [asdict(row) for row in findings.contacts.rows],
        },
        "maps": [_map(found) for found in findings.maps],
        "chosen_runs": [
            {**asdict(run), "values": dict(zip(results.columns.varied, run.values.tolist(), strict=True))}
            for run in findings.chosen
        ],
    }
    plain: dict[str, Any] = _without_nan(document)
    return plain


def _share(n: int, n_runs: int) -> dict[str, Any]:
    low, high = wilson(n, n_runs)
    return {"runs": n, "share": n / max(n_runs, 1), "low": low, "high": high}


def _tolerance(row: ToleranceRow, results: StudyResults) -> dict[str, Any]:
    spread = row.spread
    return {
        "name": row.name,
        "nominal": row.nominal,
        "worst_case": list(row.worst),
        "root_sum_square": list(row.root_sum_square),
        "monte_carlo": {
            "mean": spread.mean,
            "sigma": spread.sigma,
            "three_sigma": list(spread.three_sigma),
            "range": [spread.least, spread.greatest],
            "runs": spread.n,
        },
        "resolution": row.resolution,
        "stays_within_worst_case": row.stays_within_worst,
        "derivatives": dict(zip(results.columns.varied, row.derivatives.tolist(), strict=True)),
    }


def _sensitivity(found: Sensitivity, results: StudyResults) -> dict[str, Any]:
    numbers = (found.first, found.first_interval, found.total, found.total_interval)
    keys = ("key", "first", "first_interval", "total", "total_interval")
    varied = results.columns.varied if found.missing is None else ()
    rows = zip(varied, *(array.tolist() for array in numbers), strict=True)
    return {
        "name": found.name,
        "runs": found.n_runs,
        "missing": found.missing,
        "indices": [dict(zip(keys, row, strict=True)) for row in rows],
    }


def _map(found: CaptureMap) -> dict[str, Any]:
    """A million cells are a few megabytes as numbers: which of the verdicts, and whether accepted, rows up."""
    names, codes = np.unique(found.verdicts, return_inverse=True)
    return {
        "over": list(found.keys),
        "layer": None if found.layer is None else dict([found.layer]),
        "runs": found.n_runs,
        "across": found.across.tolist(),
        "up": found.up.tolist(),
        "verdicts": names.tolist(),
        "verdict_cells": codes.reshape(found.verdicts.shape).tolist(),
        "accepted_cells": found.accepted.astype(np.int64).tolist(),
        "ends_at": found.lattice.tolist(),
        "ends": {name: values.tolist() for name, values in found.quantities.items()},
        "box": None if found.box is None else [list(side) for side in found.box],
    }


def _without_nan(value: Any) -> Any:
    """JSON has no NaN and no infinite numbers: null stands for them."""
    if isinstance(value, dict):
        return {key: _without_nan(one) for key, one in value.items()}
    if isinstance(value, list):
        return [_without_nan(one) for one in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
