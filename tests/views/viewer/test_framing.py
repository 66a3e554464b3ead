"""What a picture begins with: what moves and touches, and an inset that shows where that is in the whole."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import ImageColor

from cagepose import load_scene, run
from cagepose.views.solids import outer_points
from cagepose.views.viewer.framing import MOVED, MUCH_CAGE, MUCH_OBJECT, ROOM, frame_of
from cagepose.views.viewer.inset import BORDER
from cagepose.views.viewer.page import page
from cagepose.views.viewer.picture import SIZE, PictureMaker
from cagepose.views.viewer.playback import Playback, playback
from cagepose.views.viewer.stage import Stage
from driving import set_range, state, wait_until

SCENES = Path(__file__).resolve().parents[3] / "scenes"
NOTHING = np.zeros((0, 3))


def film(name: str) -> Playback:
    return playback(run(load_scene(SCENES / f"{name}.yaml")), shots_per_motion=4)


@pytest.fixture
def opened(watched, tmp_path) -> Callable:
    def open_page(shown: Playback):
        file = tmp_path / "run.html"
        file.write_text(page(shown), encoding="utf-8")
        watched.page.set_viewport_size({"width": 1440, "height": 900})
        watched.page.goto(file.as_uri())
        wait_until(watched.page, "cagepose.state().drawn > 0")
        return watched.page

    return open_page


def bar(length: float, at: float = 0.0) -> np.ndarray:
    """The ends of a bar along x, 0.1 wide."""
    return np.array([(x, y, 0.0) for x in (at - length / 2.0, at + length / 2.0) for y in (-0.05, 0.05)])


def test_of_a_long_bar_that_hardly_moves_only_what_is_near_its_contacts_must_be_seen():
    contacts = bar(0.2)
    assert frame_of(contacts, [bar(0.19 * MUCH_OBJECT)] * 2, NOTHING, NOTHING) is None
    frame = frame_of(contacts, [bar(0.21 * MUCH_OBJECT)] * 2, NOTHING, NOTHING)
    assert frame is not None
    assert [frame.low[0], frame.high[0]] == pytest.approx([-0.1 - ROOM * 0.2 - 0.02, 0.1 + ROOM * 0.2 + 0.02], abs=1e-9)


def test_one_that_moves_far_is_seen_as_a_whole():
    long = 0.25 * MUCH_OBJECT
    stands, goes = ([bar(long), bar(long, way * MOVED * long)] for way in (0.9, 1.5))
    assert frame_of(bar(0.1), stands, NOTHING, NOTHING) is not None
    assert frame_of(bar(0.1), goes, NOTHING, NOTHING) is None


def test_of_a_large_cage_only_what_is_near_the_object_must_be_seen_but_all_that_is_driven():
    held = [bar(0.2)] * 2
    table = bar(0.22 * MUCH_CAGE)
    assert frame_of(bar(0.2), held, NOTHING, bar(0.18 * MUCH_CAGE)) is None
    frame = frame_of(bar(0.2), held, NOTHING, table)
    assert frame is not None
    assert frame.high[0] < table[:, 0].max()
    assert frame_of(bar(0.2), held, table, table) is None


@pytest.mark.parametrize(
    ("name", "is_part"), [("rail-pitch", True), ("planks", True), ("drawer", False), ("chuck", False)]
)
def test_the_page_and_the_picture_have_the_same_frame(opened, name, is_part):
    shown = film(name)
    maker, tab = PictureMaker(Stage(shown)), opened(shown)
    on_page = state(tab)["frame"]
    assert (maker.frame is not None) == is_part == (on_page is not None)
    assert (state(tab)["inset"] is not None) == is_part
    if maker.frame is not None:
        assert np.array(on_page) == pytest.approx(np.stack(maker.frame), abs=1e-9)


def test_a_page_of_the_rail_opens_on_its_rollers_and_the_inset_shows_all_of_it(opened):
    shown = film("rail-pitch")
    tab, stage = opened(shown), Stage(shown)
    width, height = tab.evaluate("[scene.clientWidth, scene.clientHeight]")

    def seen(places: np.ndarray) -> np.ndarray:
        return np.array(tab.evaluate("(places) => places.map(cagepose.project)", places.tolist()))

    rollers = np.array(state(tab)["touches"])
    ends = stage.place(shown.shots[-1].pose_world_object.transform(outer_points(shown.scene.object)))
    assert np.ptp(seen(rollers)[:, 0]) > 0.3 * width
    assert not ((seen(ends) > 0.0) & (seen(ends) < [width, height])).all()
    left, upper = state(tab)["inset"]["corner"]
    for name in state(tab)["written"]:
        assert name["corner"][0] + name["size"][0] <= left or name["corner"][1] + name["size"][1] <= upper
    tab.locator("#whole").click()
    wait_until(tab, "cagepose.state().inset === null")
    assert ((seen(ends) > 0.0) & (seen(ends) < [width, height])).all()
    assert tab.locator("#whole").is_hidden()
    tab.get_by_role("button", name="corner").click()
    wait_until(tab, "cagepose.state().inset !== null")
    assert np.ptp(seen(rollers)[:, 0]) > 0.3 * width


def test_the_frame_stays_about_the_contacts_at_every_exaggeration(opened):
    tab = opened(film("rail-pitch"))
    width, height = tab.evaluate("[scene.clientWidth, scene.clientHeight]")
    for step in (0, 4, 7):
        set_range(tab, "exaggeration", step)
        wait_until(tab, f"cagepose.state().drawnExaggeration === {[1, 0, 0, 0, 20, 0, 0, 200][step]}")
        touches = np.array(tab.evaluate("cagepose.state().touches.map(cagepose.project)"))
        assert ((touches > 0.0) & (touches < [width, height])).all()


def test_a_picture_of_the_rail_has_an_inset_that_names_the_push_outside_and_one_of_the_drawer_has_none():
    maker = PictureMaker(Stage(film("rail-pitch")))
    picture = np.asarray(maker.picture(maker.shown.shots[-1]))
    assert maker.inset is not None
    assert "push" not in {
        label.text for label in maker.labels if all(0.0 < at < room for at, room in zip(label.place, SIZE, strict=True))
    }
    left, upper = maker.inset.corner
    width, height = maker.inset.eye.size.astype(int)
    around = [picture[upper, left : left + width], picture[upper + height - 1, left : left + width]]
    assert all((side == ImageColor.getrgb(BORDER)).all() for side in around)
    assert PictureMaker(Stage(film("drawer"))).inset is None
