"""The page about insertion and jamming: its Python prints what stands below it."""

from __future__ import annotations

import contextlib
import io
import re
from itertools import pairwise
from pathlib import Path

import pytest

from cagepose.cli.app import main

ROOT = Path(__file__).resolve().parent.parent
PAGE = (ROOT / "docs" / "insertion.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```(python|text)\n(.*?)```", PAGE, re.DOTALL)
PRINTS = [(code, text) for (kind, code), (other, text) in pairwise(BLOCKS) if (kind, other) == ("python", "text")]
CODE, PRINTED = ("".join(parts) for parts in zip(*PRINTS, strict=True))
LISTING = next(text for _, text in BLOCKS if text.startswith("$ cagepose insertion"))


def test_the_code_prints_what_stands_below_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(CODE, {})
    assert printed.getvalue() == PRINTED


def test_the_listing_is_what_the_command_prints(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.chdir(ROOT)
    command, _, listing = LISTING.partition("\n")
    arguments = command.removeprefix("$ cagepose ").replace("dock.png", str(tmp_path / "dock.png")).split()
    assert main(arguments) == 0
    assert capsys.readouterr().out == listing
