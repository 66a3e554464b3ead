"""``cagepose play``: its document, its tables, what it refuses."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

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
    assert 0 < first["gain"] <= 1


def test_a_scene_that_is_no_cage_gives_the_path_out_and_ends_with_0(command: Command, sample: str) -> None:
    answer = command("play", sample, "--json")
    assert answer.code == 0
    document = json.loads(answer.out)
    assert document["cage"]["verdict"] == "escapes"
    assert document["cage"]["path"][-1]["motion"] == "travel"
    assert document["freedoms"]["x"]["certified"] is None
    assert document["freedoms"]["z"]["linear"][1] is None  # nothing is above the block


def test_the_tables_name_what_limits_each_end(command: Command) -> None:
    out = command("play", RAIL).out
    assert "-0.313084 to 0.313084" in out
    assert "cage: caged" in out
    assert "greatest x" in out
    assert "C13 on rack" in out


@pytest.mark.parametrize(
    ("flags", "message"),
    [
        (["--at=1,2"], "--at 1,2: is not three numbers"),
        (["--at=a,b,c"], "--at a,b,c: is not three numbers"),
        (["--at=1,2,nan"], "--at 1,2,nan: is not three numbers"),
        (["--at=1,2,3", "--direction=0,0,0"], "--direction 0,0,0: has no direction"),
        (["--direction=0,0,1"], "--direction: says where points go, and there are none"),
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
