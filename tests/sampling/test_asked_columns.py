"""Questions asked of each run of a study: their answers are columns, and those of the functions to the last bit."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cagepose import SceneFileError, friction_limits, jam, load_scene, margin, play, run
from cagepose.files.units import from_metres
from cagepose.questions.friction import FrictionLimits
from cagepose.questions.jam import Jam
from cagepose.questions.unanswered import Unanswered
from cagepose.sampling import runner
from cagepose.sampling.findings import findings_of
from our_scenes import SCENES
from our_studies import RAIL, RunStudy, rows_of

DRAWER, PEG = (path for name in ("drawer-jams", "peg-in-hole") for path in SCENES if path.stem == name)
ALL = ["friction", "margin", "jam", "play"]
COEFFICIENT: dict[str, Any] = {"friction.coefficient": {"uniform": [0.1, 0.3]}}


@pytest.mark.parametrize(
    ("scene", "asked"), [(RAIL, ["play", "friction", "margin"]), (DRAWER, ALL)], ids=["rail", "drawer"]
)
def test_answers_are_those_of_the_questions_to_the_last_bit(run_study: RunStudy, scene: Path, asked: list[str]) -> None:
    results = run_study(COEFFICIENT, 2, scene=scene, ask=asked)
    n_answered = 0
    for row in results.table().to_pylist():
        key = "friction.coefficient"
        alone = run(load_scene(scene, [f"{key}={row[key]!r}"]))
        friction, force = friction_limits(alone), margin(alone)
        if isinstance(friction, FrictionLimits):
            assert row["friction_balance"] == friction.balance
            assert row["friction_no_motion"] == (friction.no_motion[0].shown_from if friction.no_motion else None)
            n_answered += 1
        else:
            assert (row["friction_balance"], row["friction_no_motion"]) == (None, None)
        assert row["margin_force"] == (None if force is None else force.force_n)
        assert row["margin_moment"] == (None if force is None else float(from_metres(force.moment_nm, "mm")))
        if "jam" in asked:
            jams = jam(alone)
            assert isinstance(jams, Jam)
            assert row["jam_friction"] == jams.friction
        for place, (name, ends) in enumerate(play(alone.scene, search_s=0.0).freedoms.items()):
            for side, end, sign in (("low", ends.low, -1), ("high", ends.high, 1)):
                found = row[f"play_{name}_{side}"] if place < 3 else row[f"play_{name}_deg_{side}"]
                if end.is_open:
                    assert found == sign * math.inf
                elif end.exact is None:
                    assert found is None
                else:
                    assert found == float(from_metres(end.exact, "mm") if place < 3 else np.degrees(end.exact))
    assert n_answered == 2


def test_what_has_no_answer_is_empty_and_no_failure(run_study: RunStudy) -> None:
    varied = {"friction.coefficient": {"grid": [-0.1, 0.2]}}
    refused, found = run_study(varied, method="grid", scene=PEG, ask=["jam", "friction"]).table().to_pylist()
    assert (refused["verdict"], refused["jam_friction"], refused["friction_balance"]) == ("refused", None, None)
    plain = jam(run(load_scene(PEG, ["friction.coefficient=0.2"])))
    assert isinstance(plain, Unanswered)
    assert (found["verdict"], found["error"], found["jam_friction"]) == (run(load_scene(PEG)).verdict, None, None)


def test_answers_can_be_computed_with_and_accepted(run_study: RunStudy) -> None:
    given: dict[str, Any] = {"compute": {"spare": "friction.coefficient - friction.balance"}, "accept": "spare > 0.1"}
    rows = run_study(COEFFICIENT, 4, ask=["friction"], **given).table().to_pylist()
    assert [row["spare"] for row in rows] == [row["friction.coefficient"] - row["friction_balance"] for row in rows]
    assert [row["accepted"] for row in rows] == [row["spare"] > 0.1 for row in rows]


def test_the_table_is_the_same_whatever_the_workers_and_in_parts(
    run_study: RunStudy, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = rows_of(run_study(COEFFICIENT, 6, ask=["margin", "friction"], folder="whole"))
    monkeypatch.setattr(runner, "FEW_ROWS", 1)
    monkeypatch.setattr(runner, "ROWS_OF_A_TASK", 2)
    assert rows_of(run_study(COEFFICIENT, 6, ask=["margin", "friction"], folder="shared", workers=2)) == whole
    monkeypatch.setattr(runner, "ROWS_ONE_BY_ONE", 4)
    results = run_study(COEFFICIENT, 6, ask=["margin", "friction"], folder="parts")
    assert rows_of(results) == whole
    first, *_ = sorted((results.folder.path / "parts").iterdir())
    first.unlink()
    assert rows_of(run_study(COEFFICIENT, 6, ask=["margin", "friction"], folder="parts", resume=True)) == whole


@pytest.mark.usefixtures("no_pictures", "small_designs")
def test_the_report_takes_empty_and_endless_answers(run_study: RunStudy) -> None:
    findings = findings_of(run_study(COEFFICIENT, 4, ask=["friction", "play"]))
    assert {"friction_balance", "play_x_low"} <= set(findings.statistics.spreads)
    for name, spread in findings.statistics.spreads.items():
        assert spread.n == 0 or math.isfinite(spread.mean), name


def test_only_what_is_asked_is_a_column(run_study: RunStudy) -> None:
    assert not [name for name in run_study(COEFFICIENT, 1).columns.names if name.startswith(("friction_", "margin_"))]
    names = run_study(COEFFICIENT, 1, ask=["margin"], folder="asked").columns.names
    assert [name for name in names if name.startswith(("friction_", "margin_"))] == ["margin_force", "margin_moment"]


def test_a_question_that_there_is_not_or_that_is_asked_twice_is_told(run_study: RunStudy) -> None:
    with pytest.raises(SceneFileError, match=r"ask\[0\].*margins"):
        run_study(COEFFICIENT, 1, ask=["margins"])
    with pytest.raises(SceneFileError, match="holds a question twice; ask each once"):
        run_study(COEFFICIENT, 1, ask=["jam", "jam"])


def test_in_a_plane_play_has_columns_of_its_freedoms_alone(run_study: RunStudy, tmp_path: Path) -> None:
    scene = tmp_path / "slot.yaml"
    scene.write_text("""\
