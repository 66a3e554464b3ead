"""A `Run` reads its result when it is asked, and is a plain value nonetheless."""

from __future__ import annotations

import copy
import pickle
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cagepose import Box, Cage, Load, Object, Pose, Run, Scene, load_scene, run
from cagepose.model.methods import METHODS
from cagepose.runs.judge import critical_friction_at, judge_pose
from cagepose.runs.replay import replay_event

SCENES = Path(__file__).resolve().parents[2] / "scenes"
RAIL = load_scene(SCENES / "rail-pitch.yaml")


def told(found: Run) -> tuple[object, ...]:
    """What people look at, to the last digit."""
    return (
        found.verdict,
        found.warnings,
        [(e.rule, e.hit, e.contacts, e.pose_world_object.position_m.tolist()) for p in found.phases for e in p.events],
        [(c.point, c.box, c.gap_m, c.force_normal_n) for c in found.contacts],
    )


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("is_read", [False, True])
def test_a_run_goes_from_process_to_process_and_can_be_replayed_there(method, is_read):
    found = run(RAIL, method)
    if is_read:
        assert found.phases
    for other in (pickle.loads(pickle.dumps(found)), copy.deepcopy(found), copy.copy(found)):
        assert told(other) == told(found)
        assert replay_event(other, 0, 0).rule == found.phases[0].events[0].rule


def test_a_run_is_not_changed_by_later_ones():
    """They write to the same memory."""
    first = run(RAIL)
    expected = told(run(RAIL))
    other = RAIL.changed(friction_coefficient=0.3)
    for _ in range(3):
        assert told(run(other)) != expected
    assert told(first) == expected
    with pytest.raises(ValueError, match="read-only"):
        first.pose.position_m[0] = 1.0


def test_a_changed_run_has_what_was_given_and_the_rest_of_the_first():
    found = run(RAIL)
    changed = replace(found, warnings=("mind the gap",))
    assert changed.warnings == ("mind the gap",)
    assert changed.phases == found.phases
    with pytest.raises(AttributeError, match="no attribute 'verdicts'"):
        _ = found.verdicts


def test_arrays_with_columns_first_make_the_same_scene():
    points = np.array([(4, 4, 0), (4, -4, 0), (-4, -4, 0), (-4, 4, 0)]) * 1e-3
    held = Object([Box((0.01, 0.01, 0.01))], pose=Pose((0.002, 0.003, 0.01)))
    loads = [Load("g", gravity=(0, 0, -1))]
    one, other = (told(run(Scene(held, Cage(given), loads))) for given in (points, np.asfortranarray(points)))
    assert one == other


@pytest.mark.parametrize("phase", [-1, 2, 1_000_000])
def test_a_phase_that_a_scene_has_not_is_refused_at_the_door(phase):
    """Kernels check nothing: they would read what is not theirs."""
    pose = RAIL.object.pose_world_object
    with pytest.raises(IndexError, match=f"no phase {phase}"):
        judge_pose(RAIL, pose, phase, 0.0)
    with pytest.raises(IndexError, match=f"no phase {phase}"):
        critical_friction_at(RAIL, pose, phase, 0.0)
