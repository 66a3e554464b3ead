"""``cagepose reproduce``: table, progress, report and refusals."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from cagepose.files import extra
from cagepose.paper import cases, figures
from cagepose.paper.cases import run_cases
from cagepose.paper.report import report_files
from cagepose.paper.reproduction import METHODS

Command = Callable[..., Any]


def test_the_whole_command_writes_a_report_and_prints_the_table(
    command: Command, in_folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its pictures are left blank: what they show is asked of the report itself."""
    monkeypatch.setattr(figures, "_picture", lambda _: figures.Picture(b"", b""))
    monkeypatch.setattr(cases, "TIMED_RUNS", 1)
    answer = command("reproduce", "--out", "report")
    assert answer.code == 0
    assert sorted(path.name for path in (in_folder / "report").iterdir()) == sorted(report_files(METHODS))
    rows = [re.split(r"\s{2,}", line) for line in answer.out.splitlines()]
    assert rows[0] == [
        "section", "quantity", "paper", "stepwise", "quasistatic", "closed form", "difference", "explanation",
    ]  # fmt: skip
    assert [row[:7] for row in rows if row[:2] == ["IV.B", "pitch after the weight"]] == [
        ["IV.B", "pitch after the weight", "0.392 deg", *3 * ["0.413084 deg"], "+0.021084 deg"]
    ]
    assert len(rows) == 32
    assert answer.out.endswith("wrote report/report.html, report/report.md and 28 picture files\n")
    steps = [line for line in answer.err.splitlines() if line.startswith("[")]
    assert len(steps) == 22
    seconds = [float(step[1:].split()[0]) for step in steps]
    assert seconds == sorted(seconds)


def test_what_was_done_before_a_kill_is_a_report_of_its_own(
    command: Command, in_folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is stopped as its second method begins."""
    first, second = METHODS

    def stopped(method: str, progress: Any) -> Any:
        if method == second:
            raise KeyboardInterrupt
        return run_cases(method, progress)

    monkeypatch.setattr("cagepose.paper.reproduction.run_cases", stopped)
    assert command("reproduce", "--out", "report").code == 130
    assert sorted(path.name for path in (in_folder / "report").iterdir()) == sorted(report_files([first]))
    page = (in_folder / "report" / "report.md").read_text(encoding="utf-8")
    assert f"{first}-rail-events.png" in page
    assert second not in page.split("| section")[1].split("\n")[0]


@pytest.mark.parametrize(
    ("out", "reason"),
    [
        ("file", "is not a folder; name one, or a new one"),
        ("none/new", "cannot be made, as the folder that it would lie in does not exist; make that first"),
        (
            ".",
            "report.md holds something else than a file of an earlier report; name another file, or remove it first",
        ),
    ],
)
def test_a_folder_that_cannot_be_is_refused_before_the_runs(
    command: Command, in_folder: Path, monkeypatch: pytest.MonkeyPatch, out: str, reason: str
) -> None:
    def never(*_: object) -> None:
        raise AssertionError("nothing may run before the folder is checked")

    (in_folder / "file").write_text("mine", encoding="utf-8")
    (in_folder / "report.md").write_text("mine", encoding="utf-8")
    monkeypatch.setattr("cagepose.paper.reproduction.reproduce", never)
    assert command("reproduce", "--out", out) == (2, "", f"--out {out}: {reason}\n")
    assert (in_folder / "report.md").read_text(encoding="utf-8") == "mine"
    assert len(list(in_folder.iterdir())) == 2


@pytest.mark.parametrize(
    ("module", "need"),
    [
        ("matplotlib", "pictures need matplotlib"),
        ("jinja2", "the report needs Jinja2"),
        ("markdown_it", "the report needs markdown-it-py"),
    ],
)
def test_a_missing_library_is_named_with_its_install_line(
    command: Command, in_folder: Path, monkeypatch: pytest.MonkeyPatch, module: str, need: str
) -> None:
    monkeypatch.setattr(extra, "find_spec", lambda name: None if name == module else object())
    message = f"{need}, which is not installed; install the plot extra: pip install 'cagepose[plot]'\n"
    assert command("reproduce") == (2, "", message)
    assert list(in_folder.iterdir()) == []


def test_a_disk_that_fills_up_is_told(command: Command, in_folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full_disk(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("cagepose.paper.reproduction.reproduce", lambda *_: None)
    monkeypatch.setattr("cagepose.paper.report.write_report", full_disk)
    answer = command("reproduce")
    assert answer.code == 2
    assert answer.err.endswith("--out reproduction: No space left on device\n")
    assert list(in_folder.iterdir()) == []