name: slot
units: {length: mm}
planar: xz
object: {shapes: [{box: {size: [20, 10, 40]}}], pose: {position: [0, 0, 20.01]}, mass: 1}
cage: {points: {A: [-9, 0, 0], B: [9, 0, 0], L: [-11, 0, 30], R: [11, 0, 30], M: [-11, 0, 5], N: [11, 0, 5]}}
loads: [{name: weight, gravity: [0, 0, -1]}]
""")
    (row,) = run_study({"object.mass": {"grid": [1.0]}}, method="grid", scene=scene, ask=["play"]).table().to_pylist()
    found = {name: value for name, value in row.items() if name.startswith("play_")}
    ends = play(load_scene(scene), search_s=0.0).freedoms
    assert list(found) == [
        *(f"play_{name}_{side}" for name in "xz" for side in ("low", "high")),
        *(f"play_pitch_deg_{side}" for side in ("low", "high")),
    ]
    assert (found["play_x_low"], found["play_x_high"]) == pytest.approx((-1.0, 1.0), abs=1e-9)
    assert found["play_z_high"] == math.inf
    low, high = ends["pitch"].low.exact, ends["pitch"].high.exact
    assert (low, high) != (None, None)
    assert (found["play_pitch_deg_low"], found["play_pitch_deg_high"]) == (np.degrees(low), np.degrees(high))


def test_a_play_without_end_in_all_rows_is_in_the_report(run_study: RunStudy, tmp_path: Path) -> None:
    """Warnings are errors here: of infinite ends no difference is told."""
    scene = tmp_path / "board.yaml"
    scene.write_text("""\
name: board
units: {length: mm}
planar: xz
object: {shapes: [{box: {size: [80, 30, 6]}}], pose: {position: [0, 0, 4]}, mass: 1}
cage:
  shapes: [{name: floor, box: {size: [120, 30, 4]}, position: [0, 0, -2]}]
loads: [{name: weight, gravity: [0, 0, -1]}]
""")
    vary = {"cage.shapes[0].position[2]": {"normal": {"sigma": 0.1}}}
    results = run_study(vary, 4, scene=scene, ask=["play"])
    (row,) = [one for one in findings_of(results).tolerances if one.name == "play_z_high"]
    assert row.nominal == math.inf
