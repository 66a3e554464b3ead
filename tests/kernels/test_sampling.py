"""First contact against dense sampling of the motion, on seeded random cases.

The oracle knows nothing of slabs or intervals: it moves the point by scipy's rotations and asks at many moments how
deep it is. The kernel may never be later than the first sample that is inside, and from its contact on the point must
stay at or below the surface until that sample (so it is not early either).
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from cagepose.kernels.collision.travel import travel_entry
from cagepose.kernels.collision.turn import angle_of_key, turn_entry

RESOLUTION = 1e-12
TOUCH = 1e-9
N_SAMPLES = 4000


def random_unit(rng):
    """Half of the time along an axis of the box, where faces are parallel to the motion."""
    if rng.random() < 0.5:
        return np.eye(3)[rng.integers(3)] * rng.choice([-1.0, 1.0])
    vector = rng.normal(size=3)
    return vector / np.linalg.norm(vector)


def random_start(rng, half):
    """Outside the box; a third of the time on its surface, sometimes on an edge or a corner."""
    while True:
        point = rng.uniform(-2.5, 2.5, 3)
        if rng.random() < 1 / 3:
            point = rng.uniform(-1.2, 1.2, 3) * half
            for axis in rng.permutation(3)[: rng.integers(1, 4)]:
                point[axis] = rng.choice([-1.0, 1.0]) * half[axis]
        if (np.abs(point) - half).max() >= 0.0:
            return point


def depths(path, half):
    return (half - np.abs(path)).min(axis=1)


class Travel:
    end = 8.0

    def __init__(self, rng):
        self.direction = random_unit(rng)

    def path(self, point, moments):
        return point - moments[:, None] * self.direction

    def entry(self, point, half, depth):
        return travel_entry(tuple(point), tuple(self.direction), tuple(half), depth, RESOLUTION)


class Turn:
    end = 2.0 * math.pi

    def __init__(self, rng):
        self.axis = random_unit(rng)
        self.through = rng.uniform(-2.0, 2.0, 3)

    def path(self, point, moments):
        """Seen from the object, the point goes the way back: turned by -s."""
        return Rotation.from_rotvec(-moments[:, None] * self.axis).apply(point - self.through) + self.through

    def entry(self, point, half, depth):
        key = self.key(point, half, depth, math.inf)
        return math.inf if key == math.inf else angle_of_key(key)

    def key(self, point, half, depth, least):
        return turn_entry(tuple(point), tuple(self.through), tuple(self.axis), tuple(half), depth, RESOLUTION, least)


@pytest.mark.parametrize("motion_kind", [Travel, Turn])
def test_first_contact_is_neither_late_nor_early(motion_kind, cases):
    rng = np.random.default_rng(20261121)
    n_met = n_blocked = 0
    for case in range(cases(1000, 3000)):
        half = rng.uniform(0.1, 1.0, 3)
        point = random_start(rng, half)
        motion = motion_kind(rng)
        entry = motion.entry(point, half, RESOLUTION)
        moments = np.linspace(0.0, motion.end, N_SAMPLES)
        inside = np.nonzero(depths(motion.path(point, moments), half) > TOUCH)[0]
        if len(inside):
            first_inside = moments[inside[0]]
            assert entry <= first_inside, f"case {case}: contact at {entry}, but inside at {first_inside}"
        if entry < math.inf:
            n_met += 1
            n_blocked += entry == 0.0
            at_entry = depths(motion.path(point, np.array([entry])), half)[0]
            assert abs(at_entry) <= TOUCH, f"case {case}: {at_entry} deep at contact"
            after = entry + np.geomspace(1e-9, 1.0, 2000)
            below = depths(motion.path(point, after), half)
            left = np.nonzero(below < -TOUCH)[0]
            until = left[0] if len(left) else len(below)
            assert below[:until].max(initial=-1.0) > RESOLUTION, f"case {case}: contact at {entry} leads nowhere"
    assert n_met > 5
    assert n_blocked > 0


def test_a_turn_is_cut_short_only_where_nothing_is_met_before(cases):
    rng = np.random.default_rng(8)
    n_cut = n_blocked = 0
    for _ in range(cases(1000, 3000)):
        half = rng.uniform(0.1, 1.0, 3)
        point = random_start(rng, half)
        motion = Turn(rng)
        key = motion.key(point, half, RESOLUTION, math.inf)
        assert (motion.key(point, half, RESOLUTION, -math.inf) == -math.inf) == (key == -math.inf)
        n_blocked += key == -math.inf
        least = rng.normal() if key == math.inf else key + rng.normal() if key > -math.inf else rng.normal()
        found = motion.key(point, half, RESOLUTION, least)
        assert found in (key, math.inf)
        assert found == key or key > least
        n_cut += found != key
    assert n_cut > 0
    assert n_blocked > 0


@pytest.mark.parametrize("motion_kind", [Travel, Turn])
def test_a_point_that_starts_inside_the_tolerance_is_never_pushed_deeper(motion_kind, cases):
    rng = np.random.default_rng(7)
    n_free = 0
    for case in range(cases(500, 1500)):
        half = rng.uniform(0.1, 1.0, 3)
        point = rng.uniform(-1.0, 1.0, 3) * half
        axis = rng.integers(3)
        start_depth = rng.uniform(0.0, TOUCH)
        point[axis] = math.copysign(half[axis] - start_depth, point[axis])
        motion = motion_kind(rng)
        entry = motion.entry(point, half, start_depth + 1e-14)
        moments = np.geomspace(1e-9, motion.end, N_SAMPLES)
        path_depths = depths(motion.path(point, moments[moments <= entry]), half)
        assert path_depths.max(initial=0.0) <= start_depth + 2e-14, f"case {case}"
        n_free += entry > 0.0
    assert n_free > 3
