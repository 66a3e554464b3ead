"""The page shows the gap: contacts can be clicked and approached, and stay crisp at a millionth of the part."""

from __future__ import annotations

import base64
import io
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from cagepose import Box, Cage, Load, Object, Pose, Scene, Sphere, load_scene, run
from cagepose.views.viewer.page import page
from cagepose.views.viewer.playback import playback
from cagepose.views.viewer.stage import Stage
from driving import set_range, state, wait_until

SCENES = Path(__file__).resolve().parents[3] / "scenes"
WEIGHT = Load("weight", gravity=(0, 0, -1))
TABLE = Box((0.1, 0.1, 0.01), Pose((0.0, 0.0, -0.005)), "table")


@pytest.fixture
def opened(watched, tmp_path) -> Callable:
    def open_page(film):
        file = tmp_path / "run.html"
        file.write_text(page(film), encoding="utf-8")
        watched.page.goto(file.as_uri())
        wait_until(watched.page, "cagepose.state().drawn > 0")
        return watched.page

    return open_page


def drawn(page) -> np.ndarray:
    """The pixels of the picture, without what is written over it."""
    before = state(page)["drawn"]
    page.evaluate("window.dispatchEvent(new Event('resize'))")
    wait_until(page, f"cagepose.state().drawn > {before}")
    url = page.evaluate("scene.toDataURL()")
    return np.asarray(Image.open(io.BytesIO(base64.b64decode(url.split(",")[1]))).convert("RGB"), dtype=float)


def is_blue(color: np.ndarray) -> bool:
    return bool(color[2] > color[0] + 20.0)


def test_at_a_millionth_of_the_part_the_edge_of_a_block_is_where_it_is_to_two_pixels(opened):
    """It stands askew on a table; single precision would miss by some 50 pixels."""
    block = Object([Box((0.03, 0.02, 0.01), name="block")], pose=Pose((0.0031, 0.0017, 0.0061), euler_zyx=(0.3, 0, 0)))
    film = playback(run(Scene(block, Cage(shapes=[TABLE]), [WEIGHT])))
    page, stage = opened(film), Stage(film)
    set_range(page, "exaggeration", 0)
    end = film.shots[-1].pose_world_object
    corner = np.array((0.015, -0.01, -0.005))
    place = stage.place(end.transform(corner))
    back = end.rotation @ np.array((0.7, -0.7, 0.0)) + [0.0, 0.0, 0.35]
    half = 5e-7 * 0.03 / stage.size_m
    page.evaluate(
        "([p, b, h]) => cagepose.look(p, b, h)", [place.tolist(), (back / np.linalg.norm(back)).tolist(), half]
    )
    picture = drawn(page)
    for along in (np.array((-1.0, 0.0, 0.0)), np.array((0.0, 1.0, 0.0))):
        for share in (0.2, 0.35, 0.5):
            on_edge = stage.place(end.transform(corner + along * share * half * stage.size_m))
            x, y = np.round(page.evaluate("(p) => cagepose.project(p)", on_edge.tolist())).astype(int)
            assert 0 < x < picture.shape[1]
            column = [is_blue(color) for color in picture[y - 12 : y + 13, x]]
            assert all(column[:10]), (along, share)
            assert not any(column[-10:]), (along, share)


def test_at_a_millionth_of_the_part_a_ball_is_round_and_hangs_over_the_table_by_its_gap(opened):
    """A ball of 10 mm hangs 3 nm over a table; a picture 20 nm high shows that."""
    gap = 3e-9
    ball = Object(shapes=[Sphere(0.01, name="ball")], pose=Pose((0.0013, 0.0021, 0.01 + gap)))
    film = playback(run(Scene(ball, Cage(shapes=[TABLE]), [WEIGHT])))
    page, stage = opened(film), Stage(film)
    set_range(page, "exaggeration", 0)
    set_range(page, "time", 0)
    page.locator("#perspective").uncheck()  # else its underside would be seen up to the horizon
    half_m = 1e-8
    target = stage.place(np.array((0.0013, 0.0021, 0.0)))
    page.evaluate("([p, h]) => cagepose.look(p, [0, -1, 0], h)", [target.tolist(), half_m / stage.size_m])
    picture = drawn(page)
    middle = picture.shape[1] // 2
    pixel_m = 2.0 * half_m / picture.shape[0]
    for aside in (-300, 0, 300):  # so near, the ball is flat
        blue = [row for row in range(picture.shape[0]) if is_blue(picture[row, middle + aside])]
        lowest = picture.shape[0] / 2.0 - max(blue) - 1
        assert lowest * pixel_m == pytest.approx(gap, abs=2.0 * pixel_m)


def test_the_wheel_zooms_to_what_is_under_the_pointer_and_marks_keep_their_size(opened):
    film = playback(run(load_scene(SCENES / "slope.yaml")))
    page = opened(film)
    place = state(page)["touches"][0]
    x, y = page.evaluate("(p) => cagepose.project(p)", place)
    box = page.locator("#scene").bounding_box()
    page.mouse.move(box["x"] + x, box["y"] + y)
    before = state(page)["camera"]["half"]
    for _ in range(40):
        page.mouse.wheel(0, -300)
    wait_until(page, f"cagepose.state().camera.half < {before * 1e-6}")
    assert page.evaluate("(p) => cagepose.project(p)", place) == pytest.approx([x, y], abs=2.0)
    camera = state(page)["camera"]
    assert np.linalg.norm(np.subtract(camera["target"], place)) < 2.0 * camera["half"]
    wait_until(page, "cagepose.state().written.length > 0")
    assert film.run.contacts[0].point in {name["text"] for name in state(page)["written"]}


