"""``cagepose ask``: it lists its questions, and each has its help."""

from __future__ import annotations

from pathlib import Path

import pytest

from cagepose.cli.app import main
from cagepose.cli.ask_command import QUESTIONS
from our_scenes import SCENES


@pytest.mark.parametrize("arguments", [["ask"], ["ask", "--help"]])
def test_it_lists_every_question(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(arguments) == 0
    listed = " ".join(capsys.readouterr().out.replace("│", " ").split())
    for name, (_, summary) in QUESTIONS.items():
        assert f"{name} {summary}" in listed


@pytest.mark.parametrize("name", QUESTIONS)
def test_every_question_has_its_help(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["ask", name, "--help"]) == 0
    out = capsys.readouterr().out
    assert f"Usage: cagepose ask {name}" in out
    assert all(flag in out for flag in ("SCENE", "--set", "--json"))


def test_an_unknown_question_ends_with_2_and_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["ask", "fricton"]) == 2
    assert capsys.readouterr().err.startswith('cagepose: Unknown command "fricton". Did you mean "friction"?')


def test_a_number_that_cannot_be_is_told_with_its_option(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["ask", "escape", str(SCENES[0]), "--motions", "0"]) == 2
    assert capsys.readouterr().err.startswith('cagepose: Invalid value "0" for --motions. Must be >= 1.')


def test_the_shell_completes_every_question(tmp_path: Path) -> None:
    script = tmp_path / "completion.bash"
    assert main(["--install-completion", "--shell", "bash", "--output", str(script)]) == 0
    text = script.read_text(encoding="utf-8")
    assert [name for name in QUESTIONS if f'"ask {name}")' not in text] == []
