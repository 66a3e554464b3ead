"""The page about studies: what its listing of gaps prints stands below it."""

from __future__ import annotations

import contextlib
import io
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "studies.md").read_text(encoding="utf-8")
SECTION = PAGE[PAGE.index("## Gaps, angles and distances") :]
CODE, PRINTED = re.findall(r"```(?:python|text)\n(.*?)```", SECTION, re.DOTALL)[:2]


def test_the_code_prints_what_stands_below_it(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "scenes").symlink_to(ROOT / "scenes")
    monkeypatch.chdir(tmp_path)
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(CODE, {})
    assert printed.getvalue() == PRINTED