def test_a_click_on_a_contact_tells_it_and_zooms_to_it_at_true_scale(opened):
    film = playback(run(load_scene(SCENES / "rail-pitch.yaml", ["friction.coefficient=0.1"])))
    page = opened(film)
    contact = next(contact for contact in film.run.contacts if contact.point == "C13")
    index = [c.point for c in film.run.contacts].index("C13")
    x, y = page.evaluate("(i) => cagepose.project(cagepose.state().touches[i])", index)
    page.locator("#scene").click(position={"x": x, "y": y})
    wait_until(page, "!card.hidden")
    assert page.locator("#cardname").inner_text() == f"C13 on {contact.box}"
    told = page.locator("#cardlines").inner_text()
    assert f"{contact.force_normal_n:.4g}" in told
    assert "gap" in told
    assert "friction used" in told
    normal = [float(word) for word in page.locator("#cardlines dd").nth(1).inner_text().strip("()").split(",")]
    assert normal == pytest.approx(contact.normal_world.tolist(), abs=1e-4)
    page.locator("#zoom").click()
    wait_until(page, "badge.innerText === 'true scale'")
    camera = state(page)["camera"]
    place = Stage(film).place(film.shots[-1].touches.places_world[index])
    assert camera["target"] == pytest.approx(place.tolist(), abs=1e-9)
    assert abs(np.dot(camera["back"], contact.normal_world)) < 0.3  # nearly along the plane of the contact
    page.locator("#close").click()
    wait_until(page, "card.hidden")


def test_a_parallel_view_shows_equal_lengths_at_every_depth(opened):
    page = opened(playback(run(load_scene(SCENES / "slope.yaml"))))
    lengths = {}
    for perspective in (True, False):
        page.locator("#perspective").set_checked(perspective)
        wait_until(page, f"cagepose.state().camera.perspective === {str(perspective).lower()}")
        camera = state(page)["camera"]
        behind = np.subtract(camera["target"], np.multiply(0.5, camera["back"]))
        side = np.cross(camera["back"], (0, 0, 1)) * 0.1
        seen = [
            page.evaluate("(p) => cagepose.project(p)", place.tolist())
            for place in (np.array(camera["target"]), camera["target"] + side, behind, behind + side)
        ]
        lengths[perspective] = [np.linalg.norm(np.subtract(*seen[:2])), np.linalg.norm(np.subtract(*seen[2:]))]
    assert lengths[False][0] == pytest.approx(lengths[False][1])
    assert lengths[True][1] < 0.95 * lengths[True][0]


def test_points_can_be_pins_balls_or_nothing(opened):
    page = opened(playback(run(load_scene(SCENES / "slope.yaml"))))
    set_range(page, "time", 0)
    seen = []
    for look in ("pin", "ball", "none"):
        page.locator("#points").select_option(look)
        seen.append(drawn(page))
    for one, other in ((0, 1), (1, 2), (0, 2)):
        assert np.abs(seen[one] - seen[other]).max() > 30.0


@pytest.mark.parametrize(("width", "height"), [(1440, 900), (390, 844)])
def test_forces_are_in_sight_on_a_desk_and_nothing_is_cut_on_a_phone(opened, width, height):
    page = opened(playback(run(load_scene(SCENES / "rail-pitch.yaml"))))
    page.set_viewport_size({"width": width, "height": height})
    page.wait_for_timeout(200)
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    lines = page.locator("#forces tr").all()
    assert len(lines) > 3
    for line in lines:
        box = line.bounding_box()
        assert box["x"] >= 0
        assert box["x"] + box["width"] <= width
        assert width < 1000 or box["y"] + box["height"] < height
    for name in ("button", "label", "td"):
        for box in filter(None, (item.bounding_box() for item in page.locator(f"{name}:visible").all())):
            assert box["x"] >= -0.5
            assert box["x"] + box["width"] <= width + 0.5


def test_without_webgl_the_page_says_so_and_all_else_works(browser, tmp_path):
    film = playback(run(load_scene(SCENES / "slope.yaml")))
    file = tmp_path / "run.html"
    file.write_text(page(film), encoding="utf-8")
    context = browser.new_context()
    context.add_init_script("HTMLCanvasElement.prototype.getContext = ((get) => function (kind, ...more) {"
                            " return kind.startsWith('webgl') ? null : get.call(this, kind, ...more); })"
                            "(HTMLCanvasElement.prototype.getContext);")  # fmt: skip
    tab = context.new_page()
    tab.goto(file.as_uri())
    wait_until(tab, "!trouble.hidden")
    assert "WebGL" in tab.locator("#trouble").inner_text()
    tab.locator("#back").click()
    wait_until(tab, "cagepose.state().drawnTime === 0 || cagepose.state().row >= 0")
    assert tab.locator("#verdict").inner_text() == "rests"
    context.close()
