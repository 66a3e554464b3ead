"""`run_many` against `run`, one row at a time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import cagepose
from cagepose import (
    Box,
    Cage,
    Force,
    Hole,
    Load,
    Object,
    Pose,
    Scene,
    SceneError,
    Variation,
    load_scene,
    run,
    run_many,
)
from cagepose.model.geometry import sizes_with_points
from cagepose.model.methods import METHODS
from cagepose.runs import many
from rails import rail_scene

MM = 1e-3

POSTS = [
    *[(8, 5, -3.5), (-8.2, 5.1, -3.4), (7.9, -5.3, -3.6), (-7.8, -4.9, -3.5)],
    *[(7.1, 5, 3.6), (-7, 5.2, 3.5), (6.9, -5.1, 3.4), (-7.2, -5, 3.6)],
    *[(11.5, 4, 0.5), (-11.4, -4.1, 0.4), (11.6, -3.9, -0.6), (-11.5, 4.2, -0.5)],
    *[(6, 8.6, 0.3), (-6.1, 8.5, -0.4), (6.2, -8.4, 0.2), (-5.9, -8.6, -0.3)],
]
"""Millimetres: under the block, over it, at its ends, at its sides, each about 0.5 mm away."""


def block(*, mass_kg: float | None = 0.2, magnitude_n: float | None = 3.0, **changed: Any) -> Scene:
    """A block caged by posts; each keyword of ``changed`` is one that `Variation` has."""
    points = changed.get("points_cage_m", np.array(POSTS) * MM)
    cage = Pose(changed.get("cage_position_m", (0, 0, 0)), euler_zyx=changed.get("cage_euler_zyx", (0, 0, 0)))
    start = Pose(changed.get("object_position_m", (0, 0, 0)), euler_zyx=changed.get("object_euler_zyx", (0, 0, 0)))
    force = Force(
        changed.get("force_direction_world", (1, 0.2, 0.1)),
        changed.get("force_at_object_m", (-10 * MM, 1 * MM, 2 * MM)),
        changed.get("force_magnitude_n", magnitude_n),
    )
    boxes = [Box((22 * MM, 16 * MM, 6 * MM)), Box((10 * MM, 17 * MM, 3 * MM), Pose((0, 0, 4 * MM)))]
    return Scene(
        Object(boxes, mass_kg=mass_kg, pose=start),
        Cage(points, pose=cage),
        [Load("weight", gravity=(0, 0, -9.81)), Load("push", gravity=(0, 0, -9.81), force=force)],
        friction_coefficient=changed.get("friction_coefficient", 0.1),
    )


def falling_cube(method: str | None = None) -> Scene:
    load = Load("weight", gravity=(0, 0, -1))
    return Scene(Object([Box((MM, MM, MM))]), Cage([(0, 0, 5 * MM)]), [load], method=method)


def points_moved(rng: np.random.Generator, n: int) -> np.ndarray:
    return block().cage.points_cage + rng.uniform(-0.3, 0.3, (n, len(POSTS), 3)) * MM


VARIED: dict[str, Callable[[np.random.Generator, int], np.ndarray]] = {
    "cage_position_m": lambda rng, n: rng.uniform(-0.2, 0.2, (n, 3)) * MM,
    "cage_euler_zyx": lambda rng, n: rng.uniform(-0.02, 0.02, (n, 3)),
    "points_cage_m": points_moved,
    "object_position_m": lambda rng, n: rng.uniform(-0.2, 0.2, (n, 3)) * MM,
    "object_euler_zyx": lambda rng, n: rng.uniform(-0.02, 0.02, (n, 3)),
    "friction_coefficient": lambda rng, n: rng.uniform(0.0, 0.3, n),
    "force_direction_world": lambda rng, n: rng.normal(size=(n, 3)),
    "force_at_object_m": lambda rng, n: rng.uniform(-9, 9, (n, 3)) * MM,
    "force_magnitude_n": lambda rng, n: rng.uniform(0.5, 20.0, n),
}


def assert_same(found: many.Runs, row: int, scene: Scene, method: str) -> None:
    alone = run(scene, method)
    assert found.verdict[row] == alone.verdict
    assert found.methods[row] == method
    for place, phase in enumerate(alone.phases):
        assert found.phase_verdicts[row, place] == phase.verdict
        assert found.position_m[row, place].tobytes() == phase.pose.position_m.tobytes()
        assert found.quaternion_wxyz[row, place].tobytes() == phase.pose.quaternion_wxyz.tobytes()
        assert found.euler_zyx[row, place] == pytest.approx(phase.pose.euler_zyx, abs=1e-15)
        names = {scene.cage.names[point] for point in np.flatnonzero(found.touching[row, place])}
        assert names == {contact.point for contact in phase.contacts}
    n_phases = len(alone.phases)
    assert (found.phase_verdicts[row, n_phases:] == "").all()
    assert np.isnan(found.position_m[row, n_phases:]).all()


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", VARIED)
def test_each_thing_that_varies_gives_the_runs_of_scenes_built_one_by_one(name: str, method: str) -> None:
    values = VARIED[name](np.random.default_rng(3), 8)
    found = run_many(block(), Variation(**{name: values}), method=method, threads=2)
    assert len(found) == len(values)
    assert np.isfinite(found.position_m[:, 1]).all(axis=1).mean() > 0.5  # the push matters
    for row, value in enumerate(values):
        if found.verdict[row] == "invalid":
            with pytest.raises(SceneError):
                block(**{name: value})
        else:
            assert_same(found, row, block(**{name: value}), method)


@pytest.mark.parametrize(("mass_kg", "magnitude_n"), [(None, 3.0), (0.2, None), (None, None)])
@pytest.mark.parametrize("name", ["force_magnitude_n", "force_direction_world"])
def test_weight_and_force_count_as_in_a_scene_of_its_own(
    name: str, mass_kg: float | None, magnitude_n: float | None
) -> None:
    """A mass counts in newtons as soon as the force has a magnitude, though the scene itself may give none."""
    values = VARIED[name](np.random.default_rng(6), 6)
    scene = block(mass_kg=mass_kg, magnitude_n=magnitude_n)
    found = run_many(scene, Variation(**{name: values}), method="quasistatic")
    for row, value in enumerate(values):
        alone = block(mass_kg=mass_kg, magnitude_n=magnitude_n, **{name: value})
        assert_same(found, row, alone, "quasistatic")


@pytest.mark.parametrize("method", METHODS)
def test_all_that_varies_at_once_and_in_any_order_and_number_of_threads(method: str) -> None:
    rng = np.random.default_rng(4)
    n = 40
    values = {name: draw(rng, n) for name, draw in VARIED.items()}
    found = run_many(block(), Variation(**values), method=method, threads=1)
    order = rng.permutation(n)
    again = run_many(
        block(), Variation(**{name: array[order] for name, array in values.items()}), method=method, threads=3
    )
    assert (again.verdict == found.verdict[order]).all()
    assert np.array_equal(again.position_m, found.position_m[order], equal_nan=True)
    valid = np.flatnonzero(found.verdict != "invalid")
    assert len(valid) > n // 4
    assert np.isfinite(found.position_m[valid, 1]).all(axis=1).mean() > 0.5
    for row in valid[:10]:
        assert_same(found, row, block(**{name: array[row] for name, array in values.items()}), method)


ALONE = ("friction_coefficient", "object_position_m", "object_euler_zyx", "force_direction_world", "points_cage_m")


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(("mass_kg", "magnitude_n"), [(0.2, 3.0), (None, None)])
def test_rows_among_others_have_the_bits_of_runs_alone(
    mass_kg: float | None, magnitude_n: float | None, method: str
) -> None:
    """Directions of any length, and some that are of length one already."""
    rng = np.random.default_rng(7)
    values = {name: VARIED[name](rng, 100) for name in ALONE}
    values["force_direction_world"][::3] /= np.linalg.norm(values["force_direction_world"][::3], axis=1, keepdims=True)
    values["force_direction_world"][1::3] *= 10.0 ** rng.uniform(-300, 300, (33, 1))
    scene = block(mass_kg=mass_kg, magnitude_n=magnitude_n)
    found = run_many(scene, Variation(**values), method=method, threads=2)
    valid = np.flatnonzero(found.verdict != "invalid")
    assert len(valid) > 50
    for row in valid:
        changed = {name: array[row] for name, array in values.items()}
        assert_same(found, row, block(mass_kg=mass_kg, magnitude_n=magnitude_n, **changed), method)


def test_a_run_that_could_not_begin_is_named() -> None:
    """One point inside, two points that are one, and a start far away."""
    points = np.repeat(block().cage.points_cage[None], 3, axis=0)
    points[0, 0] = 0.0
    points[1, 1] = points[1, 0]
    found = run_many(block(), Variation(points_cage_m=points), method="stepwise")
    assert found.verdict[:2].tolist() == ["invalid", "invalid"]
    assert found.verdict[2] != "invalid"
    far = run_many(block(), Variation(object_position_m=[(1e4, 0, 0), (0, 0, 0)]), method="stepwise")
    assert far.verdict[0] == "invalid"
    assert far.phase_verdicts[0].tolist() == ["invalid", ""]
    assert np.isnan(far.position_m[0]).all()


def test_several_scenes_of_different_shape_in_one_table() -> None:
    scenes = [falling_cube(), block(), rail_scene(pitch_deg=0.1)]
    found = run_many(scenes, method="stepwise", threads=2)
    assert found.verdict[0] == "escapes"
    assert found.phase_verdicts.shape == (3, 2)
    assert found.touching.shape == (3, 2, len(POSTS))
    for row, scene in enumerate(scenes):
        assert_same(found, row, scene, "stepwise")


def test_each_scene_keeps_its_own_method() -> None:
    scenes = [falling_cube(method) for method in ("quasistatic", "stepwise")]
    assert run_many(scenes).methods.tolist() == ["quasistatic", "stepwise"]


def test_progress_comes_to_one() -> None:
    shares = list[float]()
    run_many(block(), Variation(cage_euler_zyx=np.zeros((50, 3))), method="stepwise", threads=2, progress=shares.append)
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
    assert len(shares) > 5


def test_progress_is_a_bar_on_a_terminal(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    run_many(block(), method="stepwise", progress=True)
    assert capsys.readouterr().err == f"\rcagepose: {'#' * 30} 100%\n"


def test_progress_is_four_lines_at_most_in_a_pipe_or_log(capsys: pytest.CaptureFixture[str]) -> None:
    many = Variation(cage_euler_zyx=np.zeros((5000, 3)))
    run_many(block(), many, method="stepwise", threads=2, progress=True)
    lines = capsys.readouterr().err.splitlines()
    assert 2 <= len(lines) <= 4
    assert lines[-1] == "cagepose: 100%"


def test_steps_are_counted_by_steps() -> None:
    """A run joins steps of one kind to an event; its row of `run_many` counts each of them."""
    scene = load_scene("scenes/sample.yaml")
    (phase,) = run(scene, "quasistatic").phases
    n_steps = run_many(scene, method="quasistatic").n_steps[0, 0]
    assert n_steps > len(phase.events)
    assert n_steps >= sum(len(event.path) for event in phase.events)


@dataclass(frozen=True)
class Wrong:
    variation: Variation
    message: str


WRONG = {
    "shape": Wrong(Variation(cage_euler_zyx=[0.0, 0.0, 0.1]), r"cage_euler_zyx: has shape \(3,\); give n x 3 numbers"),
    "points": Wrong(Variation(points_cage_m=np.zeros((2, 3, 3))), "points_cage_m: has shape .* n x 16 x 3"),
    "rows": Wrong(
        Variation(cage_euler_zyx=np.zeros((2, 3)), friction_coefficient=[0.1] * 3),
        "friction_coefficient: has 3 rows and cage_euler_zyx 2; give one for each run",
    ),
    "nan": Wrong(
        Variation(friction_coefficient=[0.1, np.nan]),
        r"friction_coefficient: holds a number that is not finite: \[0.1, nan",
    ),
    "one nan of many": Wrong(
        Variation(friction_coefficient=[0.1] * 70 + [np.nan] * 10), r"friction_coefficient\[70\]: is nan; give a finite"
    ),
    "friction": Wrong(Variation(friction_coefficient=[0.1, -0.1]), r"friction_coefficient\[1\]: is below zero"),
    "direction": Wrong(Variation(force_direction_world=np.zeros((2, 3))), r"force_direction_world\[0\]: is zero"),
    "magnitude": Wrong(Variation(force_magnitude_n=[1.0, 0.0]), r"force_magnitude_n\[1\]: is not above zero"),
}


@pytest.mark.parametrize("wrong", WRONG.values(), ids=WRONG)
def test_what_no_scene_could_have_is_refused(wrong: Wrong) -> None:
    with pytest.raises(SceneError, match=wrong.message):
        run_many(block(), wrong.variation)


def test_calls_that_mean_nothing_are_refused() -> None:
    with pytest.raises(SceneError, match="scenes: is empty"):
        run_many([])
    with pytest.raises(SceneError, match="variation: is of one scene, and 2 are given"):
        run_many([block(), block()], Variation(friction_coefficient=[0.1]))
    with pytest.raises(SceneError, match="threads: is 0"):
        run_many(block(), threads=0)
    with pytest.raises(SceneError, match="force: varies, but the scene has 0"):
        run_many(falling_cube(), Variation(force_magnitude_n=[1.0]))
    assert cagepose.run_many is run_many


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", VARIED)
def test_arrays_that_machine_code_does_not_take_are_copied(name: str, method: str) -> None:
    """Columns first, and read-only: machine code takes rows first."""
    values = VARIED[name](np.random.default_rng(5), 2)
    otherwise = np.asfortranarray(values)
    otherwise.flags.writeable = False
    expected, found = (run_many(block(), Variation(**{name: given}), method=method) for given in (values, otherwise))
    assert np.array_equal(found.position_m, expected.position_m)
    assert np.array_equal(found.quaternion_wxyz, expected.quaternion_wxyz)


def test_a_scene_whose_points_vary_is_as_large_with_its_holes_as_one_that_is_built() -> None:
    """The touch tolerance hangs on it."""
    plate = Box((60 * MM, 60 * MM, 30 * MM), Pose((0, 0, -15 * MM)), "plate")
    bore = Hole(10 * MM, 30 * MM, in_=["plate"])
    held = Object([Box((MM, MM, MM))], pose=Pose((0, 0, 10 * MM)))
    for holes, shapes in (([bore], [plate]), ([Hole(10 * MM, 30 * MM)], []), ([], [plate]), ([], [])):
        cage = Cage([(100 * MM, 0, 0), (0, 80 * MM, 0)], shapes=shapes, holes=holes)
        scene = Scene(held, cage, [Load("weight", gravity=(0, 0, -1))])
        assert sizes_with_points(held, cage, cage.points_cage[None]).tolist() == [scene.size_m]
