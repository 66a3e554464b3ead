"""The friendly class: `Study`, a scene with numbers that vary, to be run many times."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

from cagepose.errors import Problem, SceneError
from cagepose.files.study_file import StudyFile, parse_study, read_study_file, study_text
from cagepose.model.checks import FloatArray
from cagepose.model.wording import few, number_of
from cagepose.sampling.outcome import Outcomes
from cagepose.sampling.results import StudyResults
from cagepose.sampling.runner import Part, Runner, RunPart, Told
from cagepose.views.extra import require_dask, require_study

if TYPE_CHECKING:
    from cagepose.sampling.folder import StudyFolder

Progress = Callable[[int, int, bool], None]
"""Called with how many rows are done, how many there are, and whether the last of them were run now."""


class Study:
    """Many runs of one scene, with what a study file holds as arguments; see the page on studies.

    Parameters
    ----------
    scene
        The scene's file.
    vary
        By key of the scene, how the number varies: ``{"parameters.play": {"uniform": [0.2, 1.0]}}``.
    sample
        ``{"method": "sobol", "runs": 10_000, "seed": 1}``.
    watch
        By the name of its columns, a point of the object, or a gap, an angle or a distance between the cage and the
        object: ``{"lean": {"angle": ["bore", "pin"]}}``.
    ask, compute, accept, forces, sensitivities, map
        As in a study file.

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
        vary: Mapping[str, Any],
        sample: Mapping[str, Any],
        *,
        watch: Mapping[str, Any] | None = None,
        ask: Sequence[str] | None = None,
        compute: Mapping[str, str] | None = None,
        accept: str | None = None,
        forces: bool | None = None,
        sensitivities: bool | None = None,
        map: Mapping[str, Any] | None = None,
    ) -> None:
        content: dict[str, Any] = {"scene": scene_name(scene), "vary": vary, "sample": sample}
        content |= {"watch": watch, "ask": ask, "compute": compute, "accept": accept}
        content |= {"forces": forces, "sensitivities": sensitivities, "map": map}
        self._begin(parse_study(study_text(content), "study"), "study")

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Study:
        """Read a study file.

        Raises
        ------
        SceneFileError
            It cannot be used; lists every problem with its line and column.
        """
        study = cls.__new__(cls)
        study._begin(read_study_file(path), os.fspath(path))
        return study

    def _begin(self, file: StudyFile, source: str) -> None:
        require_study()
        from cagepose.sampling.at_the_door import checked_columns, checked_sample

        self._file, self._columns = file, checked_columns(file, source)
        self._sample = checked_sample(file, source)

    def __repr__(self) -> str:
        varied = few(one.key for one in self._file.varied)
        return f"<Study of {self._file.nominal.scene.name!r}: {number_of(len(self), 'run')}, {varied} vary>"

    def __len__(self) -> int:
        """How many runs it has."""
        return self._sample.n_runs

    def run(
        self,
        folder: str | os.PathLike[str],
        *,
        resume: bool = False,
        workers: int | None = None,
        dask: str | None = None,
        progress: Progress | None = None,
    ) -> StudyResults:
        """Run all rows into a folder, part by part, and return what is there.

        Parameters
        ----------
        folder
            Made if it is not there.
        resume
            Whether to go on with a folder that holds this study already.
        workers
            Threads, or processes where scenes are built row by row; None: a thread for each core, or one process. A
            script that asks for more processes needs ``if __name__ == "__main__":``.
        dask
            The address of a Dask scheduler, such as ``"tcp://10.0.0.1:8786"``: its workers run the parts.
        progress
            Called after each part, and on the way where scenes are built row by row.

        Raises
        ------
        SceneError
            ``workers`` is no whole number from 1 upwards; or there is no such scheduler, or its workers have another
            cagepose.
        MissingExtraError
            The extra ``dask`` is not installed.
        StudyFolderError
            The folder holds something else, or another study writes it now.
        OSError
            It cannot be written.
        KeyboardInterrupt
            Ctrl-C was pressed; all parts that are there are whole.
        """
        if dask is not None:
            require_dask()
        from cagepose.sampling.folder import StudyFolder

        kept, runner = StudyFolder(folder), Runner(self._file, workers)
        with kept.begun(self._file, resume=resume):
            self._run_missing(kept, runner, dask, progress)
        return StudyResults(folder)

    def _run_missing(self, kept: StudyFolder, runner: Runner, dask: str | None, progress: Progress | None) -> None:
        """Run and write the parts that are not there."""
        n_runs, size = len(self), runner.rows_of_a_part
        parts = [(first, min(first + size, n_runs)) for first in range(0, n_runs, size)]
        missing = [part for part in parts if not kept.has(*part)]
        n_done = n_told = n_runs - sum(last - first for first, last in missing)

        def tell(n_rows: int) -> None:
            nonlocal n_told
            if progress is not None and n_rows > n_told:  # a part is written while the next one runs
                n_told = n_rows
                progress(n_rows, n_runs, True)

        if progress is not None and n_done:
            progress(n_done, n_runs, False)
        try:
            for n_rows in self._written(kept, self._outcomes(runner, missing, dask, n_done, tell)):
                n_done += n_rows
                tell(n_done)
        finally:
            runner.close()

    def _written(self, kept: StudyFolder, parts: Iterable[RunPart]) -> Iterator[int]:
        """Write parts, each while the next one runs, and yield how many rows were written."""
        with ThreadPoolExecutor(1) as writer:
            before: list[Future[int]] = []
            for part in parts:
                yield from (future.result() for future in before)
                before = [writer.submit(self._write, kept, *part)]
            yield from (future.result() for future in before)

    def _write(self, kept: StudyFolder, part: Part, values: FloatArray, outcomes: Outcomes) -> int:
        kept.write(*part, self._columns.table(part[0], values, outcomes))
        return len(values)

    def _outcomes(
        self, runner: Runner, parts: Sequence[Part], dask: str | None, n_before: int, tell: Told
    ) -> Iterator[RunPart]:
        """Yield parts with their varied numbers and where their runs ended, in any order; tell how many rows were run,
        those before included.
        """
        if dask is not None:
            from cagepose.sampling.cluster import run_on_cluster

            yield from run_on_cluster(self._file, dask, parts, self._sample.values)
            return

        def told(n_rows: int) -> None:
            tell(n_before + n_rows)

        for part in parts:
            values = self._sample.values(*part)
            yield part, values, runner.run(values, with_forces=bool(self._file.model.forces), told=told)
            n_before += len(values)


def scene_name(scene: object) -> str:
    """Return the name of a scene's file.

    Raises
    ------
    SceneError
        It is none.
    """
    if isinstance(scene, str | os.PathLike):
        return os.fspath(scene)
    message = f"is of type {type(scene).__name__}; give the name of a scene file: cagepose.save_scene writes one"
    raise SceneError([Problem(("scene",), message)])
