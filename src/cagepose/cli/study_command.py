"""``cagepose study``: run a scene many times with numbers that vary, and say what that means."""

from __future__ import annotations

import errno
import os
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from cagepose.cli.options import FILE, FileName, Switch, refusal

if TYPE_CHECKING:
    from cagepose.sampling.results import StudyResults
    from cagepose.sampling.study import Progress

SHOW = "show"
SECONDS_BETWEEN_LINES = 10.0


def study_command(
    file: Annotated[FileName, Parameter(help="Study file (YAML or JSON), or the word show.")],
    folder: Annotated[FileName | None, FILE, Parameter(help="After show: the folder of a study.")] = None,
    /,
    *,
    out: Annotated[
        FileName | None, FILE, Parameter(help="Folder for rows and report; created if it does not exist.")
    ] = None,
    resume: Annotated[bool, Switch, Parameter(help="Continue a study that was interrupted, in its folder.")] = False,
    workers: Annotated[
        int | None, Parameter(help="How many threads or processes to use; left out: one for each core.")
    ] = None,
    dask: Annotated[
        str | None,
        Parameter(help="Address of a Dask scheduler whose workers run the rows, such as tcp://10.0.0.1:8786."),
    ] = None,
    json: Annotated[bool, Switch, Parameter(help="Print the report's numbers as JSON instead of tables.")] = False,
    csv: Annotated[
        FileName | None, FILE, Parameter(help="After show: write all rows into this file, and print nothing else.")
    ] = None,
) -> int:
    """Run a study and write its report into a folder; or print it again: cagepose study show FOLDER"""
    problem = _problem(file, folder, out, resume, workers, dask) or _csv_problem(file, csv, json)
    if problem is not None:
        sys.stderr.write(f"cagepose: {problem} See: cagepose study --help\n")
        return 2
    from cagepose.errors import printable
    from cagepose.sampling.results import StudyResults
    from cagepose.sampling.study import Study

    workers = workers or os.cpu_count() or 1
    if folder is not None and csv is not None:
        return _write_csv(StudyResults(folder), csv)
    try:
        if folder is not None:
            numbers, written = _reported(StudyResults(folder), workers, is_shown=True)
        else:
            assert out is not None, "it was asked for above"
            results = Study.load(file).run(out, resume=resume, workers=workers, dask=dask, progress=_progress())
            numbers, written = _reported(results, workers, is_shown=False)
    except OSError as error:
        remedy = "make room" if error.errno in (errno.ENOSPC, errno.EDQUOT) else "put that right"
        again = "" if out is None else " and add --resume"
        reason = f"cannot be written ({error.strerror or error}); {remedy}{again}"
        sys.stderr.write(printable(f"{folder or out}: {reason}") + "\n")
        return 2
    except KeyboardInterrupt:
        if out is not None:
            sys.stderr.write(f"\ncagepose: what is done is kept; go on with: {_again(file, out)}\n")
        raise
    if json:
        from cagepose.sampling.report import numbers_text

        sys.stdout.write(numbers_text(numbers))
        return 0
    from cagepose.cli.study_report import print_study

    print_study(numbers)
    if written:
        from cagepose.model.wording import number_of

        sys.stdout.write(printable(f"wrote {written[0]} and {number_of(len(written) - 1, 'file')} beside it") + "\n")
    return 0


def _again(file: str, out: str) -> str:
    from shlex import join

    return join(["cagepose", "study", file, "--out", out, "--resume"])


def _problem(
    file: str, folder: str | None, out: str | None, resume: bool, workers: int | None, dask: str | None
) -> str | None:
    if workers is not None and workers < 1:
        return f"--workers is {workers}; give 1 or more."
    if file == SHOW:
        if folder is None:
            return "study show needs the folder of a study."
        is_run = out is not None or resume or dask is not None
        return "study show runs nothing; leave --out, --resume and --dask out." if is_run else None
    if folder is not None:
        return f"too many arguments: {folder}; write study FILE --out FOLDER, or study show FOLDER."
    return "study needs --out FOLDER for its rows and its report." if out is None else None


def _csv_problem(file: str, csv: str | None, json: bool) -> str | None:
    if csv is not None and file != SHOW:
        return "--csv works with study show alone: study show FOLDER --csv FILE."
    return "--csv prints no report; leave --json out." if csv is not None and json else None


def _write_csv(results: StudyResults, path: str) -> int:
    from cagepose.errors import printable
    from cagepose.model.wording import number_of

    try:
        results.to_csv(path)
    except OSError as error:
        sys.stderr.write(refusal(f"--csv {path}", error) + "\n")
        return 2
    sys.stdout.write(printable(f"wrote {path}: {number_of(len(results), 'row')}") + "\n")
    return 0


def _reported(results: StudyResults, workers: int, *, is_shown: bool) -> tuple[dict[str, Any], list[Path]]:
    """Return what a study says, and the files of a report; one that is only shown and has its report gets no other."""
    from cagepose.files.progress import tell
    from cagepose.sampling.findings import document, findings_of
    from cagepose.sampling.report import kept_numbers, write_report

    numbers = kept_numbers(results) if is_shown else None
    if numbers is not None:
        return numbers, []
    findings = findings_of(results, workers)
    tell("cagepose: the report: its pictures, and the runs that it plays")
    written = write_report(findings)
    tell("")
    return document(findings), written


def _progress() -> Progress:
    """Return what tells on standard error how far a study is and how long it will take: one line on a terminal."""
    from cagepose.model.wording import duration, number_of

    began, told, skipped = time.perf_counter(), 0.0, 0
    on_screen = sys.stderr.isatty()

    def tell(done: int, n_runs: int, ran: bool) -> None:
        nonlocal told, skipped
        now = time.perf_counter()
        skipped = skipped if ran else done  # what was there took no time
        elapsed = now - began
        left = elapsed * (n_runs - done) / max(done - skipped, 1)
        if done < n_runs and not on_screen and now - told < SECONDS_BETWEEN_LINES:
            return
        told = now
        text = (
            f"cagepose: {done:,} of {number_of(n_runs, 'run')}, {duration(left)} left"
            if done < n_runs
            else (f"cagepose: {number_of(n_runs, 'run')} in {duration(elapsed)}")
        )
        sys.stderr.write(f"\r{text:60}" + ("\n" if done == n_runs else "") if on_screen else f"{text}\n")
        sys.stderr.flush()

    return tell
