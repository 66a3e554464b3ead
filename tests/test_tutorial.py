"""The tutorial's file, as it grows, gives what stands below it."""

from __future__ import annotations

import contextlib
import io
import re
from pathlib import Path

import pytest

from cagepose.cli.app import main

PAGE = (Path(__file__).resolve().parent.parent / "docs" / "tutorial.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```(yaml|text|python)\n(.*?)```", PAGE, re.DOTALL)
START, FAILING, SEATING = [text for kind, text in BLOCKS if kind == "yaml"]
FILES = [START, START + FAILING, START + SEATING, START + SEATING]
LISTINGS = [text.partition("\n") for kind, text in BLOCKS if kind == "text" and text.startswith("$ cagepose ")]


def timeless(text: str) -> list[str]:
    """Lines without times of solving and rounding residuals."""
    lines = re.sub(r"[\d.e-]+ (ms|s)\b", "TIME", re.sub(r"residual [\d.e-]+", "residual", text)).splitlines()
    return [line.rstrip() for line in lines if line.strip()]


@pytest.mark.parametrize("number", range(len(LISTINGS)))
def test_each_command_prints_its_listing(
    number: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """All lines of a listing that is cut by dots are printed."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "110")
    (tmp_path / "fixture.yaml").write_text(FILES[number], encoding="utf-8")
    command, _, expected = LISTINGS[number]
    main(command.split()[2:])
    printed = timeless(capsys.readouterr().out)
    shown = [line for line in timeless(expected) if line != "..."]
    assert [line for line in printed if line in shown] == shown
    assert "..." in expected or printed == shown


def test_the_certificate_is_checked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "fixture.yaml").write_text(START + SEATING, encoding="utf-8")
    (code,) = (text for kind, text in BLOCKS if kind == "python")
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(code, {})
    assert printed.getvalue() == BLOCKS[-1][1]
