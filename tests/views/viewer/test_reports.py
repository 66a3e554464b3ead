"""Reports in a real browser with its network off: they begin with a picture, and play the runs that they link to."""

from __future__ import annotations

from pathlib import Path

import pytest
import trimesh
from playwright.sync_api import Frame, Page

from cagepose import Study, save_scene
from cagepose.cli.app import main
from cagepose.sampling import report
from driven.pins_into_plates import pins_into_a_plate
from driving import wait_until
from our_studies import RAIL


def opened_run(tab: Page) -> Frame:
    """The page that is open over a report, once it has drawn."""
    wait_until(tab, "frames.length === 1 && 'cagepose' in frames[0]")
    wait_until(tab.frames[1], "cagepose.state().drawn > 0")
    return tab.frames[1]


def begins_with_a_picture(tab: Page) -> bool:
    """Whether a picture is above the first headline."""
    is_drawn = tab.locator("h1 ~ figure img").evaluate("(image) => image.complete && image.naturalWidth === 900")
    return is_drawn and tab.locator("h2 ~ figure img").count() == 0


def fits_a_phone(tab: Page) -> bool:
    """Whether nothing sticks out of the page where it is narrow: tables scroll by themselves."""
    tab.set_viewport_size({"width": 390, "height": 844})
    width = tab.evaluate("document.documentElement.scrollWidth")
    tables = tab.evaluate("[...document.querySelectorAll('table')].map((one) => one.parentElement.className)")
    return width <= 390 and set(tables) == {"scroll"}


def test_the_report_of_a_study_plays_its_worst_runs(watched, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(report, "figure_bytes", lambda *_: b"<svg></svg>")
    vary = {"cage.pose.euler_zyx_deg[1]": {"uniform": [-0.2, 0.2]}}
    results = Study(RAIL, vary, {"runs": 16, "seed": 1}).run(tmp_path)
    worst = results.report()["chosen_runs"][0]
    file, tab = tmp_path / "report.html", watched.page
    assert file.stat().st_size < 600_000
    tab.context.set_offline(True)
    tab.goto(file.as_uri())
    assert begins_with_a_picture(tab)
    assert len(tab.frames) == 1

    tab.get_by_role("link", name="worst 1").click()
    ended = {row["run"]: row for row in results.table().to_pylist()}[worst["run"]]
    angles = opened_run(tab).locator("#pose dd").nth(1).inner_text().removesuffix(" deg").split(", ")
    assert [float(angle) for angle in angles] == pytest.approx(
        [ended[name] for name in ("yaw_deg", "pitch_deg", "roll_deg")], rel=1e-5
    )
    tab.go_back()
    wait_until(tab, "!played.open && frames.length === 0")

    tab.goto(f"{tmp_path.as_uri()}/{worst['page']}")
    opened_run(tab)
    tab.get_by_role("button", name="back to the report").click()
    wait_until(tab, "!played.open && frames.length === 0 && location.hash === ''")
    assert set(watched.requests) == {file.as_uri()}
    assert fits_a_phone(tab)


def test_the_page_of_an_insertion_plays_runs_from_just_beyond_what_is_permitted(watched, tmp_path: Path) -> None:
    save_scene(pins_into_a_plate((-40.0, 40.0)), tmp_path / "plate.yaml")
    file, tab = tmp_path / "report.html", watched.page
    assert main(["insertion", str(tmp_path / "plate.yaml"), "--along", "z,yaw", "--report", str(file)]) == 0
    assert file.stat().st_size < 600_000
    tab.context.set_offline(True)
    tab.goto(file.as_uri())
    assert begins_with_a_picture(tab)
    assert tab.locator("tr", has_text="yaw").locator("td").all_inner_texts() == [
        *("yaw", "deg", "-1.211", "1.211", "blocked play", "blocked play")
    ]
    tab.locator("tr", has_text="yaw").get_by_role("link").last.click()
    inside = opened_run(tab)
    assert inside.locator("#verdict").inner_text() == "blocked"
    assert tab.locator("#played b").inner_text() == "yaw above"
    assert set(watched.requests) == {file.as_uri()}
    assert fits_a_phone(tab)


def test_the_page_of_an_import_has_the_source_left_and_ours_right_from_above_and_from_below(
    watched, tmp_path: Path
) -> None:
    trimesh.creation.box((40.0, 30.0, 10.0)).export(tmp_path / "plate.stl")
    trimesh.creation.box((10.0, 10.0, 20.0)).apply_translation((0, 0, 20)).export(tmp_path / "pin.stl")
    files = ["--object", str(tmp_path / "pin.stl"), "--cage", str(tmp_path / "plate.stl")]
    page, tab = tmp_path / "page.html", watched.page
    assert main(["import", *files, "-o", str(tmp_path / "scene.yaml"), "--report", str(page)]) == 0
    tab.goto(page.as_uri())
    for figure in tab.locator("figure").all():
        boxes = [image.bounding_box() for image in figure.locator("img").all()]
        assert len(boxes) == 4
        for left, right in (boxes[:2], boxes[2:]):
            assert left["y"] == right["y"]
            assert left["x"] + left["width"] <= right["x"]
        assert boxes[0]["y"] + boxes[0]["height"] <= boxes[2]["y"]
        above, below = (figure.locator("img").nth(which).get_attribute("src") for which in (0, 2))
        assert above != below
    assert fits_a_phone(tab)
