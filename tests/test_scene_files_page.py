"""The scene with a hole on the page about scene files is whole, and gives what stands below it."""

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
    (scene,) = re.findall(r"```yaml\n(.*?)```", SECTION, re.DOTALL)
    (listing,) = re.findall(r"```text\n(.*?)```", SECTION, re.DOTALL)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "pin.yaml").write_text(scene, encoding="utf-8")
    command, _, expected = listing.partition("\n")
    assert main(command.split()[2:]) == 0
    assert timeless(capsys.readouterr().out) == timeless(expected)
