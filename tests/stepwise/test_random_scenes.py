"""Seeded random scenes: every run ends with a name, and nobody is ever inside.

The method is a heuristic: its turns run on through the balance point of the load, so many scenes end by name as
"spins" (a full turn) or "cycling" (a swing between poses). That is the method's limit, not a numerical one, and the
test proves it: every such run contains a turn that the load had stopped driving before its end. A few take so
many steps that they stop at the event limit, which is named too.

Whatever the rules say, what the mechanics adds must hold: contact forces are given where they balance the load, and
they do.
"""

from __future__ import annotations

import collections

import numpy as np
import pytest

from audit.balance import imbalance
from audit.families import drawn_scenes
from audit.geometry import deepest
from cagepose import PhaseRun, Run, Scene
from cagepose.kernels.algebra.record import empty_record
from cagepose.kernels.contact.metric import Body
from stepwise_run import run

VERDICTS = {"stable", "escapes", "spins", "cycling", "limit"}


def greatest_depth(result: Run) -> float:
    """The deepest that any cage point is in the part at any event, as a fraction of the scene's size."""
    events = [event for phase in result.phases for event in phase.events]
    return max(deepest(result.scene, event.pose_world_object) for event in events)


def swings_past_its_balance(result: Run) -> bool:
    """Whether the last phase has a turn at whose end the load turns the object the other way (or a full turn)."""
    phase = result.phases[-1]
    load = result.scene.loads[len(result.phases) - 1]
    direction = load.gravity_world if load.force is None else load.force.direction
    at = result.scene.object.center_of_gravity_m if load.force is None else load.force.at_object_m
    for event in phase.events:
        motion = event.motion
        if motion is not None and motion.kind == "turn":
            if motion.angle_rad > 6.28:
                return True
            arm = event.pose_world_object.transform(at) - motion.through_world
            if np.dot(np.cross(arm, direction), motion.axis_world) < 0.0:
                return True
    return False


def assert_forces_are_those_of_a_balance(scene: Scene, phase: PhaseRun) -> None:
    forces = [(contact.force_normal_n, contact.force_tangential_n) for contact in phase.contacts]
    if phase.proof.verdict == "moves":
        assert all(force == (None, None) for force in forces)
        return
    friction = np.tan(0.1)
    for normal, tangential in forces:
        assert normal >= 0.0
        assert np.linalg.norm(tangential) <= friction * normal * (1.0 + 1e-6) + 1e-9
    assert imbalance(scene, phase) < 1e-7


def ball(scene: Scene) -> Body:
    body = empty_record(Body)
    body.axes_object[:] = np.eye(3)
    body.radii[:] = scene.size_m
    body.reach_m = scene.size_m
    return body


def test_random_scenes_end_by_name_and_nobody_is_ever_inside(say, monkeypatch, cases):
    # The inertia of a union of boxes takes longer than its run, and no balance hangs on it.
    monkeypatch.setattr("cagepose.runs.cases.body_of", ball)
    n_scenes = cases(300, 20_000)
    verdicts: collections.Counter[str] = collections.Counter()
    worst, most_events = 0.0, 0
    for number, scene in enumerate(drawn_scenes("union", n_scenes, seed=20261121)):
        result = run(scene)
        verdicts[result.verdict] += 1
        assert result.verdict in VERDICTS
        for phase in result.phases:
            most_events = max(most_events, len(phase.events))
            assert_forces_are_those_of_a_balance(scene, phase)
            for event in phase.events:
                pose = event.pose_world_object
                assert np.isfinite([*pose.position_m, *pose.quaternion_wxyz]).all(), f"scene {number}"
        depth = greatest_depth(result)
        assert depth <= scene.tolerances.touch, f"scene {number}: {depth:g} of the size deep"
        worst = max(worst, depth)
        if result.verdict in ("spins", "cycling"):
            assert swings_past_its_balance(result), f"scene {number}: {result.verdict} without a swing"
    shares = ", ".join(f"{name} {count / n_scenes:.1%}" for name, count in verdicts.most_common())
    say(
        f"{n_scenes} random scenes, stepwise: {shares}; at most {most_events} events in a phase, deepest point"
        f" {worst:.1e} of the scene's size"
    )
    assert verdicts["limit"] <= 0.0005 * n_scenes


@pytest.mark.parametrize("seed", range(5))
def test_the_same_scene_gives_the_same_run_to_the_last_bit(seed):
    first, second = (run(next(iter(drawn_scenes("union", 1, seed)))) for _ in range(2))
    assert [event.rule for event in first.phases[-1].events] == [event.rule for event in second.phases[-1].events]
    assert np.array_equal(first.pose.quaternion_wxyz, second.pose.quaternion_wxyz)
    assert np.array_equal(first.pose.position_m, second.pose.position_m)
