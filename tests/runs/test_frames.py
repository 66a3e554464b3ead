"""Results as columns: those of pandas where it is installed, and the same ones without it."""

from __future__ import annotations

import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import cagepose
from cagepose.errors import MissingExtraError

SCENES = Path(__file__).resolve().parents[2] / "scenes"
RAIL = cagepose.load_scene(SCENES / "rail-pitch.yaml")


@pytest.fixture
def columns(monkeypatch: pytest.MonkeyPatch) -> None:
    """Stand for pandas by a module whose data frames are the columns that they are made of."""
    monkeypatch.setitem(sys.modules, "pandas", SimpleNamespace(DataFrame=dict))


@pytest.mark.usefixtures("columns")
@pytest.mark.parametrize("name", ["rail-pitch", "drawer", "planks"])
def test_a_run_has_a_row_for_each_event_and_for_each_contact(name: str) -> None:
    run = cagepose.run(cagepose.load_scene(SCENES / f"{name}.yaml"))
    events, contacts = run.to_frame(), run.to_frame("contacts")
    assert {len(column) for column in events.values()} == {sum(len(phase.events) for phase in run.phases)}
    assert {len(column) for column in contacts.values()} == {sum(len(phase.contacts) for phase in run.phases)}
    assert [events[key][-1] for key in ("x_m", "y_m", "z_m")] == run.pose.position_m.tolist()
    assert tuple(events[key][-1] for key in ("yaw_rad", "pitch_rad", "roll_rad")) == run.pose.euler_zyx
    assert events["verdict"][-1] == run.verdict
    assert events["contacts"][-1] == run.phases[-1].events[-1].contacts
    last = run.contacts[-1]
    assert (contacts["point"][-1], contacts["force_normal_n"][-1]) == (last.point, last.force_normal_n)
    assert last.force_tangential_n is not None
    assert contacts["force_tangential_n_y"][-1] == last.force_tangential_n[1]
    assert contacts["force_unit"][-1] == ("N" if name == "drawer" else "load")


@pytest.mark.usefixtures("columns")
def test_a_run_that_escapes_has_events_and_no_contacts() -> None:
    sample = cagepose.load_scene(SCENES / "sample.yaml")
    escaped = cagepose.run(sample.changed("loads", [{"name": "up", "gravity": [0, 0, 1]}]))
    assert escaped.to_frame()["verdict"][-1] == "escapes"
    assert escaped.to_frame("contacts") == {name: [] for name in cagepose.run(sample).to_frame("contacts")}
    with pytest.raises(ValueError, match="rows is 'all'; give 'events', 'contacts' or 'drive'"):
        escaped.to_frame("all")  # type: ignore[arg-type]


@pytest.mark.usefixtures("columns")
def test_many_runs_have_a_row_for_each_phase_that_was_reached() -> None:
    frictions = np.linspace(0.0, 0.4, 9)
    runs = cagepose.run_many(RAIL, cagepose.Variation(friction_coefficient=frictions))
    frame = runs.to_frame()
    assert runs.phases == ("weight", "push")
    assert runs.elements == RAIL.cage.names
    assert len(frame["run"]) == (runs.phase_verdicts != "").sum()
    for row, (number, phase) in enumerate(zip(frame["run"], frame["phase"], strict=True)):
        single = cagepose.run(RAIL.changed("friction.coefficient", float(frictions[number])))
        (ended,) = [of_run for of_run in single.phases if of_run.name == phase]
        assert frame["verdict"][row] == ended.verdict
        assert [frame[key][row] for key in ("x_m", "y_m", "z_m")] == ended.pose.position_m.tolist()
        touching = {name for name in runs.elements if frame[f"touches {name}"][row]}
        assert touching == {contact.point for contact in ended.contacts}


def test_points_are_followed_through_many_runs() -> None:
    runs = cagepose.run_many(RAIL, cagepose.Variation(friction_coefficient=[0.0, 0.1]))
    points = [(-0.6, 0.02, -0.06), (0.1, 0.0, 0.0), (0.0, 0.0, 0.0)]
    found = runs.points_world(points)
    assert found.shape == (2, 2, 3, 3)
    for row, friction in enumerate((0.0, 0.1)):
        for place, phase in enumerate(cagepose.run(RAIL.changed("friction.coefficient", friction)).phases):
            assert found[row, place] == pytest.approx(phase.pose.transform(points), abs=1e-15)
    with pytest.raises(cagepose.SceneError, match="points: has shape"):
        runs.points_world((0, 0, 0))


def test_scenes_of_other_names_have_numbers() -> None:
    sample = cagepose.load_scene(SCENES / "sample.yaml")
    runs = cagepose.run_many([RAIL, sample], method="quasistatic")
    assert runs.phases == ("1", "2")
    assert runs.elements == tuple(map(str, range(1, 15)))


def test_without_pandas_the_message_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    for thing in (cagepose.run(RAIL), cagepose.run_many(RAIL)):
        with pytest.raises(
            MissingExtraError, match="needs pandas, which is not installed; install it: pip install pandas"
        ):
            thing.to_frame()


def test_pandas_takes_the_columns() -> None:
    pytest.importorskip("pandas")
    run = cagepose.run(RAIL)
    assert run.to_frame().groupby("phase")["event"].max()["push"] == len(run.phases[1].events)
    greatest = max(contact.force_normal_n or 0.0 for contact in run.contacts)
    assert run.to_frame("contacts").query("phase == 'push'")["force_normal_n"].max() == greatest
    assert len(cagepose.run_many(RAIL).to_frame()) == 2
