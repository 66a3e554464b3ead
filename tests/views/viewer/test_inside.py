"""Looking inside a page in a real browser: the cut, what is seen through, and gaps with numbers."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Page

from cagepose import Box, Cage, Force, Hole, Load, Pose, Scene, load_scene, run
from cagepose.model.facets import Facets
from cagepose.model.shapes import Cylinder
from cagepose.runs.driven_cage import cage_at_end
from cagepose.studies.gaps import GapFinder
from cagepose.views.viewer.page import page
from cagepose.views.viewer.playback import Playback, playback
from cagepose.views.viewer.server import ViewServer
from cagepose.views.viewer.stage import EXAGGERATIONS, Stage
from driving import count_drawing, drawn_for_a_picture, served, set_range, slide, state, wait_until
from shaped_scenes import WEIGHT, ball_on_table, held

SCENES = Path(__file__).resolve().parents[3] / "scenes"
MICROMETRE = "\u00b5m"


@pytest.fixture
def opened(watched, tmp_path) -> Callable:
    """Write a playback's page to a file and open it with the network off."""

    def open_page(film: Playback) -> Page:
        file = tmp_path / "run.html"
        file.write_text(page(film), encoding="utf-8")
        watched.page.context.set_offline(True)
        watched.page.goto(file.as_uri())
        wait_until(watched.page, "cagepose.state().drawn > 0")
        return watched.page

    return open_page


@pytest.fixture(scope="module")
def plate() -> Playback:
    return playback(run(load_scene(SCENES / "plate-on-pins.yaml")), shots_per_motion=4)


def drawn_anew(page: Page, act: Callable[[], object]) -> Any:
    """What is on screen once all is drawn that was asked for."""
    before = state(page)["drawn"]
    act()
    wait_until(page, f"cagepose.state().drawn > {before}")
    page.evaluate("() => new Promise((go) => requestAnimationFrame(() => requestAnimationFrame(go)))")
    return state(page)


def cut(page: Page, axis: str) -> Any:
    return drawn_anew(page, lambda: page.locator("#cut").select_option(axis))["section"]


def color_at(page: Page, place: list[float], around: int = 0) -> np.ndarray:
    """What is seen at a place of the scene, and so many pixels around it, (n, n, 3)."""
    x, y = page.evaluate("(place) => cagepose.project(place)", place)
    picture = Image.open(io.BytesIO(page.locator("#scene").screenshot())).convert("RGB")
    return np.asarray(picture, dtype=float)[
        int(y) - around : int(y) + around + 1, int(x) - around : int(x) + around + 1
    ]


def test_a_cut_has_the_area_that_it_has_and_moves_by_the_keys(opened):
    """A ball on a plate: pi (r^2 - d^2), and width times height; what is round is drawn with 48 or more chords."""
    film = playback(run(ball_on_table()), shots_per_motion=4)
    page, size_m = opened(film), Stage(film).size_m
    section = cut(page, "y")
    ball, table = np.array(section["areas"]) * size_m**2
    assert ball == pytest.approx(math.pi * 0.01**2, rel=3e-3)
    assert table == pytest.approx(0.4 * 0.02, rel=1e-9)
    page.locator("#cutplace").focus()
    moved = drawn_anew(page, lambda: [page.keyboard.press("ArrowRight") for _ in range(3)])["section"]
    way = np.subtract(moved["point"], section["point"])
    assert way @ section["normal"] == pytest.approx(np.linalg.norm(way)) != 0.0
    assert np.linalg.norm(way) * size_m < 0.01
    ball = moved["areas"][0] * size_m**2
    assert ball == pytest.approx(math.pi * (0.01**2 - (np.linalg.norm(way) * size_m) ** 2), rel=8e-3)
    assert drawn_anew(page, lambda: page.locator("#cut").select_option(""))["section"] is None
    assert page.locator("#cutters").is_hidden()


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_a_view_of_what_is_cut_is_from_the_side_that_was_cut_away(opened, plate, axis):
    page = opened(plate)
    views = {"x": "along x", "y": "along y", "z": "from above"}
    normal = np.array(cut(page, axis)["normal"])
    for name in ("corner", *views.values()):
        button = page.get_by_role("button", name=name)
        along = np.array(drawn_anew(page, button.click)["camera"]["back"]) @ normal
        assert along > (0.99 if name == views[axis] else -1e-9)
    drawn_anew(page, lambda: page.locator("#cut").select_option(""))
    uncut = drawn_anew(page, page.get_by_role("button", name="along x").click)
    assert uncut["camera"]["back"] == pytest.approx([-1.0, 0.0, 0.0], abs=1e-9)


