"""Which contacts carry, how often and how much."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from cagepose.model.checks import FloatArray
from cagepose.runs.load_scaling import force_unit
from cagepose.sampling.outcome import at_rest
from cagepose.sampling.results import StudyResults
from cagepose.sampling.runner import Runner
from cagepose.sampling.statistics import Statistics

MOST_RUNS = 1_000
"""The forces of at most so many runs are asked for once more, where the rows hold none."""


@dataclass(frozen=True)
class ContactRow:
    """One point or shape of the cage.

    Attributes
    ----------
    name, touches
        In which share of the runs it touches at the end.
    mean_force, greatest_force
        Of the runs in which forces are known and it touches; NaN: none.
    """

    name: str
    touches: float
    mean_force: float
    greatest_force: float


@dataclass(frozen=True)
class ContactTable:
    """All of them; ``unit``, "N" or "load", is that of the forces of the last phase; ``n_runs`` at rest they are of."""

    rows: tuple[ContactRow, ...]
    unit: str
    n_runs: int


def contact_table(results: StudyResults, runner: Runner, statistics: Statistics) -> ContactTable:
    """Return the table; forces come from the rows, or from the first `MOST_RUNS` rows run once more."""
    names = list(results.columns.touching.values())
    sums, counts, greatest = np.zeros(len(names)), np.zeros(len(names)), np.full(len(names), -np.inf)
    n_runs = 0
    for forces in _forces(results, runner):
        known = forces[~np.isnan(forces).any(axis=1)]
        carries = known != 0.0
        n_runs += len(known)
        sums += known.sum(axis=0)
        counts += carries.sum(axis=0)
        greatest = np.maximum(greatest, known.max(axis=0, initial=-np.inf))
    scene = results.study.nominal.scene
    unit = "N" if force_unit(scene, scene.loads[-1]) == "N" else "load"
    rows = [
        ContactRow(
            name,
            statistics.n_touching[f"touching_{name}"] / max(statistics.n_runs, 1),
            float(sums[place] / counts[place]) if counts[place] else np.nan,
            float(greatest[place]) if counts[place] else np.nan,
        )
        for place, name in enumerate(names)
    ]
    return ContactTable(tuple(rows), unit, n_runs)


def _forces(results: StudyResults, runner: Runner) -> Iterator[FloatArray]:
    """Yield forces in parts of the rows that come to rest, (n, n_elements)."""
    names, n_left = tuple(results.columns.forces) or results.columns.varied, MOST_RUNS
    for part in results.parts([*names, "verdict"]):
        values = np.stack([part[name] for name in names], axis=1)[at_rest(part["verdict"])]
        if results.columns.forces:
            yield values
            continue
        forces = runner.run(values[:n_left], with_forces=True).forces
        assert forces is not None, "they were asked for"
        yield forces
        n_left -= len(forces)
        if n_left == 0:
            return
