"""Shapes in matplotlib's pictures: where they are, marked where they touch, and none of it beyond the panel's block."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from cagepose import Scene, run
from cagepose.views.event_figure import event_figure
from cagepose.views.pose_figure import pose_figure
from cagepose.views.solid_drawing import _cut_face, _cut_line
from cagepose.views.style import figure_bytes
from shaped_scenes import ball_on_points, ball_on_table, bar_between_bars, block_on_balls

SCENES = [ball_on_table, ball_on_points, bar_between_bars, block_on_balls]


@pytest.mark.parametrize("scene", SCENES)
def test_contacts_are_marked_and_named_where_the_run_has_them(scene: Callable[[], Scene]) -> None:
    found = run(scene())
    figure = event_figure(found)
    *_, last, view = figure.axes
    marks = {
        tuple(place)
        for line in last.lines
        if line.get_marker() == "o"
        for place in np.round(np.array(line.get_data_3d()).T, 3).tolist()
    }
    seen_along = {tuple(np.round([line.get_xdata()[0], line.get_ydata()[0]], 3)) for line in view.lines}
    for contact in found.contacts:
        place = np.round(contact.place_world * 1000.0, 3) + 0.0
        assert tuple(place) in marks
        assert tuple(place[:2]) in seen_along
    for panel in (last, view):
        named = {name for text in panel.texts for name in text.get_text().split()}
        assert {contact.point for contact in found.contacts} <= named
    assert view.get_title().endswith("support not known")


@pytest.mark.parametrize("scene", SCENES)
def test_no_body_is_drawn_beyond_the_panel_and_none_shows_its_triangles(scene: Callable[[], Scene]) -> None:
    """The table of 400 mm is cut off at what is shown of it; what is round has a polygon for each of few tints."""
    for panel in event_figure(run(scene())).axes:
        if not hasattr(panel, "get_zlim"):
            continue
        low, high = np.array([panel.get_xlim(), panel.get_ylim(), panel.get_zlim()]).T
        for faces in (of for of in panel.collections if isinstance(of, Poly3DCollection)):
            places = faces._faces[np.logical_not(np.broadcast_to(faces._invalid_vertices, faces._faces.shape[:2]))]
            assert (places >= low).all()
            assert (places <= high).all()
            assert len(faces._faces) <= 40


@pytest.mark.parametrize("scene", SCENES)
def test_all_kinds_of_pictures_can_be_written(scene: Callable[[], Scene]) -> None:
    found = run(scene())
    assert len(figure_bytes(event_figure(found), ".svg")) < 400_000
    assert len(figure_bytes(pose_figure(found), ".png")) > 10_000


def test_faces_and_lines_are_cut_at_a_block() -> None:
    low, high = np.zeros(3), np.ones(3)
    square = np.array([[-1.0, -1, 0.5], [3, -1, 0.5], [3, 3, 0.5], [-1, 3, 0.5]])
    cut = _cut_face(square, low, high)
    assert {tuple(corner) for corner in cut.tolist()} == {(0, 0, 0.5), (1, 0, 0.5), (1, 1, 0.5), (0, 1, 0.5)}
    assert len(_cut_face(square + np.array([0, 0, 1]), low, high)) == 0
    assert _cut_line(np.array([[-1.0, 0.5, 0.5], [3.0, 0.5, 0.5]]), low, high).tolist() == [
        [0, 0.5, 0.5],
        [1, 0.5, 0.5],
    ]
    assert len(_cut_line(np.array([[-1.0, 2.0, 0.5], [3.0, 2.0, 0.5]]), low, high)) == 0
