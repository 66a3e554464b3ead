"""The text of a scene beside its picture, in a real browser: typing, mistakes, completion, sliders, its file."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Page

from cagepose import load_scene, run
from cagepose.files.scene_file import parse_scene
from cagepose.views.viewer import what_if
from cagepose.views.viewer.page import page as page_text
from cagepose.views.viewer.playback import playback
from cagepose.views.viewer.server import ViewServer
from driving import opened, served, shown_angles, slide, state, wait_until
from our_scenes import SCENES

RAIL = next(path for path in SCENES if path.stem == "rail-pitch")
TEXT = RAIL.read_text(encoding="utf-8")

HEAD, NEWS = ("document.querySelector('#text .head').textContent", "document.querySelector('#text .news').textContent")

PLATE = """\
name: plate
object:
  boxes: [{size: [20, 20, 1]}]
  pose: {position: [0, 0, 5]}
cage: {points: {file: points.csv}}
loads: [{name: weight, gravity: [0, 0, -1]}]
"""


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    path = tmp_path / "rail.yaml"
    path.write_text(TEXT, encoding="utf-8")
    return path


@pytest.fixture
def server(scene: Path) -> Iterator[ViewServer]:
    with served(scene) as server:
        yield server


@pytest.fixture
def sheet(watched: Any, server: ViewServer) -> Page:
    """The page with its text open."""
    page = opened(watched, server)
    page.locator("#edittext").click()
    return page


def text_of(page: Page) -> str:
    """The whole text, of which the editor draws only what is in sight."""
    return page.evaluate("cagepose.text()")


def put_cursor(page: Page, before: str, *, behind: str = "") -> None:
    """Put the cursor behind ``behind``, at the first place where ``behind`` and ``before`` stand together."""
    at = text_of(page).index(behind + before) + len(behind)
    page.evaluate("(at) => cagepose.putCursor(at)", at)


def replace(page: Page, old: str, new: str) -> None:
    """Type ``new`` in the place of ``old``."""
    put_cursor(page, old)
    for _ in old:
        page.keyboard.press("Delete")
    page.keyboard.insert_text(new)


def expected_angles(text: str) -> list[float]:
    return np.degrees(run(parse_scene(text)).pose.euler_zyx).tolist()


def test_the_picture_follows_what_is_typed(sheet: Page, scene: Path) -> None:
    replace(sheet, "0.1, 0]}\n\ncage", "0.2, 0]}\n\ncage")
    replace(sheet, "0.1, 0]} # the", "0.2, 0]} # the")
    wait_until(sheet, "cagepose.state().drawnAnswers > 0 && !cagepose.state().isBusy")
    expected = TEXT.replace("[0, 0.1, 0]", "[0, 0.2, 0]")
    assert text_of(sheet) == expected
    wait_until(sheet, "document.querySelector('[aria-label=\"cage: pitch\"][type=number]').value === '0.2'")
    assert shown_angles(sheet) == pytest.approx(expected_angles(expected), abs=1e-5)
    assert "edited, not saved" in sheet.locator("#text").inner_text()
    assert scene.read_text(encoding="utf-8") == TEXT


def test_ctrl_enter_runs_the_text_at_once(sheet: Page) -> None:
    sheet.evaluate("() => { window.setTimeout = ((wait) => (act, ms) => wait(act, ms > 100 ? 1e9 : ms))(setTimeout); }")
    put_cursor(sheet, "name:")
    sheet.keyboard.press("Control+Enter")
    wait_until(sheet, "cagepose.state().drawnAnswers === 1")


def test_a_mistake_is_told_at_its_line_and_the_last_good_picture_stays(watched: Any, sheet: Page) -> None:
    before = shown_angles(sheet)
    replace(sheet, "size: [20, 10, 30]", "size: [20, 10]")
    wait_until(sheet, "!problems.hidden")
    line = TEXT[: TEXT.index("size: [20, 10, 30]")].count("\n") + 1
    told = sheet.locator("#text .mistakes").inner_text()
    assert f"line {line} object.boxes[3].size: has 2 values; give 3" in told
    over = sheet.locator("#problems").inner_text()
    assert "The text has a mistake" in over
    assert "The picture shows the last scene that could be run" in over
    assert sheet.locator(".cm-lintRange-error").count() == 1
    assert shown_angles(sheet) == before
    watched.expect("status of 422")
    sheet.keyboard.press("Control+z")
    wait_until(sheet, "problems.hidden && cagepose.state().drawnAnswers === 1")
    assert sheet.locator(".cm-lintRange-error").count() == 0
    assert sheet.locator("#text .mistakes").inner_text() == ""


def test_keys_and_words_are_completed_and_told_from_the_schema(watched: Any, sheet: Page) -> None:
    put_cursor(sheet, "", behind=TEXT)
    sheet.keyboard.type("met")
    option = sheet.locator(".cm-tooltip-autocomplete li", has_text="method")
    option.wait_for()
    assert "How to run the scene" in sheet.locator(".cm-completionInfo").inner_text()
    sheet.wait_for_timeout(100)  # what comes up under a finger is not taken at once
    sheet.keyboard.press("Enter")
    word = sheet.locator(".cm-tooltip-autocomplete li", has_text="stepwise")
    word.wait_for()
    sheet.keyboard.type("step")
    sheet.wait_for_timeout(300)
    sheet.keyboard.press("Enter")
    wait_until(sheet, "cagepose.text().endsWith('method: stepwise')")
    wait_until(sheet, "method.innerText.startsWith('stepwise')")
    watched.expect("status of 422")  # of half a word


def test_inside_of_a_mapping_its_own_keys_are_offered_and_not_those_that_are_there(watched: Any, sheet: Page) -> None:
    put_cursor(sheet, ", size: [20, 10, 30]", behind="{name: rack")
    sheet.keyboard.type(", ")
    sheet.keyboard.press("Control+Space")
    sheet.locator(".cm-tooltip-autocomplete li").first.wait_for()
    assert sorted(sheet.locator(".cm-tooltip-autocomplete .cm-completionLabel").all_inner_texts()) == ["euler_zyx_deg"]
    sheet.keyboard.press("Escape")
    watched.expect("status of 422")  # of half a mapping


def test_a_key_tells_what_it_means(sheet: Page) -> None:
    sheet.locator("#text .cm-line", has_text="center_of_gravity").locator("span").first.hover()
    told = sheet.locator(".cm-tooltip .told")
    told.wait_for()
    assert "left out: the centroid of the union's volume" in told.inner_text()


def test_a_slider_writes_into_the_text_and_undo_takes_it_back(sheet: Page) -> None:
    slide(sheet, "cage: pitch", 0.25)
    written = text_of(sheet)
    assert "pose: {position: [0, 0, 0], euler_zyx_deg: [0, 0.25, 0]} # the misalignment" in written
    assert len(written.splitlines()) == len(TEXT.splitlines())
    assert shown_angles(sheet) == pytest.approx(expected_angles(written), abs=1e-5)
    put_cursor(sheet, "name")
    sheet.keyboard.press("Control+z")
    assert text_of(sheet) == TEXT
    wait_until(sheet, "cagepose.state().drawnAnswers === 2")
    assert sheet.get_by_label("cage: pitch", exact=True).last.input_value() == "0.1"
    assert shown_angles(sheet) == pytest.approx(expected_angles(TEXT), abs=1e-5)


def test_any_number_gets_a_slider_that_writes_into_the_text(sheet: Page) -> None:
    put_cursor(sheet, "-91.5, -31.55, -1]")
    assert "cage.points[0][0] = -91.5" in sheet.locator("#text .foot").inner_text()
    sheet.get_by_role("button", name="slider", exact=True).click()
    label = "of the text: cage.points[0][0]"
    slider = sheet.get_by_label(label, exact=True).first
    assert [float(slider.get_attribute(end)) for end in ("min", "max")] == pytest.approx([-109.8, -73.2])
    slide(sheet, label, -80)
    expected = TEXT.replace("- [-91.5, -31.55, -1]", "- [-80, -31.55, -1]", 1)
    assert text_of(sheet) == expected
    assert shown_angles(sheet) == pytest.approx(expected_angles(expected), abs=1e-5)
    put_cursor(sheet, "name: weight")  # what is typed moves the slider of the same number
    replace(sheet, "-80, -31.55", "-90, -31.55")
    wait_until(sheet, f"document.querySelector('[aria-label=\"{label}\"][type=number]').value === '-90'")
    sheet.get_by_label("remove the slider of cage.points[0][0]").click()
    assert sheet.get_by_label(label, exact=True).count() == 0
    assert text_of(sheet) == TEXT.replace("- [-91.5, -31.55, -1]", "- [-90, -31.55, -1]", 1)


def test_a_slider_finds_its_number_behind_the_mark_of_a_document(watched: Any, scene: Path) -> None:
    scene.write_text(f"# a rail\n---\n{TEXT}", encoding="utf-8")
    with served(scene) as server:
        page = opened(watched, server)
        page.locator("#edittext").click()
        put_cursor(page, "-91.5, -31.55, -1]")
        page.get_by_role("button", name="slider", exact=True).click()
        replace(page, "-91.5, -31.55", "-90, -31.55")
        label = "of the text: cage.points[0][0]"
        wait_until(page, f"document.querySelector('[aria-label=\"{label}\"][type=number]')?.value === '-90'")


def test_a_slider_that_is_added_while_another_one_is_run_leaves_that_its_value(
    sheet: Page, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(what_if, "run", lambda scene: (time.sleep(0.5), run(scene))[1])
    put_cursor(sheet, "-91.5, -31.55, -1]")
    sheet.get_by_label("cage: pitch", exact=True).last.fill("0.25")
    sheet.get_by_role("button", name="slider", exact=True).click()
    label = "of the text: cage.points[0][0]"
    wait_until(sheet, f"document.activeElement.ariaLabel === '{label}'")
    slide(sheet, label, -90)
    written = text_of(sheet)
    assert "euler_zyx_deg: [0, 0.25, 0]} # the misalignment" in written
    assert "- [-90, -31.55, -1]" in written
    assert shown_angles(sheet) == pytest.approx(expected_angles(written), abs=1e-5)


def test_what_is_typed_while_a_slider_is_run_leaves_that_its_value(
    sheet: Page, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(what_if, "run", lambda scene: (time.sleep(1.0), run(scene))[1])
    put_cursor(sheet, "-91.5, -31.55, -1]")
    sheet.get_by_label("cage: pitch", exact=True).last.fill("0.25")
    replace(sheet, "-91.5, -31.55", "-90, -31.55")
    wait_until(sheet, "cagepose.text().includes('0.25') && !cagepose.state().isBusy")
    written = text_of(sheet)
    assert "euler_zyx_deg: [0, 0.25, 0]} # the misalignment" in written
    assert "- [-90, -31.55, -1]" in written
    assert shown_angles(sheet) == pytest.approx(expected_angles(written), abs=1e-5)


def test_alt_click_gives_a_slider_and_a_number_that_has_one_gets_no_second(sheet: Page) -> None:
    n_sliders = sheet.locator("#controls input[type=range]").count()
    put_cursor(sheet, "100, 0, -20]")
    box = sheet.locator(".cm-cursor-primary").bounding_box()
    assert box
    sheet.keyboard.down("Alt")
    sheet.mouse.click(box["x"] + 4, box["y"] + box["height"] / 2)
    sheet.keyboard.up("Alt")
    assert sheet.get_by_label("of the text: object.center_of_gravity[0]", exact=True).count() == 2
    put_cursor(sheet, "0.1, 0]} # the")
    sheet.get_by_role("button", name="slider", exact=True).click()
    assert sheet.locator("#controls input[type=range]").count() == n_sliders + 1
    assert sheet.evaluate("document.activeElement.ariaLabel") == "cage: pitch"


def test_a_save_from_outside_is_taken_and_run(sheet: Page, scene: Path) -> None:
    changed = TEXT.replace("[0, 0.1, 0]", "[0, 0.2, 0]")
    scene.write_text(changed, encoding="utf-8")
    wait_until(sheet, "cagepose.state().drawnAnswers === 1")
    assert text_of(sheet) == changed
    assert shown_angles(sheet) == pytest.approx(expected_angles(changed), abs=1e-5)
    assert "as in the file" in sheet.locator("#text").inner_text()


def test_a_mistake_from_outside_is_told_with_its_line_where_the_text_is_closed(
    watched: Any, server: ViewServer, scene: Path
) -> None:
    page = opened(watched, server)
    scene.write_text(TEXT.replace("friction", "x").replace("loads:", "laods:"), encoding="utf-8")
    wait_until(page, "!problems.hidden")
    line = TEXT[: TEXT.index("loads:")].count("\n") + 1
    assert f"line {line}: laods: is no known key; did you mean loads?" in page.locator("#problems").inner_text()
    scene.write_text(TEXT, encoding="utf-8")
    wait_until(page, "problems.hidden")
    watched.expect("status of 422")


def test_a_file_of_points_that_is_written_anew_is_run(watched: Any, tmp_path: Path) -> None:
    scene = tmp_path / "plate.yaml"
    scene.write_text(PLATE, encoding="utf-8")
    points = tmp_path / "points.csv"
    points.write_text("5,0,0\n-5,4,0\n-5,-4,0\n", encoding="utf-8")
    with served(scene) as server:
        page = opened(watched, server)
        assert page.locator("#pose dd").first.inner_text() == "0, 0, 0.5 mm"
        points.write_text("5,0,1\n-5,4,1\n-5,-4,1\n", encoding="utf-8")
        wait_until(page, "cagepose.state().drawnAnswers === 1")
        assert page.locator("#pose dd").first.inner_text() == "0, 0, 1.5 mm"


def test_a_page_that_is_opened_after_a_save_has_the_new_text(watched: Any, server: ViewServer, scene: Path) -> None:
    changed = TEXT.replace("[0, 0.1, 0]", "[0, 0.2, 0]")
    scene.write_text(changed, encoding="utf-8")
    page = opened(watched, server)
    wait_until(page, "cagepose.state().drawnAnswers === 1")
    assert shown_angles(page) == pytest.approx(expected_angles(changed), abs=1e-5)


def test_a_save_from_outside_asks_where_there_are_edits_and_nothing_is_lost(sheet: Page, scene: Path) -> None:
    theirs, mine = TEXT + "# theirs\n", TEXT.replace("name: rail", "name: my rail")
    replace(sheet, "rail, pitch", "my rail, pitch")
    scene.write_text(theirs, encoding="utf-8")
    news = sheet.locator("#text .news")
    news.wait_for()
    assert "rail.yaml was changed on disk, and you have edits here that are not saved" in news.inner_text()
    assert text_of(sheet) == mine
    sheet.get_by_role("button", name="take the file's text").click()
    assert text_of(sheet) == theirs
    put_cursor(sheet, "name")
    sheet.keyboard.press("Control+z")
    assert text_of(sheet) == mine
    assert scene.read_text(encoding="utf-8") == theirs
    scene.write_text(theirs + "# once more\n", encoding="utf-8")
    sheet.get_by_role("button", name="keep mine").click()
    assert text_of(sheet) == mine
    sheet.get_by_role("button", name="save", exact=True).click()
    wait_until(sheet, "document.querySelector('#text .head').innerText.includes('as in the file')")
    assert scene.read_text(encoding="utf-8") == mine


def test_nothing_is_saved_over_another_text_before_somebody_has_chosen(watched: Any, sheet: Page, scene: Path) -> None:
    theirs, mine = TEXT + "# theirs\n", TEXT.replace("name: rail", "name: my rail")
    replace(sheet, "rail, pitch", "my rail, pitch")
    scene.write_text(theirs, encoding="utf-8")
    keep = sheet.get_by_role("button", name="keep mine")
    keep.wait_for()
    with sheet.expect_response("**/save") as answer:
        sheet.get_by_role("button", name="save", exact=True).click()
    assert answer.value.status == 422
    watched.expect("status of 422")
    assert scene.read_text(encoding="utf-8") == theirs
    keep.click()  # it is asked again
    sheet.get_by_role("button", name="save", exact=True).click()
    wait_until(sheet, f"{HEAD}.includes('as in the file')")
    assert scene.read_text(encoding="utf-8") == mine


def test_a_question_is_withdrawn_where_the_file_is_as_it_was(sheet: Page, scene: Path) -> None:
    replace(sheet, "rail, pitch", "my rail, pitch")
    scene.write_text(TEXT + "# theirs\n", encoding="utf-8")
    sheet.get_by_role("button", name="keep mine").wait_for()
    scene.write_text(TEXT, encoding="utf-8")
    sheet.locator("#text .news").wait_for(state="hidden")
    assert "edited, not saved" in sheet.evaluate(HEAD)


def test_a_question_leaves_the_view_as_it_is(sheet: Page, scene: Path) -> None:
    replace(sheet, "rail, pitch", "my rail, pitch")
    sheet.locator("#scene").hover()
    sheet.mouse.wheel(0, -600)
    half = state(sheet)["camera"]["half"]
    scene.write_text(TEXT + "# theirs\n", encoding="utf-8")
    sheet.get_by_role("button", name="keep mine").wait_for()
    assert state(sheet)["camera"]["half"] == half


def test_a_double_click_saves_once(sheet: Page, scene: Path) -> None:
    replace(sheet, "rail, pitch", "my rail, pitch")
    sheet.get_by_role("button", name="save", exact=True).dblclick()
    wait_until(sheet, f"{HEAD}.includes('as in the file')")
    sheet.wait_for_timeout(300)
    assert sheet.evaluate(NEWS) == ""
    assert scene.read_text(encoding="utf-8") == text_of(sheet)


def test_a_page_that_begins_with_values_of_the_command_knows_the_file_that_it_would_overwrite(
    watched: Any, scene: Path
) -> None:
    """As one does that is loaded anew, after a save."""
    with served(scene, ("friction.coefficient=0.3",)) as server:
        page = opened(watched, server)
        assert "edited, not saved" in page.evaluate(HEAD)
        page.wait_for_timeout(1200)
        assert page.evaluate(NEWS) == ""
        scene.write_text(TEXT + "# saved\n", encoding="utf-8")
        page = opened(watched, server)
        page.get_by_role("button", name="take the file's text").click()
        assert text_of(page) == TEXT + "# saved\n"


def test_save_as_makes_another_file_or_a_download(watched: Any, sheet: Page, scene: Path, tmp_path: Path) -> None:
    replace(sheet, "rail, pitch", "my rail, pitch")
    mine = text_of(sheet)
    sheet.get_by_role("button", name="save as …").click()
    name = sheet.get_by_label("name of the new file")
    name.fill("rail")
    name.press("Enter")
    wait_until(sheet, "document.querySelector('#text .news').innerText.includes('rail.yaml is there already')")
    watched.expect("status of 422")
    sheet.get_by_role("button", name="another name").click()
    name.fill("mine")
    name.press("Enter")
    wait_until(sheet, "document.querySelector('#text .news').innerText.includes('Saved as mine.yaml')")
    assert (tmp_path / "mine.yaml").read_text(encoding="utf-8") == mine
    assert scene.read_text(encoding="utf-8") == TEXT
    sheet.get_by_role("button", name="save as …").click()
    with sheet.expect_download() as download:
        sheet.get_by_role("button", name="download").click()
    download.value.save_as(tmp_path / "downloaded.yaml")
    assert (tmp_path / "downloaded.yaml").read_text(encoding="utf-8") == mine


def test_save_as_scene_downloads_the_text_as_it_is_typed(sheet: Page, tmp_path: Path) -> None:
    """Before it was run, too, and where it cannot be."""
    sheet.evaluate("() => { window.setTimeout = ((wait) => (act, ms) => wait(act, ms > 100 ? 1e9 : ms))(setTimeout); }")
    replace(sheet, "rail, pitch", "my rail, pitch")
    with sheet.expect_download() as download:
        sheet.get_by_role("button", name="save as scene").click()
    download.value.save_as(tmp_path / "downloaded.yaml")
    assert (tmp_path / "downloaded.yaml").read_text(encoding="utf-8") == TEXT.replace("name: rail", "name: my rail")


def test_markup_in_a_text_stays_text(watched: Any, scene: Path) -> None:
    bad = "<img src=x onerror=alert(1)></script><script>alert(2)</script>"
    scene.write_text(TEXT.replace("rail, pitch 0.1 deg", f"'{bad}'"), encoding="utf-8")
    with served(scene) as server:
        page = opened(watched, server)
        page.locator("#edittext").click()
        assert bad in text_of(page)
        replace(page, "units:", f'"{bad.replace(".", "")}":')
        wait_until(page, "!problems.hidden")
        assert "<script>alert(2)" in page.locator("#text .mistakes").inner_text()
        assert page.locator("#text img, #text .mistakes script").count() == 0
        watched.expect("status of 422")


def test_only_a_served_page_carries_the_editor(server: ViewServer) -> None:
    exported = page_text(playback(run(load_scene(RAIL)), "mm"))
    assert b"cageposeEditor=" in server.page
    assert "cageposeEditor=" not in exported
    assert "Marijn Haverbeke" not in exported


def test_keys_that_play_the_run_are_letters_in_the_text(sheet: Page) -> None:
    put_cursor(sheet, "name")
    for key in ("Home", " "):
        sheet.keyboard.press(key)
    assert state(sheet)["time"] > 0
    assert not state(sheet)["playing"]
    assert " name: rail" in text_of(sheet)