def square_tube(outer: float, inner: float, length: float) -> Facets:
    """Open at both ends, along z; lengths from side to side."""
    ring = [
        (x, y)
        for half in (outer / 2.0, inner / 2.0)
        for x, y in ((-half, -half), (half, -half), (half, half), (-half, half))
    ]
    vertices = [(x, y, z) for z in (-length / 2.0, length / 2.0) for x, y in ring]
    triangles = []
    for k in range(4):
        j = (k + 1) % 4
        triangles += [(k, j, 8 + j), (k, 8 + j, 8 + k), (4 + j, 4 + k, 12 + k), (4 + j, 12 + k, 12 + j)]
        triangles += [(8 + k, 8 + j, 12 + j), (8 + k, 12 + j, 12 + k), (j, k, 4 + k), (j, 4 + k, 4 + j)]
    return Facets(vertices, triangles, name="tube")


@pytest.mark.parametrize(("axis", "area"), [("z", 0.03**2 - 0.014**2), ("x", 2.0 * 0.008 * 0.05)])
def test_the_cut_of_a_body_of_triangles_is_open_where_the_body_is(opened, axis, area):
    push = Load("push", force=Force(direction=(1, 0, 0), at_m=(0, 0, 0)))
    inside, tube = held(Box((0.01, 0.01, 0.01)), start=Pose((0, 0, 0.001))), square_tube(0.03, 0.014, 0.05)
    scene = Scene(inside, Cage(shapes=[tube]), [push])
    film = playback(run(scene), shots_per_motion=4)
    page, size_m = opened(film), Stage(film).size_m
    assert np.array(cut(page, axis)["areas"]) * size_m**2 == pytest.approx([0.01**2, area], rel=1e-6)


def test_the_plane_is_dragged_by_its_arrow_and_turned_by_its_ring(opened, plate):
    page = opened(plate)
    section = cut(page, "x")
    box = page.locator("#scene").bounding_box()

    def drag(place: list[float], by: tuple[float, float]) -> Any:
        x, y = page.evaluate("(place) => cagepose.project(place)", place)
        page.mouse.move(box["x"] + x, box["y"] + y)
        page.mouse.down()
        after = drawn_anew(page, lambda: page.mouse.move(box["x"] + x + by[0], box["y"] + y + by[1], steps=4))
        page.mouse.up()
        return after

    camera = state(page)["camera"]
    way = np.subtract(
        *(page.evaluate("(place) => cagepose.project(place)", section["handle"][end]) for end in ("tip", "at"))
    )
    after = drag(section["handle"]["tip"], tuple(way))
    moved = np.subtract(after["section"]["point"], section["point"])
    length = np.linalg.norm(np.subtract(section["handle"]["tip"], section["handle"]["at"]))
    assert moved == pytest.approx(length * np.array(section["normal"]), abs=0.05 * length)
    assert after["section"]["normal"] == section["normal"]
    assert after["camera"] == camera  # the view stands still meanwhile
    turned = drag(after["section"]["handle"]["ring"][12], (0.0, -20.0))
    angle = math.acos(np.dot(turned["section"]["normal"], section["normal"]))
    assert math.radians(15.0) < angle < math.radians(40.0)  # 20 pixels of a ring with a radius of 40
    assert turned["camera"] == camera
    assert float(page.locator("#cuttilt").input_value()) == pytest.approx(
        math.degrees(math.asin(turned["section"]["normal"][2])), abs=1.0
    )


