"""Each word that the program prints has its entry in the glossary: of those who add a word, none can forget it."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, get_args

import pytest

import cagepose.cli.app
from cagepose.kernels.quasistatic import step as quasistatic
from cagepose.kernels.stepwise import run as stepwise
from cagepose.runs.proof import ProofVerdict, Stability, Uniqueness
from cagepose.runs.run import MotionKind, Note, Verdict
from cagepose.studies.cage_verdict import Caged

PAGE = (Path(__file__).resolve().parent.parent / "docs" / "glossary.md").read_text(encoding="utf-8")
COMMANDS = Path(cagepose.cli.app.__file__).parent
TERMS = {
    word
    for line in re.findall(r"^(\S.*)\n  ", PAGE, re.MULTILINE)
    for word in (line, *line.split("; "), *re.split("[,;] ", line))
}
SAID = {" ".join(said.split()) for said in re.findall(r"`([^`]+)`", PAGE)}
SELF_EXPLAINING = {
    "",
    "#",
    "on",
    "unit",
    "end",
    "events",
    "contacts",
    "runs",
    "share",
    "95 % interval",
    "quantity",
    "name",
    "cagepose",
}
"""Headings whose word is that of daily life, or another entry's in the plural."""


def is_explained(word: str) -> bool:
    return word in TERMS or word in SAID


@pytest.mark.parametrize("kind", [Verdict, ProofVerdict, Stability, Uniqueness, MotionKind, Note, Caged])
def test_every_verdict_and_note_is_explained(kind: Any) -> None:
    assert [word for word in get_args(kind) if not is_explained(word)] == []


@pytest.mark.parametrize("rules", [quasistatic.RULE_NAMES, stepwise.RULE_NAMES])
def test_every_rule_is_explained(rules: tuple[str, ...]) -> None:
    between = {f"{letter}-{number}" for letter in "AB" for number in (2, 3)}  # "`A-1` to `A-4`"
    assert [name for name in rules if not is_explained(name) and name not in between] == []


def words_of(node: ast.AST) -> list[str]:
    """What an expression may print, with mm for a unit, and nothing for all else that is not known beforehand."""
    return [word_of(node.body), word_of(node.orelse)] if isinstance(node, ast.IfExp) else [word_of(node)]


def word_of(node: ast.AST) -> str:
    if isinstance(node, ast.JoinedStr):
        return "".join(map(word_of, node.values))
    if isinstance(node, ast.FormattedValue):
        return "mm" if ast.unparse(node.value) == "unit" else ""
    return node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else ""


def headings() -> Iterator[str]:
    """Yield the headings of all tables of all commands; a name that stands in a heading is left out."""
    for path in sorted(COMMANDS.glob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and ast.unparse(node.func).rpartition(".")[2] in (
                "plain_table",
                "add_column",
            ):
                yield from map(word_of, node.args)


def labels() -> Iterator[str]:
    """What stands in the left column below the tables of a run."""
    for name, function in (("report.py", "summary"), ("report.py", "_end"), ("margin_report.py", "margin_lines")):
        for node in ast.walk(ast.parse((COMMANDS / name).read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef) and node.name == function:
                pairs = [part for part in ast.walk(node) if isinstance(part, ast.Tuple) and len(part.elts) == 2]
                yield from (word for pair in pairs for word in words_of(pair.elts[0]))


def test_every_heading_is_explained() -> None:
    found = {re.sub(r" ?[\[(]\w*[\])]$|: (99.73 %|range)$", "", word.strip()) for word in headings()}
    assert len(found) > 20
    assert [word for word in sorted(found - SELF_EXPLAINING) if not is_explained(word)] == []


def test_every_label_is_explained() -> None:
    found = {word.removesuffix(" of ") for word in labels()}
    assert {"verdict", "proof", "mechanics", "margin of force", "critical friction"} <= found
    assert [word for word in sorted(found - SELF_EXPLAINING) if not is_explained(word)] == []
