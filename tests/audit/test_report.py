"""What the audit prints, writes and returns: a failure is an error unless it is known."""

from __future__ import annotations

from io import StringIO

import pytest
from rich.console import Console

from audit import __main__ as command
from audit.case import Failure
from audit.families import FAMILIES, make_case
from audit.report import KNOWN, Known, read_known, show_failures
from cagepose import load_scene


@pytest.fixture
def console():
    return Console(file=StringIO(), width=170)


def test_a_failure_is_listed_and_its_scene_written(console, tmp_path):
    failure = Failure("grid", 3, "balance", "weight: not balanced")
    assert show_failures(console, [failure], tmp_path, 0, {})
    assert "balance   grid:3  weight: not balanced" in console.file.getvalue()
    text = (tmp_path / "grid-3.yaml").read_text(encoding="utf-8")
    assert "--case grid:3" in text
    assert "balance: weight: not balanced" in text
    again, scene = load_scene(tmp_path / "grid-3.yaml"), make_case("grid", 3).scene
    assert (again.cage.points_world() == scene.cage.points_world()).all()


def test_a_known_failure_is_listed_with_its_reason_and_is_no_error(console, tmp_path):
    failure = Failure("grid", 3, "balance", "weight: not balanced")
    known = {("grid", 3, "balance"): Known("grid", 3, "balance", "a reason")}
    assert not show_failures(console, [failure], tmp_path, 0, known)
    assert "(known: a reason)" in console.file.getvalue()


def test_the_file_of_known_failures_names_families_that_there_are():
    assert {entry.family for entry in read_known(KNOWN).values()} <= set(FAMILIES)


def test_the_command_asks_one_case(monkeypatch, capsys, tmp_path):
    arguments = ["audit", "--case", "floor:1", "--processes", "1", "--out", str(tmp_path / "out")]
    monkeypatch.setattr("sys.argv", arguments)
    assert command.main() in (0, 1)
    assert "1 cases" in capsys.readouterr().out


def test_a_case_that_is_none_is_refused(monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["audit", "--case", "flor:1"])
    with pytest.raises(SystemExit):
        command.main()
    assert "families: near-contact" in capsys.readouterr().err
