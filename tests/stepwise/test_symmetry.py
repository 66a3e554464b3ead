"""A result turned, mirrored, scaled or renumbered is the same result: random scenes, event log against event log."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from audit.families import drawn_scenes
from cagepose import Pose
from mapped_scenes import KINDS, mapped
from stepwise_run import run


def log(result):
    """Rule and points hit, event for event."""
    return [
        [(event.rule, frozenset(event.hit), frozenset(event.contacts)) for event in phase.events]
        for phase in result.phases
    ]


@pytest.fixture(scope="module")
def scenes_without_ties(cases):
    """A tie is decided by convention, which a mirror or a new order of points need not respect."""
    results = [(scene, run(scene)) for scene in drawn_scenes("union", cases(40, 500), seed=11)]
    return [
        (scene, result)
        for scene, result in results
        if not any(event.note == "tie" for phase in result.phases for event in phase.events)
    ]


@pytest.mark.parametrize("kind", KINDS)
def test_the_same_scene_seen_otherwise_gives_the_same_run(kind, scenes_without_ties):
    rng = np.random.default_rng(5)
    n_compared = 0
    for scene, expected in scenes_without_ties:
        frame, scale, flip, order = Pose(), 1.0, np.ones(3), np.arange(len(scene.cage.names))
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
