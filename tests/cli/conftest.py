from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest

from cagepose.cli.app import main

SAMPLE = """\
name: sample
object:
  boxes:
    - size: [10, 10, 10]
      position: [0, 0, 0]
  pose: {position: [2, 4, 10]}
cage:
  points:
    C1: [4, 4, 0]
    C2: [4, -4, 0]
    C3: [-4, -4, 0]
    C4: [-4, 4, 0]
loads:
  - name: gravity
    gravity: [0, 0, -1]
"""


class Answer(NamedTuple):
    """What a command left behind."""

    code: int
    out: str
    err: str


@pytest.fixture
def sample_text() -> str:
    return SAMPLE


@pytest.fixture
def in_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder that commands run in, so that file names in messages are short."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def sample(in_folder: Path) -> str:
    """The sample scene's file name."""
    (in_folder / "scene.yaml").write_text(SAMPLE, encoding="utf-8")
    return "scene.yaml"


@pytest.fixture
def command(capsys: pytest.CaptureFixture[str]) -> Callable[..., Answer]:
    """Run a command line in this process."""

    def run(*arguments: str) -> Answer:
        capsys.readouterr()
        code = main(arguments)
        captured = capsys.readouterr()
        return Answer(code, captured.out, captured.err)

    return run
