"""Many runs with other values of a number of the text, in a real browser."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page

from cagepose import SceneError, run
from cagepose.files.scene_file import parse_scene
from cagepose.views.viewer import editing
from driving import opened, served, slide, wait_until
from our_scenes import SCENES

RAIL = next(path for path in SCENES if path.stem == "rail-pitch")
TEXT = RAIL.read_text(encoding="utf-8")
PITCH = "cage.pose.euler_zyx_deg[1]"
TOLD = "(document.querySelector('#text .varied [role=status]')?.innerText ?? '')"

ASKED = "performance.getEntriesByType('resource').filter(({ name }) => name.endsWith('vary')).length"


@pytest.fixture
def asked(watched: Any, tmp_path: Path) -> Iterator[Page]:
    """The page that asks how far the pitch of the cage varies."""
    path = tmp_path / "rail.yaml"
    path.write_text(TEXT, encoding="utf-8")
    with served(path) as server:
        page = opened(watched, server)
        page.locator("#edittext").click()
        page.evaluate("(at) => cagepose.putCursor(at)", TEXT.index("0.1, 0]} # the misalignment"))
        page.get_by_role("button", name="vary this").click()
        yield page


def begin(page: Page, tolerance: float, runs: int) -> None:
    page.get_by_label("how many runs").select_option(f"{runs} runs")
    page.get_by_label(f"tolerance of {PITCH}").fill(str(tolerance))
    page.keyboard.press("Enter")


def ending(number: float) -> str:
    try:
        found = run(parse_scene(TEXT, set_values=[f"{PITCH}={number}"]))
    except SceneError:
        return "cannot begin"
    return found.verdict


def test_the_share_that_ends_as_now_is_that_of_runs_one_by_one(asked: Page) -> None:
    begin(asked, 2.0, 32)
    wait_until(asked, f"{TOLD}.includes('of 32 runs')")
    endings = [ending(0.1 - 2.0 + 4.0 * (i + 0.5) / 32) for i in range(32)]
    told = asked.locator("#text .varied [role=status]").inner_text()
    well = endings.count("rests")
    assert 0 < well < 32
    assert f"{round(100 * well / 32, 1):g} % end as now (rests): {well} of 32 runs" in told
    for verdict in set(endings) - {"rests"}:
        assert f"{endings.count(verdict)} {verdict}" in told
    assert asked.locator("#text .varied form small").inner_text() == "deg"


def test_rounding_is_no_motion_of_the_end(watched: Any, tmp_path: Path) -> None:
    """The upper roller ahead is not touched at the end: the end does not hang on its height."""
    text = next(path for path in SCENES if path.stem == "rollers").read_text(encoding="utf-8")
    path = tmp_path / "rollers.yaml"
    path.write_text(text, encoding="utf-8")
    with served(path) as server:
        page = opened(watched, server)
        page.locator("#edittext").click()
        page.evaluate("(at) => cagepose.putCursor(at)", text.index("13.5], euler"))
        page.get_by_role("button", name="vary this").click()
        page.evaluate("""() => {
            window.words = [];
            const write = CanvasRenderingContext2D.prototype.fillText;
            CanvasRenderingContext2D.prototype.fillText = function (text, ...at) {
                words.push(text);
                write.call(this, text, ...at);
            };
        }""")
        page.get_by_label("how many runs").select_option("32 runs")
        page.get_by_label("tolerance of cage.shapes[2].position[2]").fill("0.1")
        page.keyboard.press("Enter")
        wait_until(page, f"{TOLD}.includes('100 % end as now (rests): 32 of 32 runs')")
        assert "the end does not move" in page.evaluate("words")


def test_a_click_into_the_plot_puts_that_value_into_the_text(asked: Page) -> None:
    begin(asked, 0.1, 32)
    wait_until(asked, f"{TOLD}.includes('of 32 runs')")
    plot = asked.locator("#text .varied canvas")
    plot.click(position={"x": plot.bounding_box()["width"] - 14, "y": 30})
    value = 0.1 - 0.1 + 0.2 * 31.5 / 32
    assert f"euler_zyx_deg: [0, {value:.12g}, 0]}} # the misalignment" in asked.evaluate("cagepose.text()")
    wait_until(asked, "cagepose.state().drawnAnswers === 1")
    stale = asked.get_by_text("The text has been edited since")
    assert stale.is_hidden()  # it is of the study itself
    asked.evaluate("(at) => cagepose.putCursor(at)", TEXT.index("-91.5, -31.55"))
    asked.keyboard.press("Delete")
    stale.wait_for()


def test_a_study_does_not_keep_sliders_waiting_and_can_be_cancelled(
    asked: Page, monkeypatch: pytest.MonkeyPatch
) -> None:
    answer = editing.runs_with

    def slowly(*question: Any) -> Any:
        time.sleep(0.5)
        return answer(*question)

    monkeypatch.setattr(editing, "runs_with", slowly)
    begin(asked, 0.05, 512)
    wait_until(asked, f"{TOLD}.includes('are to be run')")
    began = time.perf_counter()
    slide(asked, "push: direction y", 0.1)
    print(f"a slider's answer beside a study: {time.perf_counter() - began:.2f} s")
    assert "are to be run" in asked.evaluate(TOLD)
    asked.get_by_role("button", name="cancel").click()
    told = asked.evaluate(TOLD)
    assert "cancelled; 512 were to be run" in told
    asked.wait_for_timeout(1200)
    n_asked = asked.evaluate(ASKED)
    asked.wait_for_timeout(1200)
    assert asked.evaluate(ASKED) == n_asked


def test_a_study_of_a_text_with_mistakes_says_so(watched: Any, asked: Page) -> None:
    asked.locator("#text .cm-content").press("Control+End")
    asked.keyboard.type("frict: 3")
    begin(asked, 0.05, 32)
    wait_until(asked, f"{TOLD}.includes('frict: is no known key')")
    assert asked.locator("#text .varied canvas").is_hidden()
    watched.expect("status of 422")