def test_a_cut_is_filled_with_the_body_and_open_where_a_hole_is(opened):
    block, bore = Box((0.06, 0.06, 0.02), Pose((0, 0, -0.01)), "block"), Hole(0.01, 0.02, in_=["block"], name="bore")
    pin = held(Cylinder(0.004, 0.04), start=Pose((0, 0, 0.01)))
    scene = Scene(pin, Cage([(0, 0, -0.0101)], shapes=[block], holes=[bore]), [WEIGHT])
    film = playback(run(scene), shots_per_motion=4)
    page, stage = opened(film), Stage(film)
    set_range(page, "exaggeration", 0)
    page.locator("[data-view=y]").click()
    section = cut(page, "y")
    assert section["normal"] == [0, -1, 0]
    seen = [
        color_at(page, stage.place(np.array((x, 0.0, -0.006))).tolist(), 6).mean(axis=(0, 1))
        for x in (0.0, 0.02, 0.007)
    ]
    of_pin, of_block, of_bore = seen
    assert of_pin[2] > of_pin[0] + 40  # blue
    assert of_block[0] > of_block[2] + 15  # sand
    assert np.abs(of_bore - of_block).max() > 15  # the wall behind, with no hatch


def test_what_is_seen_through_shows_all_behind_it_evenly_where_faces_lie_on_each_other(opened):
    """A box stands flush on a plate and against a wall; both are seen through it, without stripes."""
    floor = Box((0.06, 0.06, 0.004), Pose((0, 0, -0.012)), "floor")
    wall = Box((0.06, 0.004, 0.03), Pose((0, 0.012, 0)), "wall")
    scene = Scene(held(Box((0.04, 0.02, 0.02)), start=Pose((0, 0, 0.001))), Cage(shapes=[floor, wall]), [WEIGHT])
    film = playback(run(scene), shots_per_motion=4)
    page, stage = opened(film), Stage(film)
    set_range(page, "exaggeration", 0)
    page.locator("#names").uncheck()
    drawn_anew(page, lambda: page.locator("#glass").check())
    for view, place in (("y", (0.012, 0.0, 0.003)), ("z", (0.012, 0.003, 0.0))):
        drawn_anew(page, lambda view=view: page.locator(f"[data-view={view}]").click())
        seen = color_at(page, stage.place(np.array(place)).tolist(), 12)
        assert seen.std(axis=(0, 1)).max() < 2.0
        red, _, blue = seen.mean(axis=(0, 1))
        assert abs(blue - red) < 40  # sand through blue: blue alone, over paper, differs by 60
    drawn_anew(page, lambda: page.locator("#glass").uncheck())
    place = stage.place(np.array((0.012, 0.01, 0.003))).tolist()
    drawn_anew(page, lambda: page.evaluate("(place) => cagepose.look(place, [0.2, 0.95, 0.2], 0.3)", place))
    seen = color_at(page, place, 12)
    assert seen.std(axis=(0, 1)).max() < 2.0
    red, _, blue = seen.mean(axis=(0, 1))
    assert blue - red > 10  # the box through the wall, whose far side it lies against


