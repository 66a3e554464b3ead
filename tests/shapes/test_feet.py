"""Where on an arc an edge or another rim is nearest: all such places, also two that are about to be one."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cagepose.kernels.algebra.record import empty_rows
from cagepose.kernels.shapes.features import EDGE, RIM, Feature
from cagepose.kernels.shapes.feet import feet_on
from cagepose.kernels.shapes.rims import SEARCHED


def arc(center: tuple, axis: np.ndarray, toward: np.ndarray, radius: float) -> Feature:
    made = empty_rows(Feature, 1)[0]
    made.kind, made.length = RIM, radius
    for k in range(3):
        made.point[k], made.direction[k], made.toward[k] = center[k], axis[k], toward[k]
    return made


def sampled_feet(center: tuple, axis: np.ndarray, radius: float) -> list[float]:
    """Angles along the arc of the unit circle about x where its distance from another circle is least."""
    angles = np.linspace(-SEARCHED, SEARCHED, 200_001)
    seen = np.stack([np.cos(angles), np.sin(angles), 0.0 * angles], axis=1) - np.array(center)
    height = seen @ axis
    distance = np.hypot(height, np.linalg.norm(seen - height[:, None] * axis, axis=1) - radius)
    inner = (distance[1:-1] < distance[:-2]) & (distance[1:-1] <= distance[2:])
    return list(angles[1:-1][inner])


@pytest.mark.parametrize(
    ("center", "axis", "radius"),
    [
        ((0.6403, 0.1647, 0.0864), (0.24, 0.058, 0.969), 0.35),
        ((0.6239, 0.029, 0.0419), (0.109, 0.021, 0.994), 0.38),
        ((-1.1179, 0.2036, -0.1289), (-0.059, 0.012, 0.998), 2.14),
        ((0.2835, -0.1084, 0.0633), (0.083, -0.035, 0.996), 0.7),
    ],
)
def test_feet_that_lie_near_each_other_are_found(center, axis, radius):
    """In one section of the arc the distance's slope dips beyond zero, and leads one way at both ends."""
    across = np.array(axis) / np.linalg.norm(axis)
    feet = feet_on(
        arc((0.0, 0.0, 0.0), np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0]), 1.0),
        arc(center, across, np.cross([0.0, 1.0, 0.0], across), radius),
    )
    told = sampled_feet(center, across, radius)
    assert feet.n_feet == len(told)
    assert [feet.first, feet.last][: len(told)] == pytest.approx(told, abs=1e-4)


def straight_edge(place: np.ndarray, along: np.ndarray) -> Feature:
    made = empty_rows(Feature, 1)[0]
    made.kind, made.length = EDGE, 4.0
    for k in range(3):
        made.point[k], made.direction[k] = place[k], along[k]
    return made


def test_a_rim_that_comes_out_from_under_an_edge_has_two_feet_until_it_is_out(cases, say):
    """A line that cuts s from a circle has feet at acos(1 - s) to both sides; near its plane, close to there. Half of
    them lie as people draw them: in the plane, or with a foot to either side of an arc's middle.
    """
    rng = np.random.default_rng(1)
    rim = arc((0.0, 0.0, 0.0), np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0]), 1.0)
    worst, n_lines = 0.0, 0
    for _ in range(cases(400, 4000)):
        around, cut = rng.choice([0.0, rng.uniform(-0.45, 0.45)]), 10.0 ** rng.uniform(-7.0, -1.2)
        height, rise = rng.choice([0.0, 1e-4 * cut], 2) * rng.normal(size=2)
        out = np.array([math.cos(around), math.sin(around), 0.0])
        along = np.array([-math.sin(around), math.cos(around), rise])
        told = np.array([around - math.acos(1.0 - cut), around + math.acos(1.0 - cut)])
        if max(abs(told)) > 0.99 * SEARCHED:
            continue
        feet = feet_on(rim, straight_edge((1.0 - cut) * out + (0.0, 0.0, height), along / np.linalg.norm(along)))
        assert feet.n_feet == 2, (around, cut, height, rise)
        worst, n_lines = max(worst, float(np.abs(told - [feet.first, feet.last]).max())), n_lines + 1
    assert worst < 1e-7
    say(f"{n_lines} rims under edges: two feet each, at most {worst:.1e} rad from those of the plane")


@pytest.mark.parametrize("around", [0.0, 0.1, -0.21, math.pi / 16])
@pytest.mark.parametrize("small", [0.01, 0.02, 0.05, 0.1, 0.13])
@pytest.mark.parametrize("off", [0.0, 1e-9, -1e-7, 1e-5, 1e-3])
def test_a_pin_on_the_pitch_circle_of_a_rim_has_two_feet_on_it(around, small, off):
    """A circle in the rim's plane, its middle on the rim as people draw it: they cross to both sides of that."""
    up = np.array([0.0, 0.0, 1.0])
    feet = feet_on(
        arc((0.0, 0.0, 0.0), up, np.array([1.0, 0.0, 0.0]), 1.0),
        arc(((1.0 + off) * math.cos(around), (1.0 + off) * math.sin(around), 0.0), up, np.array([1.0, 0, 0]), small),
    )
    half = math.acos((1.0 + (1.0 + off) ** 2 - small * small) / (2.0 * (1.0 + off)))
    told = [angle for angle in (around - half, around + half) if abs(angle) < SEARCHED]
    assert feet.n_feet == len(told)
    assert [feet.first, feet.last][: len(told)] == pytest.approx(told, abs=1e-9)
