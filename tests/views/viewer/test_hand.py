"""The hand in a real browser: what it pulls goes where the solver says, and the picture never disagrees in silence."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Page

from bench.pulls_table import depth_of_size
from cagepose import Box, Cage, Load, Object, Pose, Scene, load_scene, run
from cagepose.files.units import to_metres
from cagepose.runs.further import Place, further
from cagepose.runs.pull import pulled_load
from cagepose.views.viewer import hand
from cagepose.views.viewer.playback import playback
from cagepose.views.viewer.stage import Stage
from cagepose.views.viewer.what_if import WhatIf
from driving import opened, served, shown_angles, slide, state, wait_until

SCENES = Path(__file__).resolve().parents[3] / "scenes"


def settle(page: Page) -> Any:
    wait_until(page, "!cagepose.state().isBusy && cagepose.state().drawnAnswers === cagepose.state().answers")
    return state(page)


def place_on_object(page: Page) -> tuple[float, float]:
    """A pixel in which the part is seen, near the middle of the picture."""
    box = page.locator("#scene").bounding_box()
    draw = np.random.default_rng(5)
    for spread in np.linspace(0.0, 1.0, 300):
        x, y = (0.5 + 0.4 * spread * draw.uniform(-1.0, 1.0, 2)) * (box["width"], box["height"])
        if page.evaluate("([x, y]) => cagepose.isOnObject(x, y)", [x, y]):
            return box["x"] + x, box["y"] + y
    raise AssertionError("the part is not to be seen")


@contextmanager
def held(page: Page, *way: tuple[float, float]) -> Iterator[Any]:
    """The page while the part is pulled along a way of pixels, and what its hand says then."""
    x, y = place_on_object(page)
    page.mouse.move(x, y)
    page.mouse.down()
    for across, down in way:
        page.mouse.move(x + across, y + down)
        now = settle(page)
    yield now
    page.mouse.up()
    settle(page)


@pytest.mark.parametrize("name", ["drawer", "plate-on-pins", "rail-pitch"])
def test_a_pull_goes_where_the_solver_says_and_never_into_the_cage(watched: Any, name: str) -> None:
    """Each pull goes on from the one before; at rest, picture and forces are those of the pull that is asked for."""
    found = run(load_scene(SCENES / f"{name}.yaml"))
    last, before = len(found.phases) - 1, list[list[float]]()
    with served(SCENES / f"{name}.yaml") as server:
        page = opened(watched, server)
        for angle in (0.3, 2.0, 4.4):
            way = [(length * math.cos(angle), length * math.sin(angle)) for length in (20.0, 70.0)]
            with held(page, *way) as now:
                told = now["hand"]
                assert told["force"] == told["shownForce"]
                pull = np.array(told["force"])
                assert page.locator("#handsays").inner_text()
                if told["way"]:
                    assert depth_of_size(found, last, told["way"][-1]) <= 2.0 * found.scene.tolerances.touch
                before = told["way"]
            assert pull.any()
            assert state(page)["hand"]["shownForce"] == [0, 0, 0]
            assert state(page)["time"] == state(page)["drawnTime"]
        assert not page.locator("#problems").inner_text()
    assert before


def test_the_part_is_shown_where_the_run_goes_on_to_and_goes_back_to_the_start(watched: Any) -> None:
    found = run(load_scene(SCENES / "drawer.yaml"))
    with served(SCENES / "drawer.yaml") as server:
        page = opened(watched, server)
        start = shown_angles(page)
        with held(page, (100.0, -50.0)) as now:
            told = now["hand"]
            at, pull = to_metres(told["at"], "mm"), np.array(told["force"])
            expected = further(found, 1, pulled_load(found.scene, 1, "hand", pull, at))
            assert page.locator("#verdict").inner_text() == expected.verdict
            assert shown_angles(page) == pytest.approx(np.degrees(expected.pose.euler_zyx).tolist(), abs=1e-4)
            assert np.abs(np.array(shown_angles(page)) - start).max() > 1e-3
            assert told["way"][-1][:3] == expected.pose.position_m.tolist()  # to the last digit
        left = Place(expected.pose, {})
        rest = further(found, 1, pulled_load(found.scene, 1, "let go", np.zeros(3), at), [left])
        assert shown_angles(page) == pytest.approx(np.degrees(rest.pose.euler_zyx).tolist(), abs=1e-4)
        page.locator("#handback").click()
        settle(page)
        assert shown_angles(page) == pytest.approx(start, abs=1e-6)
        assert page.locator("#hand").is_hidden()
        with held(page, (1.0, 1.0)):  # a click
            pass
        assert state(page)["hand"] is None
        assert state(page)["answers"] == 3


def test_what_is_said_on_letting_go_is_told_from_the_phase_on_screen_and_not_from_the_pull_before() -> None:
    """A block on a table with friction is pushed away, half of the way back, and back."""
    table, weight = Box((1.0, 1.0, 0.02), name="table"), Load("weight", gravity=(0, 0, -9.81))
    block = Object([Box((0.04, 0.03, 0.02))], pose=Pose((0.0, 0.0, 0.02)), mass_kg=1.0)
    shown = playback(run(Scene(block, Cage(shapes=[table]), [weight], friction_coefficient=0.3)))
    stage, way, said = Stage(shown), list[Place](), list[str]()
    for distance in (0.02, 0.01, 0.0):
        way.append(Place(Pose((distance, 0.0, 0.02)), {}))
        answer = hand.pulled(shown, stage, hand.Grip(0, list(way), np.zeros(3), np.zeros(3)))
        said.append(answer["led"]["says"])
    assert said == [
        "it stays, 20 mm and 0 deg from where weight has left it",
        "it stays, 10 mm and 0 deg from where weight has left it",
        "it is back where weight has left it",
    ]


def test_what_is_asked_for_and_not_yet_shown_is_said_and_a_slider_takes_the_part_away(
    watched: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An answer to a pull that comes when the sliders have asked for something else is dropped."""
    answer = WhatIf.pulled

    def slowly(*asked: Any) -> Any:
        time.sleep(0.8)
        return answer(*asked)

    monkeypatch.setattr(WhatIf, "pulled", slowly)
    with served(SCENES / "drawer.yaml") as server:
        page = opened(watched, server)
        assert page.locator("#busy").is_hidden()
        x, y = place_on_object(page)
        page.mouse.move(x, y)
        page.mouse.down()
        page.mouse.move(x, y - 60.0)
        wait_until(page, "cagepose.state().isBusy")
        assert page.locator("#busy").is_visible()
        slide(page, "cage: pitch", 0.1)
        now = settle(page)
        page.mouse.up()
        assert now["answers"] == 1
        assert now["hand"] is None
        expected = run(load_scene(SCENES / "drawer.yaml", ["cage.pose.euler_zyx_deg=[0,0.1,0]"]))
        assert shown_angles(page) == pytest.approx(np.degrees(expected.pose.euler_zyx).tolist(), abs=1e-4)


