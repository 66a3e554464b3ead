"""How much the length of the steps shows in the end pose."""

from __future__ import annotations

import numpy as np
import pytest

from audit.geometry import farthest_move
from cagepose.runs.quasistatic import TURN_STEP_RAD
from quasistatic.paths import again, rows_at
from quasistatic.random_runs import random_run
from quasistatic.steps import run_with_steps
from rails import rail_scene


@pytest.mark.parametrize("metric", ["release", "drag"])
@pytest.mark.parametrize("play_mm", [1.0, 0.1, 0.01])
@pytest.mark.parametrize("misaligned", ["pitch_deg", "yaw_deg", "roll_deg"])
def test_the_rail_ends_in_the_same_pose_with_steps_a_quarter_as_long(misaligned, play_mm, metric):
    scene = again(rail_scene(**{misaligned: 0.1}, play_mm=play_mm), metric=metric)
    coarse, fine = (run_with_steps(scene, step).pose for step in (TURN_STEP_RAD, TURN_STEP_RAD / 4.0))
    assert farthest_move(scene, coarse, fine) * scene.size_m <= 1e-8 * play_mm * 1e-3


def is_vertex(result):
    """Whether six contacts with independent normals touch at the end, none of them on an edge."""
    scene, pose = result.scene, result.pose
    rows = rows_at(scene, pose, 1e-8 * scene.size_m)
    if len({row[0] for row in rows}) != len(rows):
        return False
    center = pose.transform(scene.object.center_of_gravity_m)
    arms = scene.cage.points_world()[[row[0] for row in rows]].reshape(-1, 3) - center
    normals = np.array([row[4] for row in rows]).reshape(-1, 3)
    wrenches = np.hstack([normals, np.cross(arms, normals) / scene.size_m])
    return len(rows) >= 6 and np.linalg.svd(wrenches, compute_uv=False)[5] > 1e-3


def compared(friction, wanted, n_scenes):
    """Distance of the ends with whole and quarter steps, in sizes, of the scenes whose rest is wanted; and how many
    ended otherwise, by verdict.
    """
    distances, n_other = [], 0
    for number in range(n_scenes):
        coarse = random_run(number, friction)
        if coarse.verdict not in ("rests", "may rest") or not wanted(coarse):
            continue
        fine = run_with_steps(coarse.scene, TURN_STEP_RAD / 4.0)
        if fine.verdict != coarse.verdict:
            n_other += 1
        else:
            distances.append(farthest_move(coarse.scene, coarse.pose, fine.pose))
    return np.array(distances), n_other


def test_isolated_rests_do_not_depend_on_the_steps(say, cases):
    """Frictionless rests on six independent contacts. A run that takes another way at a fork of its path ends at
    another rest: then nothing small is expected, and the share of these is told.
    """
    distances, n_other = compared(None, is_vertex, cases(300, 1500))
    same = distances[distances < SAME_REST]
    say(
        f"{len(distances) + n_other} rests on six contacts: {len(distances) - len(same) + n_other} ended"
        f" elsewhere with shorter steps; the others moved by at most {same.max(initial=0.0):.1e} of the size"
    )
    assert len(same) >= 5
    assert same.max() <= 1e-8 * 1e-3  # a play of a thousandth of the size
    assert len(distances) - len(same) + n_other <= 0.1 * (len(distances) + n_other)


SAME_REST = 1e-4
"""Fraction of the size. Two rests farther apart are different ones."""


def test_what_friction_leaves_to_the_path_depends_little_on_the_steps(say, cases):
    """With friction an object stops where its path leads, and the path is wrong by about the step."""
    distances, n_other = compared(0.3, lambda _: True, cases(40, 300))
    say(
        f"{len(distances)} rests with friction: with steps a quarter as long {n_other} end otherwise, half move"
        f" by less than {np.median(distances):.1e} of the size, nine of ten by less than"
        f" {np.quantile(distances, 0.9):.1e}, the worst by {distances.max():.1e}"
    )
    assert np.median(distances) <= 1e-3