def test_gaps_are_told_and_drawn_as_they_are_however_exaggerated(opened, plate):
    page = opened(plate)
    scene = plate.run.scene
    found = GapFinder(scene).at(plate.run.pose, cage_at_end(plate.run))
    is_open = found.gaps_m > 0.0
    is_open &= found.gaps_m < 1e-3  # of what is farther, the list tells what is on other sides
    assert is_open.sum() == 2
    expected = [
        [f"{scene.cage.element_names[e]} to {scene.object.element_names[p]}", f"{1e6 * gap:.4g} {MICROMETRE}"]
        for e, p, gap in zip(found.elements[is_open], found.parts[is_open], found.gaps_m[is_open], strict=True)
    ]
    page.locator("#dimensions").check()
    for exaggeration in (1, 10):
        set_range(page, "exaggeration", EXAGGERATIONS.index(exaggeration))
        wait_until(page, f"cagepose.state().drawnExaggeration === {exaggeration}")
        lines = [line.locator("td").all_inner_texts() for line in page.locator("#gaplist tr").all()]
        assert sorted(lines) == sorted(expected)
        shown = state(page)["dimensions"]
        assert [told["text"] for told in shown] == [line[1] for line in lines]
        lengths = [np.linalg.norm(np.subtract(*told["ends"])) * Stage(plate).size_m for told in shown]
        assert lengths == pytest.approx(exaggeration * found.gaps_m[is_open], rel=0.02)
    assert f"40 {MICROMETRE}" in {name["text"] for name in state(page)["written"]}
    drawn_anew(page, lambda: page.locator("#gapsall").press("Enter"))
    assert page.locator("#gaplist tr").count() == len(found.gaps_m)
    assert page.locator("#gaplist").inner_text().count("touches") == (found.gaps_m == 0.0).sum()


def test_a_part_of_the_cage_that_is_clicked_tells_its_gaps_and_so_does_its_name(opened):
    film = playback(run(load_scene(SCENES / "drawer.yaml")), shots_per_motion=4)
    page = opened(film)
    names = film.run.scene.cage.element_names
    place = page.evaluate("(i) => cagepose.state().bodies[i]", names.index("stop"))
    x, y = page.evaluate("(place) => cagepose.project(place)", place)
    page.locator("#scene").click(position={"x": x, "y": y})
    wait_until(page, "gapsof.innerText === 'of stop'")
    found = GapFinder(film.run.scene).at(film.run.pose, cage_at_end(film.run))
    least = found.gaps_m[found.elements == names.index("stop")].min()
    assert page.locator("#gaplist td").nth(1).inner_text() == f"{1e3 * least:.4g} mm"
    assert len(state(page)["dimensions"]) == page.locator("#gaplist tr").count()  # of what is picked, in any case
    page.locator("#gapsall").click()
    wait_until(page, "gapsof.innerText === 'the narrowest'")
    button = page.locator("#gaplist button").first
    name = button.inner_text()
    button.press("Enter")
    wait_until(page, f"gapsof.innerText === 'of {name}'")
    page.locator("#first").click()
    page.evaluate("() => { time.value = 1.5; time.dispatchEvent(new Event('input')); }")
    wait_until(page, "gapnote.innerText.startsWith('Gaps are known at the end')")
    assert state(page)["dimensions"] == []


@pytest.fixture(scope="module")
def server() -> Iterator[ViewServer]:
    with served(SCENES / "plate-on-pins.yaml") as server:
        yield server


def test_a_slider_changes_gaps_and_cuts_with_the_run(watched, server):
    page = watched.page
    page.goto(server.address)
    wait_until(page, "cagepose.state().drawn > 0")
    cut(page, "z")
    before = [line["gap"] for line in state(page)["gaps"]]
    slide(page, "push: direction y", -10.0)
    after = state(page)
    assert after["section"]["areas"][0] > 0.0
    assert [line["gap"] for line in after["gaps"]] != before


def test_a_cut_crowd_with_its_gaps_is_drawn_in_few_goes(watched, crowded, tmp_path):
    count_drawing(watched.page)
    file = tmp_path / "run.html"
    file.write_text(page(playback(run(crowded), shots_per_motion=2)), encoding="utf-8")
    tab = watched.page
    tab.goto(file.as_uri())
    wait_until(tab, "cagepose.state().drawn > 0")
    tab.locator("#dimensions").check()
    cut(tab, "y")
    each = drawn_for_a_picture(tab)
    print(f"each picture: {each}")
    assert 0 < each["drawn"] <= 12
    assert 0 < each["triangles"] <= 13_500
