"""The exported page, in a real browser with its network off: what it shows is what the run says."""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import ImageColor

from cagepose import Cage, Scene, load_scene, run
from cagepose.files.write import MADE_BY
from cagepose.runs.changes import mode_of
from cagepose.views.viewer.caption import VERDICT_INK
from cagepose.views.viewer.page import page
from cagepose.views.viewer.playback import playback
from cagepose.views.viewer.stage import EXAGGERATIONS, Stage
from driving import set_range, state, wait_until

SCENES = Path(__file__).resolve().parents[3] / "scenes"


@pytest.fixture(scope="module")
def rail():
    return playback(run(load_scene(SCENES / "rail-pitch.yaml", ["friction.coefficient=0.1"])))


@pytest.fixture
def opened(watched, tmp_path) -> Callable:
    """Write a playback's page to a file and open it with the network off."""

    def open_page(film):
        file = tmp_path / "run.html"
        file.write_text(page(film), encoding="utf-8")
        watched.page.context.set_offline(True)
        watched.page.goto(file.as_uri())
        wait_until(watched.page, "cagepose.state().drawn > 0")
        assert watched.requests == [file.as_uri()]
        return watched.page

    return open_page


def test_the_page_opens_at_the_end_with_the_verdict_and_the_forces(opened, rail):
    page = opened(rail)
    assert page.title() == rail.run.scene.name
    assert page.locator("#verdict").inner_text() == "rests"
    assert state(page)["time"] == len(rail.shots) - 1
    shown = {}
    for line in page.locator("#forces tr:has(td + td)").all():
        name, force = line.locator("td").all_inner_texts()[:2]
        shown[name] = float(force)
    assert shown == {
        f"{contact.point} on {contact.box}": pytest.approx(contact.force_normal_n, rel=1e-3)
        for contact in rail.run.contacts
        if contact.force_normal_n > 1e-9
    }
    idle = len(rail.run.contacts) - len(shown)
    assert page.locator("#forces tr").last.inner_text() == f"{idle} more without a force"
    origin = page.locator("#pose dd").first.inner_text()
    assert [float(word) for word in origin.removesuffix(" mm").split(", ")] == pytest.approx(
        (rail.run.pose.position_m * 1000.0).tolist(), rel=1e-5
    )
    assert "rests (stable): the contacts balance the load without friction" in page.locator("#notes").inner_text()


def test_what_only_may_rest_has_a_colour_of_its_own_on_the_page_and_in_pictures(opened):
    page = opened(playback(run(load_scene(SCENES / "wedge.yaml"))))
    assert page.locator("#verdict").inner_text() == "may rest"
    color = page.locator("#verdict").evaluate("element => getComputedStyle(element).color")
    assert color == "rgb({}, {}, {})".format(*ImageColor.getrgb(VERDICT_INK["open"]))
    assert VERDICT_INK["open"] != VERDICT_INK["rest"]
    assert page.locator("#events .open").inner_text().endswith("may rest")


def test_every_event_has_a_line_and_a_click_goes_to_its_end(opened, rail):
    page = opened(rail)
    lines = page.locator("#events tbody tr")
    assert lines.count() == len(rail.rows)
    before = frozenset[str]()
    for index, row in enumerate(rail.rows):
        lines.nth(index).click()
        wait_until(page, f"cagepose.state().drawnTime === {row.last_shot}")
        assert lines.nth(index).get_attribute("class").split()[-1] == "now"
        cells = lines.nth(index).locator("td").all_inner_texts()
        event, after = row.event, frozenset(row.event.contacts)
        assert (cells[2], set(cells[5].split()), set(cells[6].split())) == (
            mode_of(event.rule),
            after - before,
            before - after,
        )
        assert lines.nth(index).get_attribute("title") == f"touching: {', '.join(event.contacts)}"
        before = after


def test_steps_go_from_event_to_event_and_stop_at_both_ends(opened, rail):
    page = opened(rail)
    page.keyboard.press("Home")
    seen = [state(page)["time"]]
    for _ in range(len(rail.rows) + 1):
        page.locator("#next").click()
        seen.append(state(page)["time"])
    ends = [row.last_shot for row in rail.rows]
    assert seen == [0, *ends, ends[-1]]
    page.locator("#back").click()
    assert state(page)["time"] == ends[-2]
    page.locator("#first").click()
    page.locator("#back").click()
    assert state(page)["time"] == 0


def test_play_runs_from_the_start_to_the_end_and_pause_holds_it(opened):
    page = opened(playback(run(load_scene(SCENES / "sample.yaml")), shots_per_motion=12))
    page.locator("#play").click()
    wait_until(page, "cagepose.state().time > 3")
    page.locator("#play").click()
    held = state(page)
    assert not held["playing"]
    page.wait_for_timeout(200)
    assert state(page)["time"] == held["time"] < page.evaluate("Number(time.max)")
    page.locator("#play").click()
    wait_until(page, "cagepose.state().time === Number(time.max) && !cagepose.state().playing")


