"""``cagepose study``: run a scene many times with numbers that vary, and say what that means."""

from __future__ import annotations

import os
import sys
import time
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from cagepose.cli.options import Switch

if TYPE_CHECKING:
    from cagepose.sampling.results import StudyResults
    from cagepose.sampling.study import Progress

SHOW = "show"
SECONDS_BETWEEN_LINES = 10.0


def study_command(
    file: Annotated[str, Parameter(help="Study file (YAML or JSON), or the word show.")],
    folder: Annotated[str | None, Parameter(help="After show: the folder of a study.")] = None,
    /,
    *,
    out: Annotated[str | None, Parameter(help="Folder for rows and report; made if it is not there.")] = None,
    resume: Annotated[bool, Switch, Parameter(help="Go on with a folder that holds this study already.")] = False,
    workers: Annotated[
        int | None, Parameter(help="Threads, or processes where scenes are built row by row; left out: all cores.")
    ] = None,
    json: Annotated[bool, Switch, Parameter(help="Print the report's numbers as JSON instead of tables.")] = False,
) -> int:
    """Run a study into a folder with its report, or show what a folder says: cagepose study show FOLDER"""
    problem = _problem(file, folder, out, resume, workers)
    if problem is not None:
        sys.stderr.write(f"cagepose: {problem} See: cagepose study --help\n")
        return 2
    from cagepose.sampling.results import StudyResults
    from cagepose.sampling.study import Study

    workers = workers or os.cpu_count() or 1
    target = out if folder is None else folder
    assert target is not None, "one of the two is given"
    try:
        if folder is not None:
            results = StudyResults(folder)
        else:
            study = Study.load(file)
            try:
                results = study.run(target, resume=resume, workers=workers, progress=_progress())
            except KeyboardInterrupt:
                sys.stderr.write(
                    f"\ncagepose: what is done is kept; go on with: cagepose study {file} --out {out} --resume\n"
                )
                raise
        return _report(results, workers, is_shown=folder is not None, json=json)
    except OSError as error:
        from cagepose.errors import printable

        sys.stderr.write(
            printable(f"{target}: cannot be written ({error.strerror or error}); make room and add --resume") + "\n"
        )
        return 2


def _problem(file: str, folder: str | None, out: str | None, resume: bool, workers: int | None) -> str | None:
    if workers is not None and workers < 1:
        return f"--workers is {workers}; give 1 or more."
    if file == SHOW:
        if folder is None:
            return "study show needs the folder of a study."
        return "study show runs nothing; leave --out and --resume out." if out is not None or resume else None
    if folder is not None:
        return f"too many arguments: {folder}; write study FILE --out FOLDER, or study show FOLDER."
    return "study needs --out FOLDER for its rows and its report." if out is None else None


def _report(results: StudyResults, workers: int, *, is_shown: bool, json: bool) -> int:
    """Print what a study says; one that is only shown and has its report is not asked anew."""
    from cagepose.sampling.findings import document, findings_of
    from cagepose.sampling.report import kept_numbers, numbers_text, write_report

    numbers, written = kept_numbers(results) if is_shown else None, ""
    if numbers is None:
        findings = findings_of(results, workers)
        files = write_report(findings)
        numbers, written = document(findings), f"wrote {files[0]} and {len(files) - 1} files beside it\n"
    if json:
        sys.stdout.write(numbers_text(numbers))
        return 0
    from cagepose.cli.study_report import print_study
    from cagepose.errors import printable

    print_study(numbers)
    sys.stdout.write(printable(written.removesuffix("\n")) + "\n" if written else "")
    return 0


def _progress() -> Progress:
    """Return what tells on standard error how far a study is and how long it will take: one line on a terminal."""
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
            f"cagepose: {done:,} of {n_runs:,} runs, {_duration(left)} left"
            if done < n_runs
            else (f"cagepose: {n_runs:,} runs in {_duration(elapsed)}")
        )
        sys.stderr.write(f"\r{text:60}" + ("\n" if done == n_runs else "") if on_screen else f"{text}\n")
        sys.stderr.flush()

    return tell


def _duration(seconds: float) -> str:
    """As people say it.

    >>> _duration(4.2), _duration(200.0), _duration(9000.0)
    ('4.2 s', '3 min 20 s', '2 h 30 min')
    """
    if seconds < 60.0:
        return f"{seconds:.1f} s"
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes} min {rest} s" if minutes < 60 else f"{minutes // 60} h {minutes % 60} min"
