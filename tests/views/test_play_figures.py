"""Pictures of play: what they show, and that they can be written."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.patches import Rectangle

from cagepose import load_scene, play
from cagepose.studies.play_outline import point_outlines
from cagepose.views.extreme_figure import extreme_figure
from cagepose.views.play_figure import play_figure

SCENES = Path(__file__).resolve().parents[2] / "scenes"
RAIL = str(SCENES / "rail-pitch.yaml")


def test_each_freedom_has_three_bars_that_end_where_the_play_does() -> None:
    found = play(load_scene(RAIL))
    figure = play_figure(found)
    bars = [patch for patch in figure.axes[0].patches if isinstance(patch, Rectangle)]
    assert len(bars) == 9
    ends = {round(bar.get_x() + bar.get_width(), 9) for bar in bars}
    high = found.freedoms["x"].high
    assert {round(value * 1e3, 9) for value in (high.linear, high.exact, high.certified)} <= ends


def test_an_open_end_is_an_arrow_and_no_bar_is_certified() -> None:
    figure = play_figure(play(load_scene(SCENES / "sample.yaml"), search_s=0.0), [(0, 0, 0)])
    bars = [patch for patch in figure.axes[0].patches if isinstance(patch, Rectangle)]
    assert len(bars) == 6
    assert any(line.get_marker() == ">" for line in figure.axes[0].lines)
    assert [text.get_text() for text in figure.axes[2].texts] == ["no end, or none found, in some directions"]


def test_the_certified_outline_holds_the_exact_one() -> None:
    for outline in point_outlines(load_scene(RAIL), np.array([-600, 20, -60.747]) * 1e-3):
        assert outline.exact is not None
        assert outline.certified is not None
        ends = np.roll(outline.certified, -1, axis=0)
        along = ends - outline.certified
        for corner in outline.exact:
            away = corner - outline.certified
            assert (along[:, 0] * away[:, 1] - along[:, 1] * away[:, 0] > 0).all()  # counter-clockwise: inside is left


def test_the_pose_of_each_end_is_drawn_with_the_points_that_limit_it() -> None:
    found = play(load_scene(RAIL))
    figure = extreme_figure(found)
    assert len(figure.axes) == 12
    assert figure.axes[9].get_title() == "greatest pitch: 0.3131 deg"
    named = {name for text in figure.axes[9].texts for name in text.get_text().split()}
    assert {clearance.point for clearance in found.freedoms["pitch"].high.clearances} == named
    assert any("motions drawn 20 times as large" in text.get_text() for text in figure.texts)
