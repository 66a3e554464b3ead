"""A plate on thousands of points: what is proven of it takes time in proportion to them, not to their square."""

from __future__ import annotations

import numpy as np
import pytest

import cagepose
from cagepose import Box, Cage, Load, Object, Pose, Scene
from cagepose.kernels.native.library import kernel_library

MOST_S = 1.0
SIDE = 100

pytestmark = pytest.mark.skipif(kernel_library() is None, reason="plain Python takes minutes")


def plate(center: tuple[float, float, float], friction: float, down: tuple[float, float, float] = (0, 0, -1)) -> Scene:
    """A plate of 0.22 m flush on a square of points, which is 0.1 m wide to each side of its middle."""
    along = np.linspace(-0.1, 0.1, SIDE)
    x, y = np.meshgrid(along, along)
    points = np.column_stack([x.ravel(), y.ravel(), np.zeros(SIDE**2)])
    held = Object([Box((0.22, 0.22, 0.01))], center, pose=Pose((0, 0, 0.005)))
    return Scene(held, Cage(points), [Load("weight", gravity=down)], friction_coefficient=friction)


@pytest.mark.parametrize(
    ("center", "friction", "down", "verdict", "stability"),
    [
        ((0.013, 0.021, 0.0), 0.0, (0, 0, -1), "rests", "marginal"),
        ((0.013, 0.021, 0.0), 0.3, (0, 0, -1), "rests", "stable"),
        ((0.013, 0.021, 0.0), 0.3, (0.05, 0, -1), "may rest", "stable"),
        ((0.1, 0.0, 0.0), 0.0, (0, 0, -1), "rests", "unstable"),
        ((0.1, 0.0, 0.0), 0.3, (0, 0, -1), "rests", "unstable"),
        ((0.1, 0.1, 0.0), 0.3, (0, 0, -1), "rests", "unstable"),
    ],
    ids=["smooth", "rough", "tilted", "over the outline, smooth", "over the outline", "over a corner"],
)
def test_ten_thousand_flush_contacts_are_judged_within_a_second(center, friction, down, verdict, stability):
    """Over the outline the weight can tip the plate, its centre of gravity being above the points."""
    scene = plate(center, friction, down)
    runs = [cagepose.run(scene) for _ in range(3)]
    (phase,) = runs[0].phases
    assert (runs[0].verdict, phase.proof.stability, len(runs[0].contacts)) == (verdict, stability, SIDE**2)
    assert min(run.solve_s for run in runs) < MOST_S
