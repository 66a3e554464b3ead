"""The README's Python example runs and prints what the README says it prints."""

from __future__ import annotations

import contextlib
import io
import re
from pathlib import Path

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
