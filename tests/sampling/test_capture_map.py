"""The capture map: against the whole grid, single runs, trying all boxes, and the paper's closed formula."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cagepose import SceneFileError, Study, StudyResults, run
from cagepose.files.scene_edit import with_values
from cagepose.files.study_file import parse_study, study_text
from cagepose.paper.planar import play_angle_rad, small_play_angle_rad
from cagepose.sampling import capture_map
from cagepose.sampling.capture_map import capture_maps, largest_box, refined_map
from cagepose.sampling.distribution import distribution_of
from cagepose.sampling.row_columns import RowColumns
from cagepose.sampling.runner import Runner
from our_studies import RAIL, RunStudy

HEIGHTS = {"cage.pose.position[2]": {"normal": {"sigma": 0.1}}, "object.pose.position[0]": {"uniform": [-0.05, 0.05]}}


def test_the_largest_box_is_that_of_trying_all() -> None:
    rng = np.random.default_rng(7)
    for _ in range(60):
        shape = tuple(rng.integers(1, 7, 2))
        good = rng.random(shape) < 0.75
        row, column = int(rng.integers(shape[0])), int(rng.integers(shape[1]))
        areas = {
            (bottom, top, left, right): (top - bottom + 1) * (right - left + 1)
            for bottom in range(row + 1)
            for top in range(row, shape[0])
            for left in range(column + 1)
            for right in range(column, shape[1])
            if good[bottom : top + 1, left : right + 1].all()
        }
        found = largest_box(good, row, column)
        assert (found is None) == (not good[row, column])
        if found is not None:
            assert areas[found] == max(areas.values())


def _look_up(whole: np.ndarray, times_asked: np.ndarray, rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
    np.add.at(times_asked, (rows, columns), 1)
    return whole[rows, columns]


def test_a_refined_map_is_the_whole_grid_by_few_runs() -> None:
    """Rings, wedges and steps in random places, none of them narrower than a block of the first lattice."""
    rng = np.random.default_rng(8)
    for count in (2, 3, 61, 130, 500, 1000):
        for _ in range(3):
            x, y = np.meshgrid(np.linspace(-1, 1, count), np.linspace(-1, 1, count))
            a, b, c, d = rng.uniform(-0.5, 0.5, 4)
            radius = np.hypot(x - a, y - b)
            whole = (radius < 0.7).astype(int) + 2 * (radius < 0.4) + 4 * (y > c + 2.0 * d * x + 0.2 * np.sin(5.0 * x))
            times_asked = np.zeros(whole.shape, int)
            found, n_runs = refined_map(count, partial(_look_up, whole, times_asked))
            assert np.array_equal(found, whole)
            assert n_runs == times_asked.sum()
            assert times_asked.max() == 1
            assert n_runs <= (0.1 * count**2 if count == 1000 else count**2)


def test_a_refined_map_of_a_rail_is_its_whole_grid(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, cases: Callable[[int, int], int]
) -> None:
    """Cell by cell: from which pitch and yaw the push, by the paper's rules, takes the rail past level."""
    count, keys, scene = cases(150, 1_000), ["parameters.pitch", "parameters.yaw"], tmp_path / "scene.yaml"
    text = (RAIL.parent / "studies" / "rail.yaml").read_text(encoding="utf-8")
    scene.write_text(with_values(text, {("method",): "stepwise"}), encoding="utf-8")
    accept = "pitch_deg < 0 and abs(yaw_deg) < 0.3"
    content: dict[str, Any] = {"scene": str(scene), "vary": {key: {"uniform": [-0.5, 0.5]} for key in keys}}
    content |= {"sample": {"runs": 1}, "accept": accept, "map": {"over": keys, "count": count}}
    study = parse_study(study_text(content))
    assert study.model.map
    asked = Runner(study), RowColumns(study), [distribution_of(one) for one in study.varied], study.model.map
    (refined,) = capture_maps(*asked)
    monkeypatch.setattr(capture_map, "LINES_OF_SIDE", count)
    (whole,) = capture_maps(*asked)
    assert whole.n_runs == count**2
    assert refined.n_runs < count**2 / (10 if count == 1_000 else 2)
    assert 0.1 < whole.accepted.mean() < 0.9
    assert np.array_equal(refined.accepted, whole.accepted)
    assert np.array_equal(refined.verdicts, whole.verdicts)
    assert refined.box == whole.box
    assert len(whole.lattice) == count > len(refined.lattice) >= 4
    for name, ends in whole.quantities.items():
        assert np.array_equal(refined.quantities[name], ends[np.ix_(refined.lattice, refined.lattice)], equal_nan=True)


