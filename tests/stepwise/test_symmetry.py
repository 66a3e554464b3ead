"""A result turned, mirrored, scaled or renumbered is the same result: random scenes, event log against event log."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cagepose import Box, Cage, Force, Load, Object, Pose, Scene
from random_scenes import random_scenes
from stepwise_run import run


def mapped(scene, *, frame=None, scale=1.0, flip=None, order=None):
    """The same scene in another frame, at another scale, mirrored (``flip``), or with points renumbered."""
    frame = frame or Pose()
    flip = np.ones(3) if flip is None else flip

    def mapped_pose(pose):
        # A mirror M takes the rotation R to M R M: seen in mirrored boxes, it is a rotation again.
        w, x, y, z = pose.quaternion_wxyz
        signs = flip * np.prod(flip)
        return Pose(flip * pose.position_m * scale, (w, *(signs * (x, y, z))))

    held = scene.object
    boxes = [Box(box.size_m * scale, mapped_pose(box.pose_object_box), box.name) for box in held.boxes]
    points = scene.cage.points_world() * flip * scale
    order = np.arange(len(points)) if order is None else order
    loads = []
    for load in scene.loads:
        gravity = None if load.gravity_world is None else frame.rotation @ (flip * load.gravity_world)
        force = load.force and Force(
            frame.rotation @ (flip * load.force.direction), flip * load.force.at_object_m * scale
        )
        loads.append(Load(load.name, gravity=gravity, force=force))
    return Scene(
        Object(boxes, flip * held.center_of_gravity_m * scale, pose=frame @ mapped_pose(held.pose_world_object)),
        Cage(points[order], [scene.cage.names[index] for index in order], frame),
        loads,
    )


def log(result):
    """Rule and points hit, event for event."""
    return [
        [(event.rule, frozenset(event.hit), frozenset(event.contacts)) for event in phase.events]
        for phase in result.phases
    ]


@pytest.fixture(scope="module")
def scenes_without_ties(cases):
    """A tie is decided by convention, which a mirror or a new order of points need not respect."""
    results = [(scene, run(scene)) for scene in random_scenes(cases(100, 300), seed=11)]
    return [
        (scene, result)
        for scene, result in results
        if not any(event.note == "tie" for phase in result.phases for event in phase.events)
    ]


@pytest.mark.parametrize("kind", ["turned", "small", "large", "mirrored", "renumbered", "far"])
def test_the_same_scene_seen_otherwise_gives_the_same_run(kind, scenes_without_ties):
    rng = np.random.default_rng(5)
    n_compared = 0
    for scene, expected in scenes_without_ties:
        frame, scale, flip, order = Pose(), 1.0, np.ones(3), None
        if kind == "turned":
            frame = Pose(rng.uniform(-0.1, 0.1, 3), rng.normal(size=4))
        elif kind == "far":
            frame = Pose(rng.uniform(-10.0, 10.0, 3))
        elif kind in ("small", "large"):
            scale = 1e-3 if kind == "small" else 1e3
        elif kind == "mirrored":
            flip = np.array([1.0, -1.0, 1.0])
        else:
            order = rng.permutation(len(scene.cage.names))
        found = run(mapped(scene, frame=frame, scale=scale, flip=flip, order=order))
        assert found.verdict == expected.verdict
        assert log(found) == log(expected)
        seen = frame.inverse() @ found.pose
        assert_allclose(seen.position_m * flip / scale, expected.pose.position_m, atol=1e-8 * scene.size_m)
        n_compared += 1
    assert n_compared > 5
