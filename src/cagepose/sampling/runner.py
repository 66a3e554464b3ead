"""From rows of varied numbers to where the runs ended: `Runner`."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor
from copy import deepcopy
from dataclasses import fields
from itertools import repeat
from multiprocessing import get_context
from typing import Any

import numpy as np

from cagepose.errors import SceneError
from cagepose.files.key_path import set_value, value_at
from cagepose.files.parameters import Expressions, evaluated
from cagepose.files.study_file import StudyFile
from cagepose.model.checks import FloatArray, expect_count
from cagepose.model.scene import Scene
from cagepose.runs.end_forces import end_forces
from cagepose.runs.many import run_many, runs_of_rows
from cagepose.runs.scene_rows import SceneRows
from cagepose.runs.solve import run
from cagepose.sampling.asked import AskedColumns
from cagepose.sampling.batch_columns import BatchColumns, Columns
from cagepose.sampling.measured import MeasuredColumns
from cagepose.sampling.outcome import Outcomes, empty_outcomes, outcomes_of

ROWS_OF_A_BATCH = 16_384
"""Rows that are in memory at once, and those of one part of the table: a power of two, as Sobol sequences like it."""
ROWS_ONE_BY_ONE = 1_024
"""The same where scenes are built row by row: about a second of work."""
FEW_ROWS, ROWS_OF_A_TASK = 64, 16
"""So few are not worth a process of their own; and what one process does before it says so."""

Told = Callable[[int], None]
"""Called with how many rows are done, while others are not."""
Part = tuple[int, int]
"""A part of the rows: the first, and the one behind the last."""
RunPart = tuple[Part, FloatArray, Outcomes]
"""With its varied numbers, and where its runs ended."""


class Runner:
    """Runs rows of one study: all at once in the batch kernel if that can vary the numbers, else scene by scene.

    A row's outcome is that of `cagepose.run` of its scene, to the last bit, either way.

    Parameters
    ----------
    study
        Of it.
    workers
        How many threads of the batch kernel, or processes that build scenes; None: a thread for each core, one process.

    Attributes
    ----------
    is_batch
        Whether the batch kernel can vary all numbers, nothing is asked of each run, and nothing is measured from bodies
        of the cage, which move.
    rows_of_a_part
        How many rows are run at once.

    Raises
    ------
    SceneError
        ``workers`` is no whole number from 1 upwards.
    """

    def __init__(self, study: StudyFile, workers: int | None = None) -> None:
        if workers is not None:
            expect_count(workers, "workers")
        self.study, self._workers = study, workers
        formulas = (study.model.accept or "", *(study.model.compute or {}).values())
        self._is_judged_by_forces = bool(study.model.forces) and any("force" in formula for formula in formulas)
        nominal: Any = deepcopy(study.scene_text.yaml.data)
        for one in study.varied:
            set_value(nominal, one.path, one.nominal)
        self._expressions = Expressions(nominal)
        self._nominal, _ = evaluated(nominal)
        self._batch = BatchColumns(self._nominal, study.nominal.length_unit)
        probe = self._columns(np.array([[one.nominal for one in study.varied]]))
        self._asked = AskedColumns(study.model.ask or (), study.nominal.scene, study.nominal.length_unit)
        self._measured = MeasuredColumns(study.model.watch or {}, study.nominal.length_unit)
        measures_batch = self._measured.takes(study.nominal.scene)
        self.is_batch = not len(self._asked) and measures_batch and all(map(self._batch.takes, probe))
        self.rows_of_a_part = ROWS_OF_A_BATCH if self.is_batch else ROWS_ONE_BY_ONE
        self._pool: ProcessPoolExecutor | None = None

    def close(self) -> None:
        """End the processes that were started."""
        if self._pool is not None:
            self._pool.shutdown(wait=False, cancel_futures=True)
            self._pool = None

    def run(self, values: FloatArray, *, with_forces: bool = False, told: Told | None = None) -> Outcomes:
        """Run rows of varied numbers, (n, n_varied), in the scene file's unit.

        With forces, too, if a formula may ask for them. ``told``: hears of rows whose scenes are built one by one.

        Raises
        ------
        KeyboardInterrupt
            Ctrl-C was pressed; nothing goes on.
        """
        has_forces = with_forces or self._is_judged_by_forces
        if self.is_batch:
            return self._run_batch(values, has_forces)
        if (self._workers or 1) == 1 or len(values) <= FEW_ROWS:
            return self._run_one_by_one(values, has_forces, told)
        tasks = [values[first : first + ROWS_OF_A_TASK] for first in range(0, len(values), ROWS_OF_A_TASK)]
        found = list[Outcomes]()
        for outcomes in self._processes().map(_run_task, tasks, repeat(has_forces)):
            found.append(outcomes)
            if told is not None and len(found) < len(tasks):
                told(len(found) * ROWS_OF_A_TASK)
        return _joined(found)

    def run_in_parts(self, values: FloatArray, told: Callable[[Outcomes, FloatArray], None]) -> None:
        """Run rows as `run` does, so many at a time that memory does not grow with them."""
        for first in range(0, len(values), self.rows_of_a_part):
            rows = values[first : first + self.rows_of_a_part]
            told(self.run(rows), rows)

    def run_nominal(self) -> Outcomes:
        """Build and run the nominal scene."""
        values = np.array([[one.nominal for one in self.study.varied]])
        return self._run_one_by_one(values, bool(self.study.model.forces))

    def _run_one_by_one(self, values: FloatArray, has_forces: bool, told: Told | None = None) -> Outcomes:
        """Build and run the scene of each row; with forces, questions or measures, read all of each run."""
        n_answers, n_measured = len(self._asked), len(self._measured)
        reads_all = has_forces or n_answers > 0 or n_measured > 0
        nominal, refused = self.study.nominal.scene, dict[int, str]()
        outcomes = empty_outcomes(
            nominal, len(values), with_forces=has_forces, n_answers=n_answers, n_measured=n_measured
        )
        rows = SceneRows(nominal, len(values))
        for row in range(len(values)):
            try:
                if reads_all:
                    ended = run(self._scene(values[row]))
                    outcomes.write_run(row, ended)
                    self._measured.write_run(outcomes, row, ended)
                    if outcomes.answers is not None and not ended.failed:
                        outcomes.answers[row] = self._asked.answers(ended)
                else:
                    rows.run(row, self._scene(values[row]))
            except SceneError as error:
                refused[row] = str(error)
            if told is not None and row + 1 < len(values):
                told(row + 1)
        if not reads_all:
            outcomes = outcomes_of(runs_of_rows(nominal, rows))
            outcomes.solve_us = rows.solve_s * 1e6
            for row in np.flatnonzero(outcomes.phase_verdicts[:, 0] == "invalid").tolist():
                outcomes.write_run(row, run(self._scene(values[row])))
        for row, message in refused.items():
            outcomes.write_refusal(row, message)
        return outcomes

    def _write_one_by_one(self, values: FloatArray, rows: Iterable[int], outcomes: Outcomes) -> None:
        for row in rows:
            try:
                ended = run(self._scene(values[row]))
                outcomes.write_run(row, ended)
                self._measured.write_run(outcomes, row, ended)
            except SceneError as error:
                outcomes.write_refusal(row, str(error))

    def _scene(self, numbers: FloatArray) -> Scene:
        """Return the scene of a row of varied numbers, (n_varied,)."""
        paths = [one.path for one in self.study.varied]
        return self.study.scene_text.scene_with(dict(zip(paths, numbers.tolist(), strict=True))).scene

    def _run_batch(self, values: FloatArray, has_forces: bool) -> Outcomes:
        columns = self._columns(values)
        usable = self._batch.usable(columns)
        if not usable.any():
            return self._run_one_by_one(values, has_forces)
        if not usable.all():  # the nominal scene in their place, until they are written below
            columns = {path: np.where(usable, column, self._nominal_at(path)) for path, column in columns.items()}
        scene, variation = self.study.nominal.scene, self._batch.variation(columns)
        runs = run_many(scene, variation, threads=self._workers)
        outcomes = outcomes_of(runs, n_measured=len(self._measured))
        is_told = usable & (outcomes.phase_verdicts[:, 0] != "invalid")
        self._measured.write_rows(outcomes, np.flatnonzero(is_told).tolist(), scene, variation)
        if has_forces:
            outcomes.forces = end_forces(scene, variation, np.flatnonzero(is_told).tolist())
        if not is_told.all():
            outcomes.clear(~is_told)
            self._write_one_by_one(values, np.flatnonzero(~is_told).tolist(), outcomes)
        return outcomes

    def _nominal_at(self, path: Any) -> float:
        return float(value_at(self._nominal, path))

    def _columns(self, values: FloatArray) -> Columns:
        """Return all numbers of the scene file that vary, and those whose expressions do."""
        varied = {one.path: values[:, column] for column, one in enumerate(self.study.varied)}
        parameters = {str(path[1]): column for path, column in varied.items() if path[0] == "parameters"}
        of_expressions = self._expressions.values(parameters)
        return {**varied, **{path: found for path, found in of_expressions.items() if isinstance(found, np.ndarray)}}

    def _processes(self) -> ProcessPoolExecutor:
        if self._pool is None:
            self._pool = ProcessPoolExecutor(
                self._workers,
                mp_context=get_context("spawn"),  # a fork of a process with threads can hang
                initializer=_begin_process,
                initargs=(self.study,),
            )
        return self._pool


_RUNNERS: list[Runner] = []
"""The one runner of a process that builds scenes."""


def _begin_process(study: StudyFile) -> None:
    import signal

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is heard by the process that started this one
    _RUNNERS[:] = [Runner(study)]


def _run_task(values: FloatArray, has_forces: bool) -> Outcomes:
    return _RUNNERS[0].run(values, with_forces=has_forces)


def _joined(parts: list[Outcomes]) -> Outcomes:
    """One below the other."""
    columns: Any = (tuple(getattr(part, field.name) for part in parts) for field in fields(Outcomes))
    joined: Any = (None if column[0] is None else np.concatenate(column) for column in columns)
    return Outcomes(*joined)
