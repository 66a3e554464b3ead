"""``cagepose run`` asked for more: the least friction that holds the part, and how much more load it stands."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from cli.test_run_command import SCENES, Command, forces, summary


@pytest.mark.parametrize(("height", "expected"), [(10, 0.4569067), (20, 0.3820166)])
def test_critical_friction_of_the_papers_pose(command: Command, sample: str, height: int, expected: float) -> None:
    changes = (f"object.boxes[0].size[2]={height}", f"object.pose.position[2]={height / 2 + 5}")
    out = command(
        "run", sample, "--method", "stepwise", "--critical-friction", *(f"--set={change}" for change in changes)
    ).out
    name, value = summary(out)["critical friction"].split(": ")
    assert name == "gravity"
    assert float(value) == pytest.approx(expected, abs=1e-7)


@pytest.mark.parametrize(
    ("scene", "changes", "expected"),
    [
        ("slope", ["friction.coefficient=0.58"], math.tan(math.radians(30.0))),
        ("ladder", [], math.tan(math.radians(15.0))),
        ("wedge", [], 0.2),
        ("pendulum", [], math.tan(math.radians(19.2307))),
    ],
)
def test_critical_friction_of_closed_forms(command: Command, scene: str, changes: list[str], expected: float) -> None:
    """Slope tan t; ladder tan(45 deg - t/2) at 60 deg; wedge d/w = 2/10; a nail carries the load at the bar's tilt."""
    out = command(
        "run", str(SCENES / f"{scene}.yaml"), "--critical-friction", *(f"--set={change}" for change in changes)
    ).out
    assert float(summary(out)["critical friction"].split(": ")[1]) == pytest.approx(expected, abs=1e-6)


def test_critical_friction_stands_in_the_document_and_is_null_where_not_asked_for(
    command: Command, sample: str
) -> None:
    asked = json.loads(command("run", sample, "--json", "--critical-friction").out)["phases"][0]["proof"]
    assert asked["critical_friction"] == 0.0
    plain = json.loads(command("run", sample, "--json").out)["phases"][0]["proof"]
    assert plain == {**asked, "critical_friction": None}


def test_the_margin_stands_in_the_table_and_in_the_document(command: Command) -> None:
    ladder = str(SCENES / "ladder.yaml")
    shown = summary(command("run", ladder, "--margin").out)
    assert shown["margin of force"].startswith("0.02242 of the load, in the weakest direction: along (0.999")
    assert shown["margin of moment"].startswith("22.42 mm times the load")
    assert "foot left 0.4652 (+ 0.1243 friction; 0.1975 to 0.7543)" in " ".join(shown["equal stiffness"].split())
    proof = json.loads(command("run", ladder, "--margin", "--json").out)["phases"][0]["proof"]
    assert proof["margin"]["force"]["certain"] == pytest.approx(0.0224, abs=1e-4)


def test_of_one_name_at_several_places_forces_and_margins_say_which(command: Command) -> None:
    """A plank leans across both edges of another one, whose top is 45 mm above the floor."""
    planks = str(SCENES / "planks.yaml")
    out = command("run", planks, "--margin", "--verbose").out
    shown = summary(out)["equal stiffness"]
    for edge, carried in (("(70, -94.1623, 45)", 0.1552), ("(70, 5.04278, 45)", 0.4927)):
        assert f"lying plank at {edge} {carried} (" in shown
        (row,) = (row for row in forces(out) if row[2] == edge)
        assert float(row[3].split()[0]) == carried
    assert "floor 0.3487 (" in shown
    margin = json.loads(command("run", planks, "--margin", "--json").out)["phases"][0]["proof"]["margin"]
    at_edge = min(margin["contacts"], key=lambda contact: contact["at"][1])
    assert at_edge["at"] == pytest.approx([70.0, -94.1623, 45.0], abs=1e-4)


def test_critical_friction_of_parts_with_their_own_says_how_much_of_each_is_enough(command: Command) -> None:
    """On a slope of 30 deg, whatever coefficient has a point that touches nothing, or no contact at all."""
    enough = math.tan(math.radians(30.0)) / 0.58
    for changes in (
        ("coefficient=0.58", "of.stop=0.1"),
        ("coefficient=0.58", "of.stop=0.9"),
        ("coefficient=0.9", "of.block=0.58"),
    ):
        asked = [f"--set=friction.{change}" for change in changes]
        found = summary(command("run", str(SCENES / "slope.yaml"), "--critical-friction", *asked).out)
        share, words = found["critical friction"].removeprefix("weight: ").split(" ", 1)
        assert words == "times each coefficient"
        assert float(share) == pytest.approx(enough, rel=1e-6)


def test_out_keeps_the_margins_that_were_asked_for(command: Command, sample: str) -> None:
    assert command("run", sample, "--margin", "--out", "run.json").code in (0, 1)
    printed = json.loads(command("run", sample, "--margin", "--json").out)
    saved = json.loads(Path("run.json").read_text(encoding="utf-8"))
    margins = [phase["proof"]["margin"] for phase in saved["phases"]]
    assert margins == [phase["proof"]["margin"] for phase in printed["phases"]]
    assert any(margins)
