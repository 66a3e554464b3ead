"""What `make bench` saves, and how it compares; no peer needs to be installed."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from bench import rail_table, scenes_table
from bench.growth_table import exponent
from bench.rail_case import EXACT_TILTS_RAD, SCENES, Answer, rail_scenes, tilt_error
from bench.rows import Row, save

PROMISED = {"scene", "engine", "median_s", "error", "ratio_to_ours", "settings"}


def turned_by(scene, tilt_rad):
    """The rail at a tilt relative to its rollers."""
    c, s = math.cos(tilt_rad), math.sin(tilt_rad)
    return scene.cage.pose_world_cage.rotation @ np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def test_a_saved_row_has_the_promised_keys_and_replaces_those_of_earlier_runs(tmp_path):
    path = tmp_path / "results.json"
    save([Row("rail", "rail, old", "old")], path)
    save([Row("rail", "rail, new", "mujoco", 1e-3, math.inf, 20.0, {"step_s": 0.01})], path)
    (row,) = json.loads(path.read_text(encoding="utf-8"))
    assert row.keys() >= PROMISED
    assert (row["scene"], row["engine"], row["error"]) == ("rail, new", "mujoco", "inf")
    assert [file.name for file in tmp_path.iterdir()] == ["results.json"]


def test_the_exact_tilts_have_no_error_and_a_lost_rail_an_infinite_one():
    scene = rail_scenes()[0]
    up, down = (turned_by(scene, tilt) for tilt in EXACT_TILTS_RAD)
    assert tilt_error(scene, (up, down)) < 1e-13
    assert tilt_error(scene, (up, up)) == pytest.approx(2.0)
    assert tilt_error(scene, (up,)) == math.inf
    assert tilt_error(scene, (up, np.full((3, 3), np.nan))) == math.inf


def test_an_engine_that_is_missing_becomes_a_row_that_says_so(monkeypatch):
    def missing(_scene, engine):
        raise ImportError(f"No module named {engine!r}")

    monkeypatch.setattr(rail_table, "PEERS", {"drake": missing})
    row = rail_table.peer_row(rail_scenes()[0], "drake")
    assert "rail" in row.scene
    assert (row.engine, row.median_s) == ("drake", None)
    assert "not installed" in row.skipped


def test_an_engine_is_measured_and_compared_with_the_slower_of_our_methods(monkeypatch):
    scene = rail_scenes()[0]
    answer = Answer(tuple(turned_by(scene, tilt) for tilt in EXACT_TILTS_RAD))
    monkeypatch.setattr(rail_table, "PEERS", {"fake": lambda *_: (lambda: answer, {"step_s": 1.0})})
    monkeypatch.setattr(rail_table, "rail_scenes", lambda: [scene])
    monkeypatch.setattr(rail_table.ours, "measure", lambda _scene, method, _budget_s: (OUR_TIMES_S[method], answer))
    rows = {row.engine: row for row in rail_table.rail_rows()}
    assert rows["cagepose-quasistatic"].ratio_to_ours == 1.0
    assert rows["cagepose-stepwise"].ratio_to_ours == 0.5
    assert rows["cagepose-stepwise"].details["cpu_ratio"] == pytest.approx(0.5)
    assert rows["fake"].error < 1e-13
    assert rows["fake"].settings == {"step_s": 1.0}
    assert rows["fake"].ratio_to_ours == pytest.approx(rows["fake"].median_s / 2.0)


OUR_TIMES_S = {
    "stepwise": {"": (1.0, 0.9), "-solve": (0.5, 0.5), "-call": (5.0, 4.0)},
    "quasistatic": {"": (2.0, 1.8), "-solve": (1.0, 1.0), "-call": (9.0, 8.0)},
}


def test_the_exponent_looks_at_the_upper_half():
    sizes = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0]
    assert exponent(sizes, [1.0, 1.0, 1.0, 64.0, 256.0, 1024.0]) == pytest.approx(2.0)


def test_every_scene_has_a_row_by_each_method_that_runs_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(scenes_table, "BUDGET_S", 0.001)
    rows = list(scenes_table.scene_rows())
    assert {row.scene for row in rows} == {path.stem for path in SCENES.glob("*.yaml")}
    assert {row.engine for row in rows if row.scene == "rail-yaw"} == {"cagepose-stepwise", "cagepose-quasistatic"}
    assert {row.engine for row in rows if row.scene == "rollers"} == {"cagepose-quasistatic"}
