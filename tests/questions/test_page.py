"""The page about questions: its listings are what the commands print."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from cagepose.cli.app import main

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "questions.md").read_text(encoding="utf-8")
LISTINGS = re.findall(r"```text\n\$ cagepose (.*?)\n(.*?)```", PAGE, re.DOTALL)


@pytest.mark.parametrize(("command", "printed"), LISTINGS)
def test_a_listing_is_what_the_command_prints(
    command: str, printed: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(ROOT)
    assert main(command.split()) == 0
    assert capsys.readouterr().out == printed
