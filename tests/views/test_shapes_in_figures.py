"""Shapes in matplotlib's pictures: where they are, marked where they touch."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from cagepose import Scene, run
from cagepose.views.event_figure import event_figure
from cagepose.views.pose_figure import pose_figure
from cagepose.views.style import figure_bytes
from shaped_scenes import ball_on_points, ball_on_table, bar_between_bars, block_on_balls

SCENES = [ball_on_table, ball_on_points, bar_between_bars, block_on_balls]


@pytest.mark.parametrize("scene", SCENES)
def test_seen_along_the_weight_contacts_are_where_the_run_has_them(scene: Callable[[], Scene]) -> None:
    found = run(scene())
    figure = event_figure(found)
    view = figure.axes[-1]
    seen_along = {tuple(np.round([line.get_xdata()[0], line.get_ydata()[0]], 3)) for line in view.lines}
    for contact in found.contacts:
        assert tuple((np.round(contact.place_world * 1000.0, 3) + 0.0)[:2]) in seen_along
    named = {name for text in view.texts for name in text.get_text().split()}
    assert {contact.point for contact in found.contacts} <= named
    assert "support" in view.get_title()
    assert "not known" not in view.get_title()


@pytest.mark.parametrize("scene", SCENES)
def test_all_kinds_of_pictures_can_be_written(scene: Callable[[], Scene]) -> None:
    found = run(scene())
    assert len(figure_bytes(event_figure(found), ".svg")) < 900_000
    assert len(figure_bytes(pose_figure(found), ".png")) > 10_000