@pytest.mark.usefixtures("small_designs")
def test_the_capture_map_says_what_each_of_its_runs_does(run_study: RunStudy, tmp_path: Path) -> None:
    keys = ["cage.pose.euler_zyx_deg[1]", "cage.points[0][2]"]
    vary = {
        "friction.coefficient": {"uniform": [0.0, 0.2]},
        keys[0]: {"uniform": [-0.3, 0.5]},
        keys[1]: {"uniform": [-1.2, -0.3]},
    }
    accept = "verdict == 'rests' and abs(pitch_deg) < 0.3"
    numbers = run_study(vary, 50, map={"over": keys, "count": 12}, accept=accept).report()
    found = numbers["maps"][0]
    assert found["over"] == keys
    assert found["verdicts"] == ["refused", "rests"]
    assert (tmp_path / "out" / "ends.svg").exists()
    study = StudyResults(tmp_path / "out").study
    for up in (0, 5, 11):
        for across in (0, 6, 11):
            numbers_there = {keys[0]: found["across"][across], keys[1]: found["up"][up], "friction.coefficient": 0.1}
            paths = {one.path: numbers_there[one.key] for one in study.varied}
            if found["verdicts"][found["verdict_cells"][up][across]] == "refused":
                assert not found["accepted_cells"][up][across]
                assert found["ends"]["pitch_deg"][up][across] is None
                continue
            ended = run(study.scene_text.scene_with(paths).scene)
            pitch = math.degrees(ended.pose.euler_zyx[1])
            assert found["accepted_cells"][up][across] == (ended.verdict == "rests" and abs(pitch) < 0.3)
            assert found["ends"]["pitch_deg"][up][across] == pytest.approx(pitch, abs=1e-12)


@pytest.mark.usefixtures("small_designs", "no_pictures")
def test_a_number_with_one_value_has_no_side_of_the_map(peg: Path) -> None:
    one, *others = {"cage.pose.position[1]": {"grid": [0.1]}, **HEIGHTS}.items()
    with pytest.raises(SceneFileError, match=r"map\.over\[0\]: is .*, which does not vary; use some of: cage"):
        Study(peg, dict([one, *others]), {"runs": 8}, map={"over": [one[0], others[0][0]]})


@pytest.mark.usefixtures("small_designs", "no_pictures")
@pytest.mark.parametrize("low", [-0.1, 0.1])
def test_a_box_of_permitted_values_is_about_nominal_ones_that_are_on_the_map(
    run_study: RunStudy, peg: Path, low: float
) -> None:
    vary = {"cage.pose.position[2]": {"uniform": [low, 0.2]}, "cage.pose.position[0]": {"uniform": [-0.1, 0.1]}}
    found = run_study(vary, 20, scene=peg, map={"over": list(vary), "count": 8}).report()["maps"][0]
    assert sum(map(sum, found["accepted_cells"])) == found["runs"] == 64
    assert found["box"] == ([[low, 0.2], [-0.1, 0.1]] if low < 0.0 else None)


