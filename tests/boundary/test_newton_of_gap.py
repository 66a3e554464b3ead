"""Newton's method on the gap of a circle and an edge ends at its root, against Brent's method."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from boundary.asked import Asked
from boundary.motions import motion_of, random_direction
from cagepose import Box, Pose
from cagepose.kernels.boundary.circle_ahead import SAME_ANGLE
from cagepose.kernels.boundary.circle_first import place_near, root_of_gap
from cagepose.kernels.boundary.features import CIRCLE, LINE, place_feature
from cagepose.kernels.boundary.first_touch import place_after
from cagepose.kernels.boundary.meetings import find_circle_places, meeting_at
from cagepose.kernels.circles.places import GREATEST, SADDLE
from cagepose.model.shapes import Cylinder
from shapes.convex_bodies import random_turn

TOUCH_M = 3e-9


def nearest(asked: Asked, i: int, j: int):
    """Return the angle and the meeting where a circle is nearest to a line; None: nowhere."""
    places, found = asked.found.places, []
    for at in range(find_circle_places(asked.held.features[i], asked.cage.features[j], TOUCH_M, places)):
        if places[at].kind not in (GREATEST, SADDLE):
            found.append((float(places[at].angle), meeting_at(asked.held, i, asked.cage, j, places[at])))
    return min(found, key=lambda place: place[1].gap, default=None)


def test_newtons_method_ends_at_a_root_but_for_rounding(cases):
    """From within the touch tolerance of where a rim crosses an edge, though the last step leaves no less than that
    before it.
    """
    rng, found = np.random.default_rng(5), 0
    asked = Asked([Cylinder(0.25, 1.0)], [Box((1.2, 3.0, 0.4), Pose((-0.9, 0, -0.8)))], TOUCH_M)
    held, cage, moved, places = asked.held, asked.cage, asked.moved, asked.found.places
    circles, lines = (
        np.flatnonzero(body.own.features["kind"] == kind) for body, kind in ((held, CIRCLE), (cage, LINE))
    )
    while found < cases(4, 20):
        asked.place(Pose(rng.uniform(-1.0, 1.0, 3), random_turn(rng)))
        i, j = int(rng.choice(circles)), int(rng.choice(lines))
        place_feature(held, i)
        place_feature(cage, j)
        told = nearest(asked, i, j)
        if told is None or not told[1].is_one or not 0.01 < told[1].gap < 0.5:
            continue
        angle, met = told
        drift = np.array(met.normal) + 0.3 * rng.normal(size=3)
        motion = motion_of(np.array(met.place), drift, 0.2, random_direction(rng))

        def gap_after(amount: float, i=i, j=j, angle=angle, motion=motion) -> float:
            place_after(held, i, motion, amount, moved)
            at = place_near(moved.features[i], cage.features[j], angle, SAME_ANGLE, TOUCH_M, places)
            return meeting_at(moved, i, cage, j, places[at]).gap if at >= 0 else np.inf

        if not gap_after(2.0 * met.gap) < 0.0:
            continue
        crosses = brentq(gap_after, 0.0, 2.0 * met.gap, xtol=1e-15)
        if not abs(gap_after(crosses)) < 1e-14:  # the place jumps there
            continue
        root = root_of_gap(held, i, cage, j, motion, crosses - 5e-10, angle, 0.0, TOUCH_M, moved, places)
        assert root.amount == pytest.approx(crosses, abs=1e-12)
        found += 1
