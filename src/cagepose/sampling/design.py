"""The friendly class: `Design`, the loosest value of one number that keeps a wish."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from cagepose.files.design_file import DesignFile, parse_design, read_design_file
from cagepose.files.study_file import refused_at, study_text
from cagepose.model.checks import FloatArray
from cagepose.sampling.design_results import DesignResults
from cagepose.sampling.study import scene_name
from cagepose.sampling.trade_off import TradeOffPoint, captured_range, trade_off
from cagepose.studies.likelihood import wilson
from cagepose.views.extra import require_study

if TYPE_CHECKING:
    from cagepose.sampling.runner import Runner

Progress = Callable[[TradeOffPoint], None]
"""Called with each value that was asked."""


class Design:
    """The loosest value of one number that keeps a wish, with what a design file holds as arguments; see the page on
    studies.

    Parameters
    ----------
    scene
        The scene's file.
    change
        The number that is to be chosen, by its key, and its tight and its loose end: ``{"parameters.play": [0.1, 2]}``.
    wish
        ``{"yield": 0.997}``, or ``{"capture": {"parameters.pitch": 0.5}}``.
    vary, sample, watch, ask, compute, accept
        As of a `Study`; a capture range needs no sample.

    Raises
    ------
    SceneError
        No such scene, or what is asked for cannot be; lists every problem found.
    MissingExtraError
        The extra ``study`` is not installed.
    """

    def __init__(
        self,
        scene: str | os.PathLike[str],
        change: Mapping[str, Any],
        wish: Mapping[str, Any],
        vary: Mapping[str, Any],
        sample: Mapping[str, Any] | None = None,
        *,
        watch: Mapping[str, Any] | None = None,
        ask: Sequence[str] | None = None,
        compute: Mapping[str, str] | None = None,
        accept: str | None = None,
    ) -> None:
        content: dict[str, Any] = {"scene": scene_name(scene), "change": change, "wish": wish, "vary": vary}
        content |= {"sample": sample, "watch": watch, "ask": ask, "compute": compute, "accept": accept}
        self._begin(parse_design(study_text(content), "design"), "design")

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Design:
        """Read a design file.

        Raises
        ------
        SceneFileError
            It cannot be used; lists every problem with its line and column.
        """
        design = cls.__new__(cls)
        design._begin(read_design_file(path), os.fspath(path))
        return design

    def _begin(self, file: DesignFile, source: str) -> None:
        require_study()
        from cagepose.sampling.at_the_door import checked_columns, checked_sample
        from cagepose.sampling.distribution import distribution_of

        self._file, varied = file, file.study.varied[:-1]
        self._columns = checked_columns(file.study, source)
        self._sample = checked_sample(file.study, source, varied)
        for key, width in (file.model.wish.capture or {}).items():
            self._captured = [one.key for one in varied].index(key)
            nominal, spread = varied[self._captured].nominal, distribution_of(varied[self._captured])
            self._low, self._high = spread.low, spread.high
            if not spread.low <= nominal <= spread.high:
                message = f"varies from {spread.low:g} to {spread.high:g}, without its nominal value {nominal:g}"
                raise refused_at(("wish", "capture", key), file.study, source, f"{message}; let it vary about that")
            if width > spread.high - spread.low:
                message = f"is {width:g}, and it varies from {spread.low:g} to {spread.high:g} only; let it vary more"
                raise refused_at(("wish", "capture", key), file.study, source, message)

    def __repr__(self) -> str:
        return f"<Design of {self._file.study.nominal.scene.name!r}: {self._file.study.varied[-1].key} to be chosen>"

    def run(self, *, workers: int | None = None, progress: Progress | None = None) -> DesignResults:
        """Search, and return what was found; all values of the changed number are asked with the same runs.

        Parameters
        ----------
        workers
            As for `Study.run`.
        progress
            Called after each value.

        Raises
        ------
        SceneError
            ``workers`` is no whole number from 1 upwards.
        KeyboardInterrupt
            Ctrl-C was pressed.
        """
        from cagepose.sampling.runner import Runner

        runner, wish, n_runs = Runner(self._file.study, workers), self._file.model.wish, 0

        def measured(value: float) -> TradeOffPoint:
            nonlocal n_runs
            point, n_more = (self._yield if wish.share is not None else self._capture)(runner, value)
            n_runs += n_more
            if progress is not None:
                progress(point)
            return point

        try:
            found = trade_off(measured, self._file.tight, self._file.loose, wish.at_least)
            return DesignResults(self._file, found, n_runs)
        finally:
            runner.close()

    def _yield(self, runner: Runner, value: float) -> tuple[TradeOffPoint, int]:
        n_runs, n_good = self._sample.n_runs, 0
        for first in range(0, n_runs, runner.rows_of_a_part):
            rows = self._sample.values(first, min(first + runner.rows_of_a_part, n_runs))
            n_good += int(self._good(runner, np.c_[rows, np.full(len(rows), value)]).sum())
        return TradeOffPoint(value, n_good / n_runs, *wilson(n_good, n_runs)), n_runs

    def _capture(self, runner: Runner, value: float) -> tuple[TradeOffPoint, int]:
        nominal = np.array([*(one.nominal for one in self._file.study.varied[:-1]), value])
        n_runs = 0

        def good(captured: FloatArray) -> FloatArray:
            nonlocal n_runs
            n_runs += len(captured)
            rows = np.tile(nominal, (len(captured), 1))
            rows[:, self._captured] = captured
            return self._good(runner, rows)

        width = captured_range(good, float(nominal[self._captured]), self._low, self._high)
        return TradeOffPoint(value, width, width, width), n_runs

    def _good(self, runner: Runner, rows: FloatArray) -> FloatArray:
        good: FloatArray = self._columns.columns(rows, runner.run(rows))["accepted"]
        return good