@pytest.mark.usefixtures("small_designs", "no_pictures")
@pytest.mark.parametrize("phase", ["weight", "push"])
def test_the_capture_boundary_of_the_planar_rail_is_that_of_the_closed_formula(
    run_study: RunStudy, tmp_path: Path, phase: str
) -> None:
    """The paper's (Rq.2): the rail can come level while the mechanism is out of line by no more than the play angle t.

    The weight tilts it by t one way, the push by t the other way; it passes level if it ends beyond.
    """
    text = (RAIL.parent / "studies" / "rail.yaml").read_text(encoding="utf-8")
    loads = {"weight": {"gravity": [0, 0, -1]}, "push": {"force": {"direction": [1, 0, 0], "at": [-600, 0, -60.747]}}}
    names = ["weight", "push"] if phase == "push" else ["weight"]
    changes: dict[tuple[str | int, ...], object] = {("loads",): [{"name": name, **loads[name]} for name in names]}
    (tmp_path / "scene.yaml").write_text(with_values(text, {**changes, ("parameters", "pitch"): 0.0}), encoding="utf-8")
    keys = ["parameters.pitch", "parameters.play"]
    vary = {keys[0]: {"uniform": [-0.5, 0.5]}, keys[1]: {"uniform": [0.2, 1.5]}}
    numbers = run_study(
        vary, 16, scene=tmp_path / "scene.yaml", map={"over": keys, "count": 60},
        accept=f"verdict == 'rests' and pitch_deg {'>' if phase == 'weight' else '<'} 0",
    ).report()  # fmt: skip
    (found,) = numbers["maps"]
    accepted, pitches = np.array(found["accepted_cells"], dtype=bool), np.array(found["across"])
    for row, play in zip(accepted, found["up"], strict=True):
        limit = math.degrees(play_angle_rad((1.0 + play) * 1e-3, 1e-3, 0.183))
        assert limit == pytest.approx(math.degrees(small_play_angle_rad((1.0 + play) * 1e-3, 1e-3, 0.183)), rel=1e-3)
        assert np.array_equal(row, pitches > -limit if phase == "weight" else pitches < limit)


@pytest.mark.usefixtures("small_designs", "no_pictures")
@pytest.mark.parametrize(
    ("friction", "values"),
    [({"uniform": [0.0, 0.3]}, [0.0, 0.1, 0.2, 0.3]), ({"grid": [0.0, 0.2]}, [0.0, 0.2]),
     ({"steps": {"first": 0, "last": 1.6, "count": 17}}, [0.0, 0.2, 0.4, 0.6, 0.8, 1.0, 1.2, 1.4, 1.6])],
)  # fmt: skip
def test_a_third_number_makes_a_map_for_each_of_a_few_values(
    run_study: RunStudy, tmp_path: Path, friction: dict[str, Any], values: list[float]
) -> None:
    keys = ["parameters.pitch", "parameters.yaw", "friction.coefficient"]
    vary = {**{key: {"uniform": [-0.4, 0.4]} for key in keys[:2]}, keys[2]: friction}
    accept = "abs(yaw_deg) < 0.3 and verdict == 'rests'"
    scene = RAIL.parent / "studies" / "rail.yaml"
    maps = run_study(vary, 16, scene=scene, map={"over": keys, "count": 4}, accept=accept).report()["maps"]
    assert [one["layer"][keys[2]] for one in maps] == pytest.approx(values)
    study = StudyResults(tmp_path / "out").study
    paths = {one.key: one.path for one in study.varied}
    for one in maps[:3]:
        assert (one["over"], one["ends_at"]) == (keys[:2], [0, 1, 2, 3])
        for up in range(4):
            numbers = {keys[0]: one["across"][2], keys[1]: one["up"][up], keys[2]: one["layer"][keys[2]]}
            ended = run(study.scene_text.scene_with({paths[key]: value for key, value in numbers.items()}).scene)
            assert one["verdicts"][one["verdict_cells"][up][2]] == ended.verdict
            yaw = math.degrees(ended.pose.euler_zyx[0]) if ended.verdict == "rests" else None
            assert one["ends"]["yaw_deg"][up][2] == (yaw if yaw is None else pytest.approx(yaw, abs=1e-12))
            good = abs(math.degrees(ended.pose.euler_zyx[0])) < 0.3 and ended.verdict == "rests"
            assert one["accepted_cells"][up][2] == good
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert page.count("At <code>friction.coefficient</code>") == len(values)
