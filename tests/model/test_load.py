"""Loads that cannot be, each told with its place and what to do."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from cagepose import Cage, Force, Load, Moment, Pose, Scene, SceneError, Spring, run
from cagepose.runs.load_scaling import one_force
from sprung_scenes import cube

X, ORIGIN, AWAY = (1.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.1)
CAGE = Cage([(0.5, 0.0, 0.0)])
push = Force(X, ORIGIN, 1.0)


def scene(load: Load, mass_kg: float | None = None) -> Scene:
    return Scene(cube(mass_kg=mass_kg), CAGE, [load])


WRONG: dict[str, tuple[Callable[[], object], str]] = {
    "nothing acts": (lambda: Load("none"), "has no gravity, force, moment, spring, drive or press"),
    "force beside forces": (lambda: Load("two", force=push, forces=[push]), "forces: stands beside force"),
    "a list in the place of a force": (
        lambda: Load("two", force=[push]),
        "force: is of type list; give a cagepose.Force",
    ),
    "a force in the place of a list": (lambda: Load("two", forces=push), "forces: is of type Force; give a list"),
    "a force among springs": (lambda: Load("two", springs=[push]), r"springs\[0\]: is of type Force"),
    "two forces, one of one unit": (
        lambda: Load("two", forces=[push, Force(X, ORIGIN)]),
        r"forces\[1\].magnitude: is missing, and other loads act beside this force; give newtons",
    ),
    "a force of one unit beside a moment": (
        lambda: Load("two", force=Force(X, ORIGIN), moments=[Moment(X, 1.0)]),
        "force.magnitude: is missing",
    ),
    "a moment of nothing": (
        lambda: Moment(X, 0.0),
        "magnitude: is 0.0; a magnitude must be a finite number above zero",
    ),
    "a moment about no axis": (lambda: Moment(ORIGIN, 1.0), "direction: is zero, so it has no direction"),
    "a spring that pushes with its stiffness": (
        lambda: Spring(ORIGIN, AWAY, -1.0),
        "stiffness: is -1.0; give a finite number",
    ),
    "a spring that does nothing": (lambda: Spring(ORIGIN, AWAY, 0.0), "stiffness: is zero without a preload"),
    "a preload without end": (lambda: Spring(ORIGIN, AWAY, 1.0, math.inf), "preload: is inf; give a finite number"),
    "a spring to nowhere": (lambda: Spring(ORIGIN, (0.0, math.nan, 0.0), 1.0), "to: holds a number that is not finite"),
    "weight beside a spring, and no mass": (
        lambda: scene(Load("hang", gravity=(0, 0, -1), springs=[Spring(ORIGIN, AWAY, 1.0)])),
        r"object.mass: is missing, and gravity acts beside other loads in loads\[0\] \(hang\); give kilograms",
    ),
    "a spring whose ends meet": (
        lambda: scene(Load("none", springs=[Spring((0.01, 0, 0), (0.01, 0, 0), 1.0)])),
        r"loads\[0\].springs\[0\].to: lies where the spring holds the object at the start, so it has no direction",
    ),
}


@pytest.mark.parametrize("case", WRONG.values(), ids=WRONG.keys())
def test_what_cannot_act_is_refused(case: tuple[Callable[[], object], str]) -> None:
    make, message = case
    with pytest.raises(SceneError, match=message):
        make()


NOT_STEPWISE = {
    "springs": Load("load", springs=[Spring(ORIGIN, AWAY, 1.0)]),
    "moments": Load("load", moments=[Moment(X, 1.0)]),
    "a force that follows the object": Load("load", force=Force(X, ORIGIN, follows=True)),
    "forces that do not come to one force": Load("load", forces=[push, Force((0, 1, 0), AWAY, 1.0)]),
}


@pytest.mark.parametrize("told", NOT_STEPWISE)
def test_the_stepwise_method_names_what_it_does_not_run(told: str) -> None:
    with pytest.raises(SceneError, match=rf"loads\[0\]: 'load' has {told}.*use quasistatic") as refused:
        run(scene(NOT_STEPWISE[told]), method="stepwise")
    assert "\n" not in str(refused.value)


def test_the_stepwise_method_takes_forces_that_come_to_one() -> None:
    """Parallel ones, and ones through a point; each as the single force that they are."""
    one = Force((1, 1, 0), (0.001, 0.002, 0.003), math.sqrt(2.0))
    through_a_point = [Force(X, one.at_object_m, 1.0), Force((0, 1, 0), one.at_object_m, 1.0)]
    parallel = [Force((1, 1, 0), (0.001, 0.002, z), 0.5 * math.sqrt(2.0)) for z in (0.0, 0.006)]
    stops = Cage([(0.021, 0.005, 0.001), (0.021, -0.005, 0.002), (0.001, 0.022, 0.0), (0.0, 0.0, -0.021)])
    ends = [
        run(Scene(cube(), stops, [load]), method="stepwise").pose
        for load in (Load("one", force=one), Load("two", forces=through_a_point), Load("two", forces=parallel))
    ]
    for end in ends[1:]:
        assert np.allclose(end.position_m, ends[0].position_m, atol=1e-14)
        assert np.allclose(end.quaternion_wxyz, ends[0].quaternion_wxyz, atol=1e-13)


def test_one_force_is_found_where_the_moment_agrees_in_every_orientation() -> None:
    random = np.random.default_rng(2)
    for _ in range(50):
        points = random.normal(size=(4, 3))
        forces = random.normal(size=(4, 1)) * random.normal(size=3)
        force, point = one_force(forces, points) or (ORIGIN, ORIGIN)
        turn = Pose(ORIGIN, random.normal(size=4)).rotation
        expected = np.cross(points @ turn.T, forces).sum(axis=0)
        assert np.cross(turn @ point, force) == pytest.approx(expected, abs=1e-12 * np.abs(points).max() * 50)
        assert one_force(random.normal(size=(4, 3)), points) is None
        assert one_force(np.array([X, X]) * [[1.0], [-1.0]], points[:2]) is None
