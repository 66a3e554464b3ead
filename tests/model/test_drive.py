"""Drives of bodies, their limits and springs that ride on bodies: what they hold, and what is refused of them."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from cagepose import Cage, CageBody, Drive, Force, Load, Moment, Scene, SceneError, Spring, run
from sprung_scenes import cube

X, Z, ORIGIN = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, 0.0)
CAGE = Cage([(0.5, 0.0, 0.0)], bodies=[CageBody("mate", [(0.4, 0.0, 0.0)]), CageBody("jaw", [(-0.4, 0.0, 0.0)])])
TRAVEL, TURN = Drive(travel=X), Drive(about=Z, angle=0.5)


def scene(*loads: Load, mass_kg: float | None = None) -> Scene:
    return Scene(cube(mass_kg=mass_kg), CAGE, loads)


def test_a_leg_is_a_travel_a_turn_or_a_screw() -> None:
    assert TRAVEL.travel_m is not None
    assert TRAVEL.travel_m.tolist() == [1.0, 0.0, 0.0]
    assert (TRAVEL.about_cage, TRAVEL.through_cage_m, TRAVEL.angle_rad, TRAVEL.is_turn) == (None, None, None, False)
    turn = Drive(about=(0, 0, 2), through=(1, 2, 3), angle=-0.5)
    assert turn.about_cage is not None
    assert turn.through_cage_m is not None
    assert (turn.about_cage.tolist(), turn.through_cage_m.tolist()) == ([0, 0, 1], [1, 2, 3])
    assert (turn.travel_m, turn.angle_rad, turn.is_turn) == (None, -0.5, True)
    assert TURN.through_cage_m is not None
    assert TURN.through_cage_m.tolist() == [0.0, 0.0, 0.0]
    assert not Drive(travel=(-0.1, -0.1, 0.0), about=(1, 1, 0), angle=1).is_turn
    assert repr(TRAVEL) == "<Drive: travel (1, 0, 0) m>"
    assert repr(Drive((0, 0, 0.1), Z, angle=math.pi)) == (
        "<Drive: travel (0, 0, 0.1) m, turn 180 deg about (0, 0, 1) through (0, 0, 0) m>"
    )


def test_a_load_holds_the_legs_of_each_body() -> None:
    load = Load("dock", drive={"mate": TRAVEL, "jaw": [TURN, TRAVEL]}, stop_at=None)
    assert load.drive == {"mate": (TRAVEL,), "jaw": (TURN, TRAVEL)}
    assert (load.stop_at, load.is_weight_alone, load.needs_newtons) == (None, False, False)
    assert repr(load) == "<Load 'dock': drives mate, jaw>"
    limited = Load("dock", drive={"mate": TRAVEL}, stop_at=200)
    assert (limited.stop_at, limited.stops_at_moment, limited.needs_newtons) == (200.0, False, True)
    assert Load("turn", drive={"mate": [TURN, TURN]}, stop_at=2.0).stops_at_moment
    assert Load("weight", gravity=Z, drive={}).is_weight_alone


def wrong_drive(told: str, **given: object) -> tuple[Callable[[], object], str]:
    return lambda: Drive(**given), told  # type: ignore[arg-type]


WRONG: dict[str, tuple[Callable[[], object], str]] = {
    "no way": wrong_drive("has neither a travel nor a turn; give travel, or about and angle, or all three"),
    "no travel": wrong_drive("travel: is zero, so nothing moves; give a vector of any other length", travel=ORIGIN),
    "a travel of two numbers": wrong_drive("travel: has shape (2,); give 3 numbers", travel=(1, 0)),
    "a travel without end": wrong_drive("travel: holds a number that is not finite", travel=(math.inf, 0, 0)),
    "no angle": wrong_drive("angle: is missing beside about; give the angle of the turn", about=Z),
    "no axis": wrong_drive("about: is missing beside an angle; give the axis of the turn", angle=1.0),
    "an axis of no direction": wrong_drive("about: is zero, so it has no direction", about=ORIGIN, angle=1.0),
    "an angle of zero": wrong_drive("angle: is 0.0; a turn has a finite angle other than zero", about=Z, angle=0.0),
    "an angle that is none": wrong_drive("angle: is 'up'; a turn has a finite angle", about=Z, angle="up"),
    "an angle without end": wrong_drive("angle: is nan; a turn has a finite angle", about=Z, angle=math.nan),
    "a point of no axis": wrong_drive("through: stands without about; give the axis", travel=X, through=ORIGIN),
    "a screw that travels aslant": wrong_drive(
        "travel: is aslant to about, and a screw travels along its axis; give a list of two",
        travel=(1e-6, 0, 1),
        about=Z,
        angle=1.0,
    ),
    "a drive in no dict": (lambda: Load("dock", drive=TRAVEL), "drive: is of type Drive; give a dict of names of"),  # type: ignore[arg-type]
    "a body without a name": (lambda: Load("dock", drive={5: TRAVEL}), "drive: has the key 5; give the name of a"),  # type: ignore[dict-item]
    "a body without legs": (lambda: Load("dock", drive={"mate": []}), "drive.mate: has no legs; give at least one"),
    "a vector in the place of a drive": (
        lambda: Load("dock", drive={"mate": [X]}),  # type: ignore[list-item]
        "drive.mate[0]: is (1.0, 0.0, 0.0); give a cagepose.Drive: cagepose.Drive(travel=(1.0, 0.0, 0.0))",
    ),
    "a limit of nothing": (
        lambda: Load("weight", gravity=Z, stop_at=1.0),
        "stop_at: stands without a drive; leave it out, or drive a body of the cage",
    ),
    "a limit of zero": (
        lambda: Load("dock", drive={"mate": TRAVEL}, stop_at=0.0),
        "stop_at: is 0.0; give a finite number above zero",
    ),
    "a limit of newtons and newton metres": (
        lambda: Load("dock", drive={"mate": TRAVEL, "jaw": TURN}, stop_at=1.0),
        "stop_at: is of travels and of turns alone, and newtons are no newton metres",
    ),
    "a limit beside one unit of force": (
        lambda: Load("dock", force=Force(X, ORIGIN), drive={"mate": TRAVEL}, stop_at=1.0),
        "force.magnitude: is missing, and the drive has a limit; give newtons",
    ),
    "a limit beside a weight, and no mass": (
        lambda: scene(Load("dock", gravity=Z, drive={"mate": TRAVEL}, stop_at=1.0)),
        "object.mass: is missing, and gravity acts beside other loads in loads[0] (dock); give kilograms",
    ),
    "a body that there is not": (
        lambda: scene(Load("weight", gravity=Z), Load("dock", drive={"maet": TRAVEL})),
        "loads[1].drive.maet: is no body of the cage; did you mean mate? bodies: mate, jaw",
    ),
    "a point in the place of its body": (
        lambda: scene(Load("dock", drive={"C1": TRAVEL})),
        "loads[0].drive.C1: is no body of the cage; C1 is a point, a shape or a hole; put it into one of cage.bodies",
    ),
    "a body, and the cage has none": (
        lambda: Scene(cube(), Cage([(0.5, 0, 0)]), [Load("dock", drive={"mate": TRAVEL})]),
        "loads[0].drive.mate: is no body of the cage; it has none; give it in cage.bodies",
    ),
    "a spring to a body that there is not": (
        lambda: scene(Load("hang", springs=[Spring(ORIGIN, X, 1.0), Spring(ORIGIN, X, 1.0, of="jaws")])),
        "loads[0].springs[1].of: is 'jaws', no body of the cage; did you mean jaw? bodies: mate, jaw",
    ),
    "a spring to what is no name": (
        lambda: Spring(ORIGIN, X, 1.0, of=5),  # type: ignore[arg-type]
        "of: is 5; give text",
    ),
    "a spring of a body whose ends meet": (
        lambda: Scene(
            cube(),
            Cage(bodies=[CageBody("jaw", [(0.5, 0, 0)])]),
            [Load("none", springs=[Spring((0.01, 0, 0), (0.01, 0, 0), 1.0, of="jaw")])],
        ),
        "loads[0].springs[0].to: lies where the spring holds the object at the start",
    ),
}


@pytest.mark.parametrize("case", WRONG.values(), ids=WRONG.keys())
def test_what_drives_nothing_is_refused_with_its_place(case: tuple[Callable[[], object], str]) -> None:
    make, told = case
    with pytest.raises(SceneError) as refused:
        make()
    assert told in str(refused.value)
    assert len(refused.value.problems) == 1


def test_all_that_is_wrong_with_the_loads_is_told_at_once() -> None:
    with pytest.raises(SceneError) as refused:
        scene(
            Load("one", drive={"a": TRAVEL, "b": TRAVEL}),
            Load("two", gravity=Z, springs=[Spring(ORIGIN, ORIGIN, 1.0, of="c"), Spring(ORIGIN, ORIGIN, 1.0)]),
        )
    places = [str(problem).split(":")[0] for problem in refused.value.problems]
    springs = "loads[1].springs"
    assert places == ["loads[0].drive.a", "loads[0].drive.b", f"{springs}[0].of", "object.mass", f"{springs}[1].to"]


def test_the_stepwise_method_drives_nothing() -> None:
    driven = scene(Load("push", force=Force(X, ORIGIN)), Load("dock", gravity=Z, drive={"mate": TRAVEL}))
    with pytest.raises(SceneError) as refused:
        run(driven, method="stepwise")
    told = "'dock' drives a body, which only the quasistatic method does; use quasistatic"
    assert str(refused.value) == f"loads[1].drive: {told}"
    with pytest.raises(SceneError, match="which only the quasistatic method does"):
        run(scene(Load("dock", moments=[Moment(X, 1.0)], drive={"mate": TRAVEL})), method="stepwise")


def test_a_screw_may_be_aslant_by_rounding() -> None:
    rng = np.random.default_rng(3)
    for axis in rng.normal(size=(50, 3)):
        Drive(axis * rng.uniform(-1e-3, 1e3), about=axis, angle=1.0)
