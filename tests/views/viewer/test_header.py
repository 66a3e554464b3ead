"""Above the fold in a real browser: the verdicts of all phases, why, and one scroll bar."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Page

from cagepose import Load, Scene, load_scene, run
from cagepose.views.viewer.page import page
from cagepose.views.viewer.playback import Playback, playback
from driving import opened as opened_live
from driving import served, set_range, state, wait_until

SCENES = Path(__file__).resolve().parents[3] / "scenes"
SCROLLED = """[...document.querySelectorAll("body *")].filter((one) => one.scrollHeight > one.clientHeight + 1
    && /auto|scroll/.test(getComputedStyle(one).overflowY)).map((one) => one.tagName)"""


@pytest.fixture
def opened(watched, tmp_path) -> Callable[[Playback], Page]:
    def open_page(shown: Playback) -> Page:
        file = tmp_path / "run.html"
        file.write_text(page(shown), encoding="utf-8")
        watched.page.set_viewport_size({"width": 1440, "height": 900})
        watched.page.goto(file.as_uri())
        wait_until(watched.page, "cagepose.state().drawn > 0")
        return watched.page

    return open_page


def film(name: str) -> Playback:
    return playback(run(load_scene(SCENES / f"{name}.yaml")), shots_per_motion=4)


def test_each_phase_has_its_verdict_in_the_header_and_a_click_goes_to_its_end(opened):
    shown = film("rail-pitch")
    tab = opened(shown)
    phases = tab.locator("#phases button")
    assert phases.all_inner_texts() == ["weight rests, unstable", "push rests"]
    assert [button.get_attribute("aria-current") for button in phases.all()] == [None, "step"]
    phases.first.click()
    end = max(row.last_shot for row in shown.rows if row.phase == 0)
    wait_until(tab, f"cagepose.state().drawnTime === {end}")
    assert [button.get_attribute("aria-current") for button in phases.all()] == ["step", None]
    assert "weight: rests (unstable)" in tab.locator("#notes").inner_text()
    assert "push: rests" not in tab.locator("#notes").inner_text()


def test_each_phase_that_the_mechanics_contradicts_has_the_colour_of_no_rest(opened):
    """The cube of the sample tips on from where the paper's rules leave it, under its weight now and again."""
    sample = load_scene(SCENES / "sample.yaml")
    loads = [*sample.loads, Load("again", gravity=(0, 0, -1))]
    found = run(Scene(sample.object, sample.cage, loads), "stepwise")
    assert [phase.verdict for phase in found.phases] == ["stable", "stable"]
    assert [phase.proof.verdict for phase in found.phases] == ["moves", "moves"]
    tab = opened(playback(found, shots_per_motion=4))
    assert [word.get_attribute("class") for word in tab.locator("#phases span").all()] == ["elsewhere", "elsewhere"]
    assert tab.locator("#events td.elsewhere").count() == 2
    assert tab.locator("#events td.rest").count() == 0


@pytest.mark.parametrize("name", ["rail-pitch", "wedge", "sample", "grip"])
def test_proof_and_warnings_are_above_the_fold_and_nothing_scrolls_within_what_scrolls(opened, name):
    shown = film(name)
    tab = opened(shown)
    notes = tab.locator("#notes").bounding_box()
    assert notes["y"] + notes["height"] < 900.0
    told = tab.locator("#notes").inner_text()
    assert f"{shown.run.phases[-1].name}: {shown.run.verdict}" in told
    for warning in shown.run.warnings:
        assert warning.removeprefix(f"{shown.run.phases[-1].name}: ") in told
    assert set(tab.evaluate(SCROLLED)) <= {"ASIDE"}


def test_sliders_do_not_scroll_by_themselves_and_leave_proof_and_warnings_above_the_fold(watched):
    with served(SCENES / "rail-pitch.yaml") as server:
        watched.page.set_viewport_size({"width": 1440, "height": 900})
        tab = opened_live(watched, server)
        assert tab.locator("#controls label").count() > 10
        assert tab.evaluate(SCROLLED) == ["ASIDE"]
        notes = tab.locator("#notes").bounding_box()
        assert notes["y"] + notes["height"] < 900.0


def test_where_nothing_is_magnified_the_badge_says_true_scale(opened):
    """The wedge stands where it starts, and all of its cage touches it."""
    tab = opened(film("wedge"))
    set_range(tab, "exaggeration", 7)
    wait_until(tab, "cagepose.state().drawnExaggeration === 200")
    assert state(tab)["factor"] == 200.0
    assert tab.locator("#badge").inner_text() == "true scale"


@pytest.mark.parametrize("width", [390, 1440])
def test_no_table_is_wider_than_the_page(opened, width):
    tab = opened(film("grip"))
    tab.set_viewport_size({"width": width, "height": 844})
    assert tab.evaluate("document.documentElement.scrollWidth") <= width
    assert tab.evaluate(
        "[...document.querySelectorAll('aside table')].every((one) => one.scrollWidth <= one.parentElement.clientWidth)"
    )
