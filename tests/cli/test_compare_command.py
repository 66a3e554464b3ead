"""``cagepose compare``: what it prints and how it ends."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import cagepose
import cagepose.studies.comparison
from cagepose import Run, Scene
from cagepose.cli.comparison_report import print_comparison

Command = Callable[..., Any]
SCENES = Path(__file__).resolve().parents[2] / "scenes"


def test_the_table_has_a_row_for_each_variant_of_the_sample(command: Command, sample: str) -> None:
    answer = command("compare", sample)
    rows = [re.split(r"\s{2,}", line) for line in answer.out.split("\n\n")[1].splitlines()[2:]]
    wedged = ["rests", "rests, unstable", "0, 4, 3.07107", "0, -45, 0", "4"]
    paper = ["stable", "moves", "-0.170615, 1.3406, 2.12922", "-23.3598, -17.6124, 54.9864", "4"]
    assert rows[:3] == [
        ["stepwise", *paper],
        ["quasistatic, by inertia, friction 0", *wedged],
        ["quasistatic, by drag, friction 0", *wedged],
    ]
    assert [row[0] for row in rows[3:]] == [
        "quasistatic, by inertia, friction 0.1003",  # tan(0.1 rad), where the paper's rules take contacts to slip
        "quasistatic, by drag, friction 0.1003",
    ]
    assert answer.code == 0


def test_variants_that_part_alike_are_told_together_with_both_motions(command: Command, sample: str) -> None:
    out = command("compare", sample, "--friction", "0").out
    assert out.split("\n\n")[-1] == (
        "quasistatic, by inertia, friction 0\n"
        "quasistatic, by drag, friction 0\n"
        "    differ from stepwise in 'gravity' from event 2 on: stepwise turns about (0, -1, 0) by 28.96 deg (A-2:"
        " about its one contact, taken as fixed, along the load's moment); quasistatic turns about (0, -1, 0) by 34.11"
        " deg (sliding: the contacts do not balance the load, and those with a force slide)\n"
    )


def test_ways_that_do_not_part_are_counted(command: Command) -> None:
    out = command("compare", str(SCENES / "ladder.yaml")).out
    assert out.endswith("\n2 of 4 have the same events as stepwise\n")
    assert out.count("stepwise ends: stable (no turn about two of its contacts is free)") == 1


def test_lengths_are_shown_in_the_scenes_unit(command: Command, sample: str) -> None:
    out = command("compare", sample, "--set", "units.length=in", "--set", "tolerances.touch=1e-8").out
    assert "centre of gravity (in)" in out
    assert "0, 4, 3.07107" in out


def test_each_given_friction_is_run_with_both_metrics(command: Command, sample: str) -> None:
    out = command("compare", sample, "--friction", "0.5", "--friction", "0.25").out
    labels = re.findall(r"^(quasistatic, .*?)  ", out, re.MULTILINE)
    assert labels == [f"quasistatic, {how}, friction {mu}" for mu in (0.5, 0.25) for how in ("by inertia", "by drag")]


def test_json_holds_a_run_document_for_each_variant(command: Command, sample: str) -> None:
    answer = command("compare", sample, "--json", "--friction", "0")
    document = json.loads(answer.out)
    assert (answer.code, document["scene"]) == (0, "sample")
    stepwise, release, drag = document["variants"]
    assert (stepwise["label"], stepwise["metric"], stepwise["method"]) == ("stepwise", None, "stepwise")
    assert (release["metric"], drag["metric"], release["friction"]) == ("release", "drag", 0.0)
    run = json.loads(command("run", sample, "--json", "--set", "friction.coefficient=0").out)
    assert {**run, "timing_s": None}.items() <= {**release, "timing_s": None}.items()
    first = document["partings"][0]
    assert (first["label"], first["phase"], first["event"], first["stepwise_event"]) == (
        "quasistatic, by inertia, friction 0",
        "gravity",
        2,
        2,
    )
    assert first["reason"].startswith("stepwise turns about (0, -1, 0) by 28.96 deg")


@pytest.mark.parametrize("shown", ["-1", "nan", "inf"])
def test_what_is_no_friction_is_refused(command: Command, sample: str, shown: str) -> None:
    message = f"--friction {shown}: is no coefficient of friction; give a finite number, zero or above\n"
    assert command("compare", sample, "--friction", shown) == (2, "", message)


def test_problems_of_scene_and_frictions_come_at_once(command: Command, in_folder: Path) -> None:
    assert in_folder.is_dir()
    answer = command("compare", "nothing.yaml", "--friction", "-1")
    assert answer == (
        2,
        "",
        "--friction -1: is no coefficient of friction; give a finite number, zero or above\n"
        "nothing.yaml: does not exist; check the name and the folder\n",
    )


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], 'Command "compare" parameter SCENE requires an argument.'),
        (["a.yaml", "--friction", "x"], 'Invalid value for --friction: unable to convert "x" into float.'),
        (["a.yaml", "--method", "stepwise"], "Unknown option: --method. Did you mean --set?"),
    ],
)
def test_a_wrong_command_line_ends_with_2_and_one_line(command: Command, arguments: list[str], message: str) -> None:
    assert command("compare", *arguments) == (2, "", f"cagepose: {message} See: cagepose compare --help\n")


def test_the_exit_code_is_1_only_if_every_variant_failed(
    command: Command, sample: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert command("compare", str(SCENES / "pendulum.yaml")).code == 0  # stepwise spins, the others do not
    solve = cagepose.studies.comparison.run

    def spinning(scene: Scene, method: str | None = None) -> Run:
        result = solve(scene, method)
        return replace(result, phases=(replace(result.phases[0], verdict="spins"),))

    monkeypatch.setattr(cagepose.studies.comparison, "run", spinning)
    answer = command("compare", sample)
    assert answer.code == 1
    assert "spins" in answer.out


def test_a_narrow_screen_breaks_no_number(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    for key, value in (("COLUMNS", "80"), ("TERM", "dumb")):
        monkeypatch.setenv(key, value)
    print_comparison(cagepose.compare(cagepose.load_scene(SCENES / "ladder.yaml")), "mm")
    lines = [line.rstrip() for line in capsys.readouterr().out.splitlines()]
    assert max(map(len, lines)) <= 80
    assert any(re.match(r"stepwise +stable \(proof: .*\), \d+ events?$", line) for line in lines)
    assert sum(bool(re.match(r"  centre of gravity +\(\S+, \S+, \S+\) mm$", line)) for line in lines) == 5
