"""The README's examples run and print what the README says they print."""

from __future__ import annotations

import contextlib
import io
import re
from pathlib import Path

import pytest

from cagepose.cli.app import main
from test_tutorial import timeless

ROOT = Path(__file__).resolve().parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")


def block(language: str, *, holding: str) -> str:
    found = [text for text in re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL) if holding in text]
    assert len(found) == 1
    return found[0]


def test_the_python_example_prints_what_stands_below_it():
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(block("python", holding="import cagepose"), {})
    assert printed.getvalue() == block("text", holding="rests (stable):")


def test_the_scene_shown_is_the_sample():
    assert block("yaml", holding="name: sample") == (ROOT / "scenes" / "sample.yaml").read_text(encoding="utf-8")


def test_the_rail_prints_its_listing(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    command, _, expected = block("text", holding="$ cagepose run scenes/rail-pitch.yaml").partition("\n")
    monkeypatch.chdir(ROOT)
    assert main(command.split()[2:]) == 0
    assert timeless(capsys.readouterr().out) == timeless(expected)