@pytest.mark.parametrize("exaggeration", [1, 20, 200])
@pytest.mark.parametrize("shot", [0, 30, 52, 120])
def test_scrubbing_shows_the_pose_and_the_points_of_that_shot(opened, rail, shot, exaggeration):
    """The page works with the formulas that the pictures use, written once more in another language."""
    page = opened(rail)
    set_range(page, "time", shot)
    set_range(page, "exaggeration", EXAGGERATIONS.index(exaggeration))
    shown = state(page)
    stage = Stage(rail)
    phase = rail.shots[shot].phase
    asked = [float(exaggeration) if index == phase else k for index, k in enumerate(stage.proposed)]
    look = stage.look(shot, asked)
    assert shown["factor"] == pytest.approx(look.factor, abs=1e-12)
    pose = stage.pose(rail.shots[shot].pose_world_object, look)
    assert shown["shownPose"]["p"] == pytest.approx(stage.place(pose.position_m).tolist(), abs=1e-12)
    assert np.abs(np.dot(shown["shownPose"]["q"], pose.quaternion_wxyz)) == pytest.approx(1.0, abs=1e-12)
    assert np.array(shown["points"]) == pytest.approx(stage.place(stage.points(look)), abs=1e-12)


def test_a_shot_looks_the_same_when_one_comes_back_to_it(opened, rail):
    """No picture leaves anything behind for the next one, such as how near its things were."""
    page = opened(rail)
    seen = []
    for shot in (len(rail.shots) - 1, 0, len(rail.shots) - 1):
        set_range(page, "time", shot)
        wait_until(page, f"cagepose.state().drawnTime === {shot}")
        seen.append(page.evaluate("scene.toDataURL()"))
    assert seen[0] == seen[2] != seen[1]


def test_all_contacts_of_the_rail_are_named_and_no_name_covers_another(opened, rail):
    page = opened(rail)
    written = state(page)["written"]
    assert {contact.point for contact in rail.run.contacts} < {name["text"] for name in written}
    for one, other in itertools.combinations(written, 2):
        apart = np.abs(np.subtract(one["corner"], other["corner"]))
        left, upper = (
            sorted((one, other), key=lambda name: name["corner"][0])[0],
            min(one, other, key=lambda name: name["corner"][1]),
        )
        assert apart[0] >= left["size"][0] or apart[1] >= upper["size"][1]


def test_of_a_crowd_of_contacts_those_that_press_are_named(opened, crowded):
    film = playback(run(crowded), shots_per_motion=4)
    page = opened(film)
    pressing = {contact.point for contact in film.run.contacts if contact.force_normal_n > 1e-9}
    assert len(pressing) < 15 < len(film.run.contacts)
    assert {name["text"] for name in state(page)["written"]} <= {*pressing, "weight"}


def test_everything_stays_in_view_at_every_exaggeration(opened, rail):
    page = opened(rail)
    width, height = page.evaluate("[labels.width, labels.height]")
    for exaggeration in (1, 20, 200):
        set_range(page, "exaggeration", EXAGGERATIONS.index(exaggeration))
        wait_until(page, f"cagepose.state().drawnExaggeration === {exaggeration}")
        places = np.array(page.evaluate("cagepose.fitted()"))
        assert (places > 0.0).all()
        assert (places < [width, height]).all()


def test_exaggeration_is_marked_on_the_screen(opened, rail):
    page = opened(rail)
    assert state(page)["exaggeration"] == Stage(rail).proposed[-1] > 1
    assert page.locator("#badge").inner_text() == f"play and gaps exaggerated \u00d7{Stage(rail).proposed[-1]}"
    set_range(page, "exaggeration", 0)
    wait_until(page, "badge.innerText === 'true scale'")


@pytest.mark.parametrize(
    ("scene", "verdict", "told"),
    [
        ("pendulum", "spins", "weight: spins after event 2: a full turn meets nothing"),
        ("wedge", "cycling", "weight: cycling after event 10: its pose is that of event 8, so it would repeat"),
    ],
)
def test_a_run_that_fails_tells_where_and_opens_there(opened, scene, verdict, told):
    film = playback(run(load_scene(SCENES / f"{scene}.yaml"), "stepwise"))
    page = opened(film)
    assert page.locator("#verdict").inner_text() == verdict
    assert page.locator("#verdict").get_attribute("class") == "failure"
    lines = page.locator("#events tbody tr")
    assert [line for line in range(lines.count()) if lines.nth(line).locator("td.failure").count()] == [
        len(film.rows) - 1
    ]
    assert lines.last.get_attribute("class").split()[-1] == "now"
    assert lines.last.locator("td.failure").inner_text() == f"turn, {verdict}"
    assert told in page.locator("#notes").inner_text()


def test_names_that_are_markup_stay_text(opened):
    scene = load_scene(SCENES / "ladder.yaml")
    name = "</script><script>throw 1</script> & <b>"
    named = Scene(scene.object, Cage(scene.cage.points_cage, ["<i>1", "2", "3", "4"]), scene.loads, name=name)
    page = opened(playback(run(named)))
    assert page.title() == page.locator("#name").inner_text() == name
    assert page.locator("i, b").count() == 0


def test_the_page_is_marked_as_ours_and_names_no_outside_address(rail):
    text = page(rail).replace("http://www.w3.org/1999/xhtml", "")  # a name of three.js for elements, no address
    assert MADE_BY in text
    assert "http:" not in text
    assert "https:" not in text
    json.loads(text.split('id="data">')[1].split("</script>")[0])
