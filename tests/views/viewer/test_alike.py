"""The page and the pictures show one and the same: same places, same light."""

from __future__ import annotations

import base64
import io
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from cagepose import load_scene, run
from cagepose.views.viewer.page import page
from cagepose.views.viewer.picture import SIZE, PictureMaker
from cagepose.views.viewer.playback import playback
from cagepose.views.viewer.stage import Stage
from driving import pretend_graphics_card, state, wait_until

SCENES = Path(__file__).resolve().parents[3] / "scenes"


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
    seen = [maker.eye.target.tolist(), maker.eye.axes[2].tolist(), maker.eye.half]
    drawn = state(tab)["drawn"]
    tab.evaluate("([target, back, half]) => cagepose.look(target, back, half)", seen)
    wait_until(tab, f"cagepose.state().drawn > {drawn}")
    url = tab.evaluate("scene.toDataURL()")
    on_page = np.asarray(Image.open(io.BytesIO(base64.b64decode(url.split(",")[1]))).convert("RGB"), dtype=float)
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
