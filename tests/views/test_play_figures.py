"""Pictures of play: what they show, and that they can be written."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.patches import Rectangle

from cagepose import Box, Cage, Load, Object, Pose, Scene, load_scene, play
from cagepose.studies.play_outline import point_outlines
from cagepose.views.extreme_figure import PICTURE, extreme_figure
from cagepose.views.play_figure import play_figure
from cagepose.views.solids import outer_points
from cagepose.views.viewer.caption import LOUD_INK
from cagepose.views.viewer.picture import PictureMaker
from cagepose.views.viewer.playback import single_motion
from cagepose.views.viewer.stage import Stage

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
    below = figure.axes[3]  # x and z
    assert below.get_title() == "unlimited along the arrows"
    assert len(below.texts) == 24  # as many directions, all open
    assert min(below.get_xlim()[1], below.get_ylim()[1]) > 1.0  # not the few hundredths of an empty picture


def test_an_outline_with_ends_on_some_sides_shows_these_and_the_others_as_open() -> None:
    """A plate on three points: it may go anywhere along them and up, and down by as much as it is above them."""
    scene = Scene(
        Object([Box((0.1, 0.08, 0.02))], pose=Pose((0, 0, 0.013))),
        Cage([(0.03, 0.03, 0), (-0.03, 0.03, 0), (0.0, -0.03, 0)]),
        [Load("weight", gravity=(0, 0, -1))],
    )
    xy, xz, _ = point_outlines(scene, (0, 0, -0.01))
    assert len(xy.no_end) == 24
    assert len(xz.no_end) == 13  # sideways, and all that goes up
    assert xz.no_end[:, 1].min() > -1e-9
    assert xz.linear[:, 1].min() == xz.exact[:, 1].min() == pytest.approx(-0.003, rel=1e-6)
    assert xz.shown_m is not None
    assert np.abs(xz.exact).max() > 2 * xz.shown_m  # cut off where nobody sees it
    panel = play_figure(play(scene, search_s=0.0), [(0, 0, -0.01)]).axes[3]
    assert len(panel.texts) == len(xz.no_end)


def test_the_certified_outline_holds_the_exact_one() -> None:
    for outline in point_outlines(load_scene(RAIL), np.array([-600, 20, -60.747]) * 1e-3):
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
    end = found.freedoms["pitch"].high
    limits = tuple(clearance.point for clearance in end.clearances)
    assert end.pose_world_object is not None
    film = single_motion(found.scene, end.pose_world_object, limits, "mm")
    maker = PictureMaker(Stage(film), size=PICTURE)
    drawn = np.asarray(maker.picture(film.shots[-1]))
    assert np.array_equal(figure.axes[9].images[0].get_array(), drawn)
    assert {label.text for label in maker.labels if label.ink == LOUD_INK} == set(limits)
    assert maker.now.factor == 20.0
    assert "exaggerated" in figure.get_supxlabel()


def test_what_sticks_out_of_its_cage_is_not_cut() -> None:
    """A bar of 100 mm in a ring of points 40 mm wide."""
    bar = Object([Box((0.1, 0.01, 0.01))])
    points = [(x, y, z) for x in (-0.02, 0.02) for y, z in ((0.006, 0), (-0.006, 0), (0, 0.006), (0, -0.006))]
    scene = Scene(bar, Cage(points), [Load("weight", gravity=(0, 0, -1))])
    end = play(scene).freedoms["y"].high
    film = single_motion(scene, end.pose_world_object, (), "mm")
    maker = PictureMaker(Stage(film), size=PICTURE)
    maker.picture(film.shots[-1])
    shown = maker.stage.pose(film.shots[-1].pose_world_object, maker.now)
    pixels = maker.seen_at(maker.stage.place(shown.transform(outer_points(bar))))
    assert ((pixels > 0.0) & (pixels < PICTURE)).all()
