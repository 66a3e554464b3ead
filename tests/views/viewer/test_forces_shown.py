"""Forces on the page and in pictures: arrows to the scale of their phase, beside them what the command's table has."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Page

from cagepose import Box, Cage, Load, Object, Pose, Scene, load_scene, run
from cagepose.cli.app import main
from cagepose.views.viewer.look import FORCE, SHORTEST_FORCE
from cagepose.views.viewer.page import page
from cagepose.views.viewer.picture import PictureMaker
from cagepose.views.viewer.playback import Playback, playback
from cagepose.views.viewer.stage import Stage
from driving import state, wait_until

SCENES = Path(__file__).resolve().parents[3] / "scenes"


def film(name: str) -> Playback:
    return playback(run(load_scene(SCENES / f"{name}.yaml")), shots_per_motion=4)


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


def test_arrows_are_to_the_scale_of_their_phase_and_small_ones_are_seen(opened):
    """The push of the plate presses with 22.5 N, its weight with 0.34 N at most."""
    shown = film("plate-on-pins")
    tab, maker = opened(shown), PictureMaker(Stage(shown))
    for which, phase in enumerate(shown.run.phases):
        tab.locator("#phases button").nth(which).click()
        last = next(shot for shot in reversed(shown.shots) if shot.phase == which)
        wait_until(tab, f"cagepose.state().drawnTime === {shown.shots.index(last)}")
        forces = np.array([contact.force_normal_n for contact in phase.contacts])
        expected = np.where(forces > 1e-9, np.maximum(FORCE * forces / forces.max(), SHORTEST_FORCE), 0.0)
        assert expected.max() == FORCE
        assert state(tab)["arrows"] == pytest.approx(expected.tolist(), rel=1e-3, abs=1e-6)
        pose = maker.stage.pose(last.pose_world_object, maker._look(last))
        drawn = np.linalg.norm(maker._arrows(last, pose), axis=1)
        assert drawn == pytest.approx(expected, rel=1e-3, abs=1e-6)


def test_the_list_and_the_arrows_have_the_numbers_of_the_commands_table(opened, capsys):
    shown = film("drawer")
    assert main(["run", str(SCENES / "drawer.yaml")]) == 0
    printed = set(re.findall(r"[\d.]+ \+ [\d.]+ friction", capsys.readouterr().out))
    tab = opened(shown)
    assert tab.locator("#forceunit").inner_text() == "N: normal + friction; bars and arrows: both together"
    listed = tab.locator("#forces td:nth-child(2)").all_inner_texts()
    assert len(listed) == 5
    assert set(listed) < printed
    at_arrows = [name["force"] for name in state(tab)["written"] if name.get("force")]
    assert sorted(at_arrows) == sorted(f"{words.removesuffix(' friction')} N" for words in listed)
    maker = PictureMaker(Stage(shown))
    maker.picture(shown.shots[-1])
    assert sorted(label.force for label in maker.labels if label.force) == sorted(at_arrows)
    tab.locator("#forces tr").first.click()
    wait_until(tab, "!card.hidden")
    assert "72.28 + 9.757 friction N" in tab.locator("#cardlines").inner_text()
    assert "72.93 N" in tab.locator("#cardlines").inner_text()


@pytest.mark.parametrize(("name", "words"), [("rail-pitch", "indeterminate"), ("drawer-jams", "any size")])
def test_what_the_command_says_of_the_forces_stands_below_the_list(opened, capsys, name, words):
    assert main(["run", str(SCENES / f"{name}.yaml")]) in (0, 1)
    shown, printed = film(name), " ".join(capsys.readouterr().out.split())
    listed = opened(shown).locator("#forces tr:not(:has(td + td))").all_inner_texts()
    notes = [line for line in listed if words in line]
    assert len(notes) == 1
    assert f"{shown.run.phases[-1].name}: {notes[0]}" in printed


def test_shares_of_the_load_are_told_without_a_unit(opened):
    tab = opened(film("rail-pitch"))
    assert tab.locator("#forceunit").inner_text() == "parts of the load"
    forces = {name["text"]: name["force"] for name in state(tab)["written"] if name.get("force")}
    assert forces["C3"] == "0.3431"
    assert forces["C1"] == "0.002513"  # the least of all has its arrow and its number, too


def test_contacts_of_the_same_two_are_told_apart_by_their_places(opened):
    """A block stands with four corners on a table."""
    table, load = Box((0.2, 0.2, 0.02), name="table"), Load("weight", gravity=(0, 0, -9.81))
    block = Object([Box((0.04, 0.03, 0.02), name="block")], mass_kg=1.0, pose=Pose((0.0, 0.0, 0.02)))
    tab = opened(playback(run(Scene(block, Cage(shapes=[table]), [load]))))
    names = tab.locator("#forces tr:has(td + td) td:first-child").all_inner_texts()
    places = {f"table on block at ({x}, {y}, 10)" for x in (-20, 20) for y in (-15, 15)}
    assert len(names) >= 2
    assert len(set(names)) == len(names)
    assert set(names) <= places
    tab.locator("#forces tr").nth(1).click()
    wait_until(tab, "!card.hidden")
    assert tab.locator("#cardname").inner_text() == names[1]
    assert [name["text"] for name in state(tab)["written"] if name.get("force")] == ["table"] * len(names)
