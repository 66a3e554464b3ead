"""Seeded random scenes: every run ends with a name, no potential rises, nobody is ever inside."""

from __future__ import annotations

import collections

import numpy as np
import pytest

from audit.families import drawn_scenes
from audit.geometry import deepest
from cagepose import run
from quasistatic.paths import VERDICTS, again, path_of, potential
from quasistatic.random_runs import random_run

RISE = 1e-12
"""In total force times size. A potential may rise by this, its rounding over some thousand metres of sums. A rest is
put on its faces at last: out of them, where a point has sunk in by part of the touch tolerance, against the forces."""


def lifted(scene, load, phase):
    """The work, relative, of moving every contact of a rest by the touch tolerance."""
    carried = sum(contact.force_normal_n or 0.0 for contact in phase.contacts)
    total = sum(
        float(np.linalg.norm(part))
        for part in (load.gravity_world, load.force and load.force.direction)
        if part is not None
    )
    return carried / total * scene.tolerances.touch


def checked(result, number, verdicts):
    """Check every pose of the path; return (greatest rise of the potential, greatest depth), relative."""
    scene = result.scene
    verdicts[result.verdict] += 1
    assert result.verdict in VERDICTS
    rise, inside = 0.0, -np.inf
    for phase, load in zip(result.phases, scene.loads, strict=False):
        poses = path_of(phase)
        for pose in poses:
            assert np.isfinite([*pose.position_m, *pose.quaternion_wxyz]).all(), f"scene {number}"
        potentials = [potential(scene, load, pose) for pose in poses]
        rises = np.diff(potentials)
        if len(rises):
            rises[-1] -= lifted(scene, load, phase)
        rise = max(rise, float(rises.max(initial=0.0)))
        inside = max(inside, *(deepest(scene, pose) for pose in poses))
    return rise, inside


@pytest.mark.parametrize(
    ("friction", "few", "many", "nameless_share"), [(None, 100, 1500, 0.001), (0.3, 50, 500, 0.02)]
)
def test_random_scenes_end_by_name_downhill_and_outside(friction, few, many, nameless_share, say, cases):
    """``nameless_share``: runs that end "stalled" or "limit", no answer, at most; measured, see the printed line."""
    n_scenes = cases(few, many)
    verdicts: collections.Counter[str] = collections.Counter()
    rises, depths = [], []
    for number in range(n_scenes):
        result = random_run(number, friction)
        rise, inside = checked(result, number, verdicts)
        rises.append(rise)
        depths.append(inside / result.scene.tolerances.touch)
    shares = ", ".join(f"{name} {count / n_scenes:.2%}" for name, count in verdicts.most_common())
    say(
        f"{n_scenes} random scenes, friction {friction or 0.0:g}: {shares}; greatest rise of the potential"
        f" {max(rises):.1e}, deepest point {max(depths):.1e} touch tolerances"
    )
    assert max(depths) <= 1.0, f"scene {int(np.argmax(depths))}"
    assert max(rises) <= RISE, f"scenes {np.nonzero(np.array(rises) > RISE)[0].tolist()}"
    assert verdicts["stalled"] + verdicts["limit"] <= nameless_share * n_scenes


@pytest.mark.parametrize("friction", [None, 0.3])
def test_the_same_scene_gives_the_same_run_to_the_last_bit(friction):
    for scene in drawn_scenes("union", 5, seed=3):
        first, second = (run(again(scene, friction=friction), method="quasistatic") for _ in range(2))
        assert first.verdict == second.verdict
        assert np.array_equal(first.pose.quaternion_wxyz, second.pose.quaternion_wxyz)
        assert np.array_equal(first.pose.position_m, second.pose.position_m)
