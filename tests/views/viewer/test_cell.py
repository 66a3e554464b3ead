"""A run in the cell of a notebook, in a real browser with its network off: it plays when it is seen."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Frame, Page

from cagepose import load_scene, run
from cagepose.views.viewer.page import page
from cagepose.views.viewer.playback import playback
from driving import wait_until

GRIPPER = Path(__file__).resolve().parents[3] / "scenes" / "gripper.yaml"
HALF = "cagepose.state().camera.half"
"""Half of what is seen from top to bottom."""


def playing(notebook: Page, number: int) -> Frame:
    """The page in a cell, once it has drawn."""
    wait_until(notebook, f"frames[{number}].frames.length > 0 && 'cagepose' in frames[{number}].frames[0]")
    (cell,) = (frame for frame in notebook.frames if frame.name == f"cell{number}")
    inside = cell.child_frames[-1]
    wait_until(inside, "cagepose.state().drawn > 0")
    return inside


@pytest.fixture
def notebook(watched, tmp_path: Path) -> Page:
    """Two cells, of which one fits on the screen."""
    html = run(load_scene(GRIPPER))._repr_html_()
    cells = [html.replace("<iframe", f'<iframe name="cell{number}"') for number in range(2)]
    file = tmp_path / "notebook.html"
    file.write_text(
        '<!DOCTYPE html><meta charset="utf-8">' + '<div style="height:40rem"></div>'.join(cells), encoding="utf-8"
    )
    watched.page.context.set_offline(True)
    watched.page.goto(file.as_uri())
    return watched.page


def test_a_cell_plays_the_run_once_it_is_seen_and_asks_for_nothing(notebook: Page, watched) -> None:
    inside = playing(notebook, 0)
    assert inside.locator("#verdict").inner_text() == "rests"
    assert notebook.evaluate("frames[1].frames.length") == 0
    notebook.locator("iframe").nth(1).scroll_into_view_if_needed()
    assert playing(notebook, 1).locator("#verdict").inner_text() == "rests"
    assert watched.requests == [notebook.url]


def test_a_page_whose_picture_was_taken_away_begins_anew_when_it_is_seen_again(notebook: Page) -> None:
    inside = playing(notebook, 0)
    inside.evaluate("scene.getContext('webgl2').getExtension('WEBGL_lose_context').loseContext()")
    notebook.locator("iframe").nth(1).scroll_into_view_if_needed()
    playing(notebook, 1)
    notebook.locator("iframe").nth(0).scroll_into_view_if_needed()
    wait_until(notebook, "!frames[0].frames[0]?.scene?.getContext('webgl2').isContextLost()")
    playing(notebook, 0)
    assert inside.is_detached()


def test_the_wheel_goes_past_a_page_until_somebody_has_clicked_in_it(notebook: Page) -> None:
    inside = playing(notebook, 0)
    far = inside.evaluate(HALF)
    inside.locator("#scene").hover()
    notebook.mouse.wheel(0, 100)
    wait_until(notebook, "scrollY > 0")
    assert inside.evaluate(HALF) == far
    inside.locator("#scene").click(position={"x": 20, "y": 300})
    notebook.mouse.wheel(0, 100)
    wait_until(inside, f"{HALF} > {far}")


def test_the_page_in_a_cell_is_the_exported_one(notebook: Page) -> None:
    """But for its title, which nobody sees there, and the time that the run took."""
    inside = playing(notebook, 0)
    exported = page(playback(run(load_scene(GRIPPER)), "mm"))
    for wanted in ("#data", "script:not([type])"):
        text = inside.evaluate(f"document.querySelector('{wanted}').textContent")
        assert text.split('"verdict"')[-1].strip() in exported
