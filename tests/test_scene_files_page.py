"""What init writes with a hole gives what stands below it on the page about scene files."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from cagepose.cli.app import main
from test_tutorial import timeless

PAGE = (Path(__file__).resolve().parent.parent / "docs" / "scene-files.md").read_text(encoding="utf-8")
SECTION = PAGE.split("\n### A scene with a hole\n")[1].split("\n### ")[0]


def test_the_scene_with_a_hole_prints_its_listing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (listing,) = re.findall(r"```text\n(.*?)```", SECTION, re.DOTALL)
    monkeypatch.chdir(tmp_path)
    command, _, expected = listing.partition("\n")
    assert main(["init", "pin", "--holes"]) == 0
    capsys.readouterr()
    assert main(command.split()[2:]) == 0
    assert timeless(capsys.readouterr().out) == timeless(expected)