def test_a_pull_without_an_answer_is_told_and_the_last_answer_stays(
    watched: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(hand, "WITHIN_S", 1e-3)
    monkeypatch.setattr("cagepose.runs.further.run_with", lambda *asked: time.sleep(0.2) or stopped(asked[-1]))
    with served(SCENES / "drawer.yaml") as server:
        page = opened(watched, server)
        before = shown_angles(page)
        with held(page, (0.0, -60.0)):
            assert "no rest was found within 0.001 s" in page.locator("#problems").inner_text()
            assert "The picture shows the last answer." in page.locator("#problems").inner_text()
            assert shown_angles(page) == before
        watched.expect("status of 422")


def stopped(stop: np.ndarray) -> None:
    assert stop[0]
    raise KeyboardInterrupt


def test_where_nobody_can_pull_it_is_said(watched: Any) -> None:
    """The paper's rules know no hand; a page of a saved run has no solver behind it."""
    with served(SCENES / "sample.yaml") as server:
        page = opened(watched, server)
        with held(page, (0.0, -60.0)):
            assert "to pull by hand, choose quasistatic" in page.locator("#problems").inner_text()
        assert state(page)["answers"] == 0
    with served(SCENES / "sample.yaml", can_change=False) as server:
        page = opened(watched, server)
        assert page.locator("#pull").is_hidden()
