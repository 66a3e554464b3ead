"""The page and the pictures show one and the same: same places, same light."""

from __future__ import annotations

import base64
import io
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Page

from cagepose import load_scene, run
from cagepose.views.solids import outer_points
from cagepose.views.viewer.look import PAINT, ink
from cagepose.views.viewer.page import page
from cagepose.views.viewer.picture import SIZE, PictureMaker
from cagepose.views.viewer.playback import playback
from cagepose.views.viewer.stage import Stage
from driving import pretend_graphics_card, state, wait_until

SCENES = Path(__file__).resolve().parents[3] / "scenes"


def pixels(tab: Page) -> np.ndarray:
    """The pixels of the page's picture, without what is written over it."""
    url = tab.evaluate("scene.toDataURL()")
    return np.asarray(Image.open(io.BytesIO(base64.b64decode(url.split(",")[1]))).convert("RGB"), dtype=float)


@pytest.mark.parametrize("has_card", [False, True])
@pytest.mark.parametrize("name", ["drawer", "peg-in-hole", "plate-on-pins", "rail-pitch"])
def test_the_page_draws_what_a_picture_shows(watched, tmp_path, name, has_card):
    """Without a graphics card light is worked out at corners alone, with one for each pixel."""
    if has_card:
        pretend_graphics_card(watched.page)
    film = playback(run(load_scene(SCENES / f"{name}.yaml")))
    maker = PictureMaker(Stage(film))
    picture = np.asarray(maker.picture(film.shots[-1]), dtype=float)
    file = tmp_path / "run.html"
    file.write_text(page(film), encoding="utf-8")
    tab = watched.page
    tab.goto(file.as_uri())
    wait_until(tab, "cagepose.state().drawn > 0")
    tab.add_style_tag(content=f"#view {{ position: fixed !important; inset: 0 auto auto 0; width: {SIZE[0]}px;"
                              f" height: {SIZE[1]}px; z-index: 9 }}")  # fmt: skip
    seen = [maker.eye.target.tolist(), maker.eye.axes[2].tolist(), maker.eye.half, maker.eye.distance]
    drawn = state(tab)["drawn"]
    tab.evaluate("([target, back, half, distance]) => cagepose.look(target, back, half, distance)", seen)
    wait_until(tab, f"cagepose.state().drawn > {drawn}")
    on_page = pixels(tab)
    assert on_page.shape == picture.shape
    is_body = [np.abs(shown - [246, 247, 249]).max(axis=2) > 45 for shown in (picture, on_page)]
    for shown in is_body:
        shown[:60] = shown[-60:] = False  # captions
    both, either = is_body[0] & is_body[1], is_body[0] | is_body[1]
    print(f"{name}: {both.sum() / either.sum():.3f} of what is drawn is drawn by both")
    assert both.sum() > 0.9 * either.sum()
    apart = np.abs(picture - on_page)[both].mean(axis=1)
    print(f"colours differ by {np.median(apart):.1f} of 255")
    assert np.median(apart) < 6.0


@pytest.mark.parametrize("is_perspective", [True, False])
def test_where_a_part_without_edges_started_is_outlined_on_the_page_too(watched, tmp_path, is_perspective):
    """The ball of the chuck and its handle, of which nothing but their outline can be drawn."""
    film = playback(run(load_scene(SCENES / "chuck.yaml")))
    file = tmp_path / "run.html"
    file.write_text(page(film), encoding="utf-8")
    tab = watched.page
    tab.goto(file.as_uri())
    wait_until(tab, "cagepose.state().drawn > 0")
    tab.locator("#perspective").set_checked(is_perspective)
    wait_until(tab, f"cagepose.state().camera.perspective === {str(is_perspective).lower()}")
    picture, stage = pixels(tab), Stage(film)
    start = stage.pose(film.shots[0].pose_world_object, stage.look(0, stage.proposed))
    surface = stage.place(start.transform(outer_points(film.scene.object)))
    seen = np.array(tab.evaluate("(places) => places.map(cagepose.project)", surface.tolist()))
    for x, y in (seen[seen[:, 1].argmin()], seen[seen[:, 0].argmin()]):  # its highest place and its leftmost
        row, column = int(y), int(x)
        around = picture[row - 3 : row + 4, column - 3 : column + 4]
        assert (np.abs(around - ink(PAINT["ghost"])).max(axis=2) < 30.0).any()
