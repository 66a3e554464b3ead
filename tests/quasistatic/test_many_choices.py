"""Poses with more choices of faces at edges than a proof asks: what can be said then, and what not."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from cagepose import Box, Cage, Load, Object, Scene
from cagepose.kernels.contact.edges import CHOICES_LIMIT
from cagepose.runs.judge import judge_pose

CORNERS = np.array(list(itertools.product((-0.5, 0.5), repeat=3)))


def judged(points: np.ndarray, friction: float, gravity: tuple[float, float, float]):
    scene = Scene(
        Object([Box((1, 1, 1))]), Cage(points), [Load("weight", gravity=gravity)], friction_coefficient=friction
    )
    return judge_pose(scene, scene.object.pose_world_object, 0, friction)


@pytest.mark.parametrize("gravity", [(0.0, 0.0, -1.0), (0.2, 0.1, -1.0)])
def test_a_choice_that_does_not_hold_moves_with_the_twist_that_shows_it(gravity):
    """Three faces at each of eight corners, 6561 choices: the first motion is not known, its proof is."""
    assert 3 ** len(CORNERS) > CHOICES_LIMIT
    proof, _ = judged(CORNERS, 0.3, gravity)
    assert proof.verdict == "moves"
    assert proof.residual > 1e-3
    assert proof.motion is not None


def test_where_all_that_were_asked_hold_nothing_is_claimed():
    proof, _ = judged(CORNERS, 1.1, (0.0, 0.0, -1.0))  # at 1.0 it would take forces without bound
    assert (proof.verdict, proof.stability) == ("may rest", "marginal")
    assert proof.reason.endswith("too many to check all")
    assert proof.residual < 1e-9
