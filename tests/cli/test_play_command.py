"""``cagepose play``: its document, its tables, what it refuses."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from cagepose import load_scene, play
from cagepose.cli.play_report import print_play
from rails import exact_tilt_deg

Command = Callable[..., Any]
RAIL = str(Path(__file__).resolve().parents[2] / "scenes" / "rail-pitch.yaml")


def test_the_document_of_the_rail(command: Command) -> None:
    answer = command("play", RAIL, "--at=-600,20,-60.747", "--direction=0,1,0", "--json")
    assert answer.code == 0
    document = json.loads(answer.out)
    assert list(document["freedoms"]) == ["x", "y", "z", "roll", "pitch", "yaw"]
    pitch = document["freedoms"]["pitch"]
    assert pitch["linear"] == pytest.approx([-math.degrees(0.5 / 91.5), math.degrees(0.5 / 91.5)], rel=1e-9)
    assert pitch["exact"] == pytest.approx([-exact_tilt_deg(1, 183), exact_tilt_deg(1, 183)], rel=1e-9)
    assert (pitch["reached"], pitch["status"]) == (pitch["exact"], ["local", "local"])
    assert document["freedoms"]["x"]["status"] == ["proven", "proven"]  # 1.001362, and certified within 1.006645
    assert pitch["certified"][0] < pitch["exact"][0] < pitch["exact"][1] < pitch["certified"][1]
    assert document["freedoms"]["z"]["linear"] == pytest.approx([-0.5, 0.5], rel=1e-9)
    (point,) = document["points"]
    assert (point["at"], point["direction"]) == ([-600, 20, -60.747], [0, 1, 0])
    assert point["linear"][1] == pytest.approx(600 * 0.53 / 91.5 + 60.747 * 0.5 / 31.55, rel=1e-9)
    assert document["cage"]["verdict"] == "caged"
    assert document["cage"]["free_directions"] == []
    assert document["cage"]["path"] is None
    (first, *_) = document["freedoms"]["z"]["limits"][1]
    assert first["gap"] == pytest.approx(0.5)
    assert 0 < first["closing"] <= 1


def test_a_scene_that_is_no_cage_gives_the_path_out_and_ends_with_0(command: Command, sample: str) -> None:
    answer = command("play", sample, "--json")
    assert answer.code == 0
    document = json.loads(answer.out)
    assert document["cage"]["verdict"] == "escapes"
    assert document["cage"]["path"][-1]["motion"] == "travel"
    assert document["freedoms"]["x"]["certified"] is None
    assert document["freedoms"]["z"]["linear"][1] is None  # nothing is above the block


def test_the_way_out_is_told_in_a_line(command: Command, sample: str) -> None:
    path = json.loads(command("play", sample, "--json").out)["cage"]["path"]
    (line,) = [line for line in command("play", sample).out.splitlines() if line.startswith("escape path: ")]
    assert line.count(" about (") + line.count(" along (") == len(path)
    assert line.endswith("; then no contact is ahead")


def test_the_tables_name_what_limits_each_end(command: Command) -> None:
    out = command("play", RAIL).out
    assert "-0.313084 to 0.313084" in out
    assert "cage: caged" in out
    assert "greatest x" in out
    (row,) = [line for line in out.splitlines() if line.startswith("least pitch")]
    halved_by_any_of_them = ["C1,", "C8,", "C6,", "C3", "0.3131", "0", "0.5", "mm"]
    assert row.split()[2:] == halved_by_any_of_them


def test_a_load_that_finds_no_rest_nearby_is_not_shown_at_one(command: Command, sample: str) -> None:
    (line,) = [line for line in command("play", sample).out.splitlines() if line.startswith("gravity ")]
    assert line.startswith("gravity finds no rest nearby; to first order")


def test_the_table_marks_ends_that_are_proven_and_those_that_are_not_found(capsys: pytest.CaptureFixture[str]) -> None:
    found = play(load_scene(RAIL))
    x, y = (found.freedoms[name] for name in ("x", "y"))
    y = replace(y, high=replace(y.high, status="not converged"))
    print_play(replace(found, freedoms={"x": x, "y": y}), (), "mm")
    printed = capsys.readouterr().out
    assert "-1.00136* to 1.00136*" in printed
    assert "-0.533663 to at least 0.533663" in printed
    assert y.high.exact is None


def test_a_point_far_from_the_object_is_refused(command: Command) -> None:
    answer = command("play", RAIL, "--at", "1e308,0,0")
    assert answer.code == 2
    assert "--at: is 1e+308 mm from the object's origin" in answer.err


def test_closing_and_opening_each_gap_of_the_rails_pitch_moves_it_as_the_document_says(command: Command) -> None:
    """Each roller is moved by 0.1 um: four limit the pitch, so closing any one tells, opening one alone does not."""
    pitch = json.loads(command("play", RAIL, "--json").out)["freedoms"]["pitch"]
    limits = pitch["limits"][1]
    assert {limit["point"] for limit in limits} == {"C2", "C4", "C5", "C7"}
    for limit in limits:
        index = int(limit["point"].removeprefix("C")) - 1
        height = -1.0 if index % 2 == 0 else 1.0
        for by, worth in ((-1e-4, limit["closing"]), (1e-4, limit["opening"])):
            moved = command("play", RAIL, f"--set=cage.points[{index}][2]={height * (1 + by)!r}", "--json")
            end = json.loads(moved.out)["freedoms"]["pitch"]["exact"][1]
            assert (end - pitch["exact"][1]) / by == pytest.approx(worth, abs=1e-3)


def test_the_rests_under_the_loads_are_in_the_document_and_the_report(command: Command) -> None:
    rests = json.loads(command("play", RAIL, "--json").out)["rests"]
    assert [rest["phase"] for rest in rests] == ["weight", "push"]
    assert list(rests[0]["undetermined"]) == ["y", "yaw"]
    assert rests[1]["exact_pose"]["euler_zyx_deg"] == pytest.approx([-0.3322, -0.2131, 0.0012], abs=5e-5)
    assert "push presses the object to" in command("play", RAIL).out


@pytest.mark.parametrize(
    ("flags", "message"),
    [
        (["--at=1,2"], "--at 1,2: is not three numbers"),
        (["--at=a,b,c"], "--at a,b,c: is not three numbers"),
        (["--at=1,2,nan"], "--at 1,2,nan: is not three numbers"),
        (["--at=1,2,3", "--direction=0,0,0"], "--direction 0,0,0: is the zero vector"),
        (["--direction=0,0,1"], "--direction: is for points, and there are none"),
    ],
)
def test_bad_flags_end_with_2(command: Command, flags: list[str], message: str) -> None:
    answer = command("play", RAIL, *flags)
    assert answer.code == 2
    assert answer.err.startswith(message)
    assert answer.out == ""


@pytest.mark.parametrize("kind", ["play", "extremes"])
def test_the_command_draws_the_play_of_a_scene_and_of_a_saved_run(command: Command, tmp_path: Path, kind: str) -> None:
    saved, picture = tmp_path / "run.json", tmp_path / "play.svg"
    assert command("run", RAIL, "--out", str(saved)).code == 0
    for source in (RAIL, str(saved)):
        answer = command("plot", source, "--kind", kind, "--out", str(picture))
        assert answer.code == 0
        assert "caged" in answer.out
        assert picture.read_text().startswith("<?xml")


def test_points_without_play_and_points_that_are_none_are_refused(command: Command, tmp_path: Path) -> None:
    answer = command("plot", RAIL, "--at=1,2", "--out", str(tmp_path / "a.png"))
    assert answer.code == 2
    assert answer.err.splitlines() == [
        "--at: says whose play is drawn; give --kind play with it",
        "--at 1,2: is not three numbers; write them as x,y,z without blanks",
    ]


@pytest.mark.parametrize("columns", [80, 150])
def test_the_ranges_of_freedoms_and_points_are_a_line_each(
    columns: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """No number is broken on a narrow screen, and a wide one shows more digits."""
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    for key, value in (("COLUMNS", str(columns)), ("LINES", "50"), ("TERM", "dumb")):
        monkeypatch.setenv(key, value)
    scene = load_scene(RAIL)
    print_play(play(scene, [(-0.6, 0.02, -0.0607)]), (), "mm")
    lines = [line.rstrip() for line in capsys.readouterr().out.splitlines()]
    assert max(map(len, lines)) <= columns
    pitch = "-0.3131 to 0.3131" if columns == 80 else "-0.313084 to 0.313084"
    assert any(re.match(rf"pitch +deg +\S+ to \S+ +{pitch} +\S+ to \S+$", line) for line in lines)
    assert any(re.match(r"point 1 along z +mm +\S+ to \S+ +\S+ to \S+ +\S+ to \S+$", line) for line in lines)
    assert "point 1: (-600, 20, -60.7) mm in the object's frame" in lines


def test_a_scene_of_rollers_has_play_without_bounds(command: Command) -> None:
    """0.5 mm of vertical play: 0.25 mm each way, and the pitch of (h + 2 rho + p) cos t - 2 a sin t = h + 2 rho."""
    rollers = str(Path(RAIL).with_name("rollers.yaml"))
    document = json.loads(command("play", rollers, "--json").out)
    assert document["freedoms"]["z"]["exact"] == pytest.approx([-0.25, 0.25], abs=1e-9)
    assert document["freedoms"]["z"]["linear"] == [None, None]
    assert document["freedoms"]["x"]["status"] == ["open", "open"]
    assert document["cage"]["verdict"] == "escapes"
    assert document["rests"] == []
    answer = command("play", rollers)
    assert answer.code == 0
    assert "linear" not in answer.out
    assert "certified" not in answer.out
    assert "escape path: no contact is ahead from the start" in answer.out


def test_seated_play_is_asked_of_a_phase(command: Command) -> None:
    dock = str(Path(RAIL).with_name("phone-dock.yaml"))
    document = json.loads(command("play", dock, "--seated", "--json").out)
    assert (document["seated"], document["cage"]) == ("weight", None)
    left, right = document["freedoms"]["x"]["exact"]
    assert left < -1 < 1 < right
    y = document["freedoms"]["y"]["exact"]
    assert y[1] - y[0] < 1e-3  # its back and the ledge hold it
    assert "play from the rest of weight" in command("play", dock, "--seated", "--phase", "weight").out


@pytest.mark.parametrize(
    ("arguments", "told"),
    [(("--phase", "weight"), "add --seated"), (("--seated", "--phase", "wind"), "phase: is 'wind', and the scene has")],
)
def test_a_seat_that_is_none_is_refused(command: Command, arguments: tuple[str, ...], told: str) -> None:
    answer = command("play", RAIL, *arguments)
    assert (answer.code, answer.out) == (2, "")
    assert told in answer.err
