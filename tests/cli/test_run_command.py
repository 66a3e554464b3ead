"""``cagepose run`` and ``cagepose check``: what they print and how they end."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import cagepose.runs.solve
from cagepose import Run, RunFileError, Scene, load_run, load_scene
from cagepose.cli import first_run, report

Command = Callable[..., Any]


def test_the_table_shows_every_event_of_the_sample(command: Command, sample: str) -> None:
    answer = command("run", sample)
    rows = [re.split(r"\s{2,}", line.strip()) for line in answer.out.splitlines() if re.match(r"\d+  ", line)]
    assert rows == [
        ["1", "gravity", "A-1", "travel", "(0, 0, -1)", "5 mm", "C1", "C1"],
        ["2", "gravity", "A-2", "turn", "(0, -1, 0)", "28.955 deg", "C4", "C1 C4"],
        ["3", "gravity", "A-3", "turn", "(1, 0, 0)", "51.3178 deg", "C3", "C1 C3 C4"],
        ["4", "gravity", "A-4", "stable", "C1 C3 C4"],
    ]
    assert answer.code == 0


def test_the_report_names_pose_contacts_verdict_time_and_warnings(command: Command, sample: str) -> None:
    lines = command("run", sample).out.splitlines()
    assert re.fullmatch(r"sample: stable  \(stepwise, [0-9.e+]+ ms\)", lines[0])
    assert "position           (-0.170615, 1.3406, 2.12922) mm" in lines
    assert "yaw, pitch, roll   (-23.3598, -17.6124, 54.9864) deg" in lines
    assert "centre of gravity  (-0.170615, 1.3406, 2.12922) mm" in lines
    assert "contacts           C1 C3 C4 on box1" in lines
    assert "verdict            gravity: stable" in lines
    warnings = [line for line in lines if line.startswith("warning: ")]
    assert len(warnings) == 2
    assert "tie" in warnings[0]
    assert "45 deg" in warnings[1]


def test_lengths_are_shown_in_the_scenes_unit(command: Command, sample: str) -> None:
    out = command("run", sample, "--set", "units.length=in", "--set", "tolerances.touch=1e-8").out
    assert "5 in" in out
    assert "(-0.170615, 1.3406, 2.12922) in" in out
    assert " mm" not in out


def test_piped_output_has_no_escapes_no_trailing_blanks_and_nothing_cut(
    command: Command, in_folder: Path, sample_text: str
) -> None:
    long_names = sample_text
    for name in ("C1", "C2", "C3", "C4"):
        long_names = long_names.replace(f"{name}:", f"a_very_long_name_for_a_cage_point_of_this_part_{name}:")
    (in_folder / "long.yaml").write_text(long_names, encoding="utf-8")
    out = command("run", "long.yaml").out
    assert "\x1b" not in out
    assert "…" not in out
    assert " ".join(f"a_very_long_name_for_a_cage_point_of_this_part_{name}" for name in ("C1", "C3", "C4")) in out
    assert all(line == line.rstrip() for line in out.splitlines())


def test_the_usual_table_fits_100_columns(command: Command, sample: str) -> None:
    table = command("run", sample).out.split("position ")[0]
    assert max(len(line) for line in table.splitlines()) <= 100


def test_a_screen_gets_colours_and_wrapped_cells(
    sample: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    monkeypatch.setenv("COLUMNS", "100")
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.delenv("NO_COLOR", raising=False)
    report.print_report(cagepose.runs.solve.run(load_scene(sample)), "mm")
    out = capsys.readouterr().out
    assert "\x1b[1;32mstable\x1b[0m" in out
    plain = re.sub(r"\x1b\[[0-9;]*m", "", out)
    assert max(len(line) for line in plain.splitlines()) <= 100


def test_names_with_rich_markup_and_emoji_codes_are_shown_as_they_are(command: Command, sample: str) -> None:
    out = command("run", sample, "--set", "name='[red]:smile:'", "--set", "object.boxes[0].name='[b]'").out
    assert out.startswith("[red]:smile:: stable")
    assert "on [b]" in out


def test_json_is_one_document_and_nothing_else(command: Command, sample: str) -> None:
    answer = command("run", sample, "--json")
    document = json.loads(answer.out)
    assert (document["version"], document["scene"], document["verdict"]) == (1, "sample", "stable")
    assert answer.code == 0
    assert answer.err in ("", first_run.FIRST_RUN)


@pytest.mark.parametrize(("folder", "message"), [(Path("/cache"), first_run.FIRST_RUN), (None, first_run.EVERY_RUN)])
def test_a_run_that_must_compile_says_so_on_standard_error(
    command: Command, sample: str, monkeypatch: pytest.MonkeyPatch, folder: Path | None, message: str
) -> None:
    monkeypatch.setattr(cagepose.runs.solve, "kernels_are_compiled", lambda _: False)
    monkeypatch.setattr("cagepose.kernels.jit.CACHE_FOLDER", folder)
    answer = command("run", sample)
    assert answer.err == message
    assert answer.out.startswith("sample: stable")


def test_out_saves_the_run_and_the_table_is_still_printed(command: Command, sample: str) -> None:
    answer = command("run", sample, "--out", "run.json", "--set", "units.length=in")
    assert answer.code == 0
    assert "stable" in answer.out
    assert load_run("run.json").verdict == "stable"
    assert json.loads(Path("run.json").read_text(encoding="utf-8"))["units"] == {"length": "in"}


@pytest.mark.parametrize(
    ("out", "reason"),
    [
        ("nowhere/run.json", "its folder does not exist; make the folder first"),
        (".", "is a directory; name a file in it"),
        ("/dev/null", "is not a regular file; name another"),
        ("./scene.yaml", "is the scene file itself; name another"),
        ("scene.yaml/run.json", "its folder does not exist; make the folder first"),
    ],
)
def test_an_out_that_cannot_be_written_is_refused_before_the_run(
    command: Command, sample: str, monkeypatch: pytest.MonkeyPatch, out: str, reason: str
) -> None:
    monkeypatch.setattr(cagepose.runs.solve, "run", _never)
    assert command("run", sample, "--out", out) == (2, "", f"--out {out}: {reason}\n")


def test_an_out_that_fails_after_the_run_still_leaves_the_table(
    command: Command, sample: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full_disk(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full_disk)
    answer = command("run", sample, "--out", "run.json")
    assert answer.code == 2
    assert answer.err.endswith("--out run.json: No space left on device\n")
    assert "stable" in answer.out
    assert not Path("run.json").exists()


def _never(*_: object) -> None:
    raise AssertionError("nothing may run before all arguments are checked")


def test_problems_of_all_arguments_come_at_once(command: Command, in_folder: Path) -> None:
    assert in_folder.is_dir()
    answer = command("run", "nothing.yaml", "--method", "magic", "--out", "no/run.json")
    assert answer == (
        2,
        "",
        "nothing.yaml: does not exist; check the name and the folder\n"
        "--method magic: is no known method; use one of: stepwise\n"
        "--out no/run.json: its folder does not exist; make the folder first\n",
    )


def test_set_changes_the_scene_for_run_and_check(command: Command, sample: str) -> None:
    answer = command("run", sample, "--json", "--set", "object.pose.position[2]=8", "--set", "name=lower")
    document = json.loads(answer.out)
    assert document["scene"] == "lower"
    assert document["phases"][0]["events"][0]["distance"] == pytest.approx(3.0)
    assert command("check", sample, "--set", "name=lower").out.startswith("lower: ")
    assert command("check", sample, "--set", "object.mass=true") == (
        2,
        "",
        "--set object.mass=true: object.mass: is true; give a number\n",
    )


def test_a_run_that_failed_by_name_ends_with_1_and_is_still_printed_and_saved(
    command: Command, sample: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    solve = cagepose.runs.solve.run

    def spinning(scene: Scene, method: str | None = None) -> Run:
        result = solve(scene, method)
        return replace(result, phases=(replace(result.phases[0], verdict="spins"),))

    monkeypatch.setattr(cagepose.runs.solve, "run", spinning)
    answer = command("run", sample, "--out", "run.json")
    assert answer.code == 1
    assert answer.out.startswith("sample: spins")
    assert load_run("run.json").failed
    assert json.loads(command("run", sample, "--json").out)["verdict"] == "spins"


def test_an_escape_is_a_verdict(command: Command, sample: str) -> None:
    answer = command("run", sample, "--set", "loads[0].gravity=[0, 0, 1]")
    assert answer.code == 0
    assert answer.out.startswith("sample: escapes")
    assert "inf" not in answer.out


def test_check_tolerance_says_that_nothing_changes(command: Command, sample: str) -> None:
    out = command("run", sample, "--check-tolerance").out
    assert out.endswith("same verdict with a ten times larger and a ten times smaller touch tolerance\n")


def test_check_tolerance_warns_when_the_verdict_hangs_on_it(command: Command, sample: str) -> None:
    """C2 starts 0.05 um inside: touching within 1e-5 of the size (0.17 um), an impossible scene within 1e-6."""
    answer = command(
        "run", sample, "--check-tolerance", "--json",
        "--set", "tolerances.touch=1e-5", "--set", "object.pose.position=[2, 4, 4.99995]",
    )  # fmt: skip
    (warning,) = [text for text in json.loads(answer.out)["warnings"] if "touch tolerance of" in text]
    assert warning.startswith("with a touch tolerance of 1e-06 instead of 1e-05 the scene cannot be run (cage.points.C")
    assert answer.code == 0


def test_check_says_what_a_scene_holds(command: Command, sample: str) -> None:
    assert command("check", sample) == (
        0,
        "sample: 1 box, 4 cage points, 1 load (gravity), method stepwise\n"
        "size 17.3205 mm, touch tolerance 1.73e-08 mm; no problems found\n",
        "",
    )


def test_a_saved_run_is_not_mistaken_for_a_scene(command: Command, sample: str) -> None:
    command("run", sample, "--out", "run.json")
    answer = command("run", "run.json")
    assert answer.code == 2
    assert "exact: is no known key" in answer.err
    with pytest.raises(RunFileError, match="is not JSON"):
        load_run(sample)
