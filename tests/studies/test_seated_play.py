"""Play about a seated pose, against a linear program of SciPy over rows that are built here, and by hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import linprog

from cagepose import load_scene, run
from cagepose.errors import SceneError
from cagepose.studies.seated_play import FARTHEST, MOST_TURN_RAD, seated_play

ROOT = Path(__file__).resolve().parents[2]
STARTER = ROOT / "src" / "cagepose" / "files" / "starter.yaml"


def rows_of(scene, pose):
    """For each cage point and box the face that it is farthest beyond: n, the point, the gap; world, metres."""
    for point, name in zip(scene.cage.points_world(), scene.cage.names, strict=True):
        for box in scene.object.boxes:
            placed = pose @ box.pose_object_box
            local = placed.rotation.T @ (point - placed.position_m)
            beyond = np.abs(local) - box.size_m / 2.0
            axis = int(beyond.argmax())
            yield name, box.name, np.sign(local[axis]) * placed.rotation[:, axis], point, beyond[axis]


@pytest.mark.parametrize(
    ("scene", "phase"), [("rail-pitch", "weight"), ("rail-pitch", "push"), ("gripper", "weight"), ("connector", "mate")]
)
def test_both_ranges_are_those_of_a_linear_program(scene, phase):
    answer = run(load_scene(ROOT / "scenes" / f"{scene}.yaml"))
    found = seated_play(answer, phase)
    ended = next(p for p in answer.phases if p.name == phase)
    cage = answer.scene.cage.pose_world_cage.rotation
    middle, reach = answer.scene.cage.points_world().mean(axis=0), 0.1
    bearing = {(c.point, c.box) for c in ended.contacts if c.force_normal_n > 1e-9}
    rows = [(n, p, gap, (name, box) in bearing) for name, box, n, p, gap in rows_of(answer.scene, ended.pose)]
    matrix = np.array([np.concatenate([cage.T @ n, cage.T @ np.cross(p - middle, n) / reach]) for n, p, _, _ in rows])
    gaps = np.array([max(gap, 0.0) for *_, gap, _ in rows])
    closed = np.array([is_bearing for *_, is_bearing in rows])
    gaps[closed] = 0.0
    arm = cage.T @ (ended.pose.position_m - middle)
    slopes = {axis: np.concatenate([e, np.cross(arm, e) / reach]) for axis, e in zip("xyz", np.eye(3), strict=True)}
    for which, equal in (("seated", matrix[closed]), ("lifted", None)):
        for name in "xyz":
            ends = getattr(found.freedoms[name], which)
            for sign, end in zip((-1.0, 1.0), ends, strict=True):
                oracle = linprog(
                    -sign * slopes[name], matrix, gaps, equal, None if equal is None else np.zeros(len(equal)),
                    bounds=[(None, None)] * 6, method="highs",
                )  # fmt: skip
                if end.value is None:
                    far = oracle.x is None or np.linalg.norm(oracle.x[3:]) / reach > 0.9 * MOST_TURN_RAD
                    assert far or np.linalg.norm(oracle.x[:3]) > 0.5 * FARTHEST * reach
                else:
                    assert end.value == pytest.approx(sign * -oracle.fun, rel=1e-6, abs=1e-9)


def test_the_starter_slides_on_its_pins_up_to_its_stops():
    answer = run(load_scene(STARTER))
    found = seated_play(answer, "gravity")
    assert found.bearing == ("pin1", "pin2", "pin3")
    x, y, z = (found.freedoms[name] for name in "xyz")
    assert (x.seated[0].value, y.seated[1].value) == (None, None)
    assert x.seated[1].value == pytest.approx(0.002)
    assert x.seated[1].stops == ("end",)
    assert y.seated[0].value == pytest.approx(-0.001)
    assert [end.value for end in z.seated] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert z.lifted[1].value is None  # it can be lifted off
    clamped = seated_play(answer)
    assert clamped.phase == "clamp"
    for ends in clamped.freedoms.values():
        assert [end.value for end in ends.seated] == pytest.approx([0.0, 0.0], abs=1e-11)


def test_a_point_of_the_object_moves_with_it():
    answer = run(load_scene(STARTER))
    found = seated_play(answer, "gravity", [(0.03, 0.0, 0.0)], [(1, 0, 0)])
    assert found.points[0].seated[1].value == pytest.approx(0.002, abs=1e-6)


@pytest.mark.parametrize(
    ("scene", "phase", "told"),
    [
        ("slope", "push", "push was not run; use one of: weight"),
        ("sample", None, "gravity has no known contact forces at its end"),
        ("drawer", None, "play"),
    ],
)
def test_what_has_not_been_seated_is_refused(scene, phase, told):
    with pytest.raises(SceneError, match=told):
        seated_play(run(load_scene(ROOT / "scenes" / f"{scene}.yaml")), phase)


def test_what_escapes_is_not_seated():
    escaping = run(load_scene(STARTER, ["loads[0].gravity=[0, 0, 1]"]))
    with pytest.raises(SceneError, match="gravity ends with escapes, not at rest: nothing seats it"):
        seated_play(escaping, "gravity")
