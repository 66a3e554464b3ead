"""The command line around the commands: overview, usage errors, bugs, interruptions, ``init`` and ``schema``."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from typing import Any, get_args

import pytest

import cagepose.runs.solve
from cagepose.cli.app import COMMANDS, overview
from cagepose.exchange.export import Format
from cagepose.exchange.source_solids import SOLIDS
from cagepose.files.schema import scene_json_schema

Command = Callable[..., Any]


@pytest.mark.parametrize("arguments", [[], ["--help"], ["-h"]])
def test_the_overview_lists_every_command(command: Command, arguments: list[str]) -> None:
    answer = command(*arguments)
    assert answer == (0, overview(), "")
    for name, (_, summary) in COMMANDS.items():
        assert f"  {name} " in answer.out
        assert summary in answer.out


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_has_its_help(command: Command, name: str) -> None:
    answer = command(name, "--help")
    assert (answer.code, answer.err) == (0, "")
    assert f"Usage: cagepose {name}" in answer.out


def test_the_help_of_run_names_every_flag(command: Command) -> None:
    out = command("run", "--help").out
    assert all(flag in out for flag in ("SCENE", "--method", "--set", "--json", "--out", "--check-tolerance"))
    assert "--no-" not in out


def test_files_of_other_programs_are_named_alike_wherever_they_are(command: Command) -> None:
    """In the overview, the help of a command, its choices, and the README."""
    readme = (Path(__file__).resolve().parents[2] / "README.md").read_text().lower()
    solids = [suffix.strip(".") for suffix in SOLIDS if suffix != ".stp"]
    for name, formats in (("export", get_args(Format)), ("import", ["mjcf", "urdf", *solids])):
        (line,) = (line for line in readme.splitlines() if f"cagepose {name} " in line)
        for told in (COMMANDS[name][1].lower(), command(name, "--help").out.lower(), line):
            assert [format for format in formats if format not in told] == []


def test_the_version_is_that_of_the_package(command: Command) -> None:
    assert command("--version") == (0, f"cagepose {version('cagepose')}\n", "")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["rnu"], 'Unknown command "rnu". Did you mean "run"? Available commands: run, compare, play, insertion,'
                  " ask, check, plot, view, ... See: cagepose --help"),
        (["run"], 'Command "run" parameter SCENE requires an argument. See: cagepose run --help'),
        (["run", "a.yaml", "--jsn"], "Unknown option: --jsn. Did you mean --json? See: cagepose run --help"),
        (["run", "a.yaml", "--set"], 'Command "run" parameter --set requires an argument. See: cagepose run --help'),
        (["run", "a.yaml", "--set", "a=1", "b=2"],
         "too many arguments: b=2; each change needs its own --set. See: cagepose run --help"),
        (["check", "a.yaml", "--json"], "Unknown option: --json. See: cagepose check --help"),
        (["init"], 'Command "init" parameter NAME requires an argument. See: cagepose init --help'),
    ],
)  # fmt: skip
def test_a_wrong_command_line_ends_with_2_and_one_line(command: Command, arguments: list[str], message: str) -> None:
    assert command(*arguments) == (2, "", f"cagepose: {message}\n")


def test_a_bug_of_ours_ends_with_3_and_asks_for_a_report(
    command: Command, sample: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(*_: object) -> None:
        raise ZeroDivisionError("a bug")

    monkeypatch.setattr(cagepose.runs.solve, "run", broken)
    answer = command("run", sample, "--json")
    assert (answer.code, answer.out) == (3, "")
    assert "ZeroDivisionError: a bug" in answer.err
    assert answer.err.endswith(
        "cagepose: this is a bug of ours; please report it with the lines above and the scene file\n"
    )


def test_ctrl_c_ends_cleanly(command: Command, sample: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(cagepose.runs.solve, "run", interrupted)
    assert command("run", sample) == (130, "", "cagepose: stopped\n")


def test_init_writes_a_scene_that_check_and_run_accept(command: Command, in_folder: Path) -> None:
    assert command("init", "mine") == (0, "wrote mine.yaml; try: cagepose run mine.yaml\n", "")
    assert (in_folder / "mine.yaml").is_file()
    assert command("check", "mine.yaml").code == 0
    assert command("run", "mine.yaml").out.startswith("mine: rests")


def test_init_leaves_an_existing_file_alone(command: Command, in_folder: Path) -> None:
    (in_folder / "mine.yaml").write_text("precious", encoding="utf-8")
    message = "mine.yaml: exists already; choose another name or remove the file\n"
    assert command("init", "mine") == (2, "", message)
    assert (in_folder / "mine.yaml").read_text(encoding="utf-8") == "precious"


def test_init_refuses_names_that_are_paths(command: Command, in_folder: Path) -> None:
    answer = command("init", "../mine")
    message = "'../mine' is not a name; start with a letter and use letters, digits, - and _ only"
    assert answer == (2, "", f"cagepose init: {message}\n")
    assert list(in_folder.iterdir()) == []


def test_schema_prints_the_json_schema(command: Command) -> None:
    answer = command("schema")
    assert answer.code == 0
    assert json.loads(answer.out) == scene_json_schema()


def test_a_shell_completes_commands_options_methods_and_files(command: Command, tmp_path: Path) -> None:
    script = tmp_path / "cagepose"
    assert command("--install-completion", "--shell", "bash", "--output", str(script)).code == 0
    (tmp_path / "my drawer.yaml").touch()
    for words, offered in (
        (["pl"], "play plot"),
        (["run", "--ma"], "--margin"),
        (["run", "--method", "st"], "stepwise"),
        (["run", "my"], "my drawer.yaml"),
        (["view", "drawer.yaml", "--export", "my"], "my drawer.yaml"),
    ):
        given = f"COMP_WORDS=(cagepose {' '.join(words)}); COMP_CWORD={len(words)}"
        line = f"{given}; _cagepose; printf '%s\\n' ${{#COMPREPLY[@]}} \"${{COMPREPLY[@]}}\""
        asked = subprocess.run(
            ["bash", "-c", f"source {script}; {line}"], capture_output=True, text=True, check=True, cwd=tmp_path
        )
        n_offered, *found = asked.stdout.splitlines()
        assert (" ".join(found), len(found)) == (offered, int(n_offered))
    asked = subprocess.run(["bash", "-c", f"source {script}; complete -p cagepose"], capture_output=True, text=True)
    assert "-o filenames" in asked.stdout  # else a space comes behind a folder
