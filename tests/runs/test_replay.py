"""A step is pure: any event of a run can be made again from the state before it, compiled and as plain Python."""

from __future__ import annotations

import numpy as np
import pytest

from audit.families import drawn_scenes
from cagepose import CageposeError, Event, Run, load_run, load_scene, run, save_run
from cagepose.model.methods import METHODS
from cagepose.runs.replay import replay_event
from our_scenes import CASES, SCENES


def all_events(found: Run) -> list[tuple[int, int, Event]]:
    return [(p, e, event) for p, phase in enumerate(found.phases) for e, event in enumerate(phase.events)]


def is_same(one: Event, other: Event, *, to: float = 0.0) -> bool:
    """To the last digit, or to a fraction of metres and radians."""
    names = (one.rule, one.hit, one.contacts, one.note, len(one.path))
    if names != (other.rule, other.hit, other.contacts, other.note, len(other.path)):
        return False
    poses = zip([one.pose_world_object, *one.path], [other.pose_world_object, *other.path], strict=True)
    if any(
        np.abs(a.position_m - b.position_m).max() > to or np.abs(a.quaternion_wxyz - b.quaternion_wxyz).max() > to
        for a, b in poses
    ):
        return False
    if one.motion is None or other.motion is None:
        return one.motion is other.motion
    amounts = (one.motion.distance_m, one.motion.angle_rad), (other.motion.distance_m, other.motion.angle_rad)
    return one.motion.kind == other.motion.kind and np.allclose(*amounts, rtol=0.0, atol=to, equal_nan=True)


@pytest.mark.parametrize("method", METHODS)
def test_any_event_of_our_scenes_is_the_same_when_it_is_made_again(method):
    n_events = 0
    for scene in (load_scene(path) for path, runs in CASES if runs == method):
        if scene.cage.bodies:
            continue  # where they are is no part of a state
        found = run(scene, method)
        for phase, number, event in all_events(found):
            assert is_same(replay_event(found, phase, number), event), (scene.name, phase, number)
            n_events += 1
    assert n_events > 40


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("friction", [None, 0.3])
def test_any_event_of_random_scenes_is_the_same_when_it_is_made_again(method, friction):
    for scene in drawn_scenes("union", 30, 20261122):
        found = run(scene if friction is None else scene.changed(friction_coefficient=friction), method)
        for phase, number, event in all_events(found):
            assert is_same(replay_event(found, phase, number), event)


@pytest.mark.parametrize("method", METHODS)
def test_an_event_in_plain_python_is_that_of_machine_code_to_rounding(method):
    for name in ("sample", "rail-pitch", "connector"):
        scene = load_scene(next(path for path in SCENES if path.stem == name))
        found = run(scene, method)
        for phase, number, event in all_events(found):
            if len(event.path) > 3:
                continue  # a long slide takes plain Python a while
            assert is_same(replay_event(found, phase, number, in_python=True), event, to=1e-12 * scene.size_m)


def test_what_is_not_there_cannot_be_made_again(tmp_path):
    found = run(load_scene(SCENES[0]))
    with pytest.raises(IndexError, match="no event 999"):
        replay_event(found, 0, 999)
    with pytest.raises(IndexError, match="no event 0 in phase 7"):
        replay_event(found, 7, 0)
    save_run(found, tmp_path / "run.json")
    with pytest.raises(CageposeError, match="keeps no states"):
        replay_event(load_run(tmp_path / "run.json"), 0, 0)
