"""The plate with faceted holes stands for the one with round holes, to what its facets leave out."""

from __future__ import annotations

import math

import numpy as np
import pytest

from bench.rail_case import SCENES
from bench.shapes_table import BOXES_A_HOLE, shape_rows, with_faceted_holes
from cagepose import load_scene, run


def test_faceted_holes_touch_the_round_ones_from_outside():
    scene = load_scene(SCENES / "plate-on-pins.yaml")
    faceted = with_faceted_holes(scene)
    assert len(faceted.object.boxes) == 2 * BOXES_A_HOLE + 3
    round_end, end = run(scene), run(faceted)
    sagitta_m = scene.object.holes[0].radius_m * (1.0 / math.cos(math.pi / BOXES_A_HOLE) - 1.0)
    assert (round_end.verdict, end.verdict) == ("rests", "rests")
    away_m = np.linalg.norm(end.pose.position_m - round_end.pose.position_m)
    assert 0.0 < away_m < 2.0 * sagitta_m


def test_every_scene_of_the_table_is_measured_beside_mujoco(monkeypatch):
    pytest.importorskip("mujoco")
    monkeypatch.setattr("bench.shapes_table.BUDGET_S", 0.01)
    rows = list(shape_rows())
    assert len({row.scene for row in rows}) == 4
    beside = [row for row in rows if row.engine == "mujoco"]
    assert len(beside) == 4
    for row in beside:
        assert row.ratio_to_ours > 1.0
        assert row.details["apart"] < 20.0 * row.details["penetration"] + 5e-4
