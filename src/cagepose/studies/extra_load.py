"""How large an extra force, or moment, contacts balance whichever way it points: `least_extra_load` (5.23).

The extra loads w + u that the contacts balance are a convex set around u = 0. Its distance from there to its boundary
is one over the distance of the farthest point of its polar set, and that is the image of a set of motions: those along
which every contact opens or stays, and against which the load does a work of at most 1. A linear program gives the
plane that bounds the polar set in one direction. Planes make a polytope around it; its farthest corner bounds the
distance, and says in which direction to ask next. The method is that of Y. Zheng, "An efficient algorithm for a grasp
quality measure", IEEE Transactions on Robotics 29 (2013), 579-585, in the polar set, where what the contacts balance
without bound is a point and not infinitely far.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.linear_program import OPTIMAL
from cagepose.model.checks import FloatArray
from cagepose.studies.contact_cones import ConeProgram
from cagepose.studies.tolerances import GAP_OF_BOUNDS, GREATEST_FORCE, LEAST_EXTRA_LOAD

MOST_PLANES = 400
"""Then the bound from below is certain, but less tight. Blocks among random points took at most 13, and a connector on
a level floor, which slides alike all ways around, 116."""


class ExtraLoad(NamedTuple):
    """The least extra load that contacts do not balance.

    Attributes
    ----------
    certain
        All that is smaller is balanced; inf: all are.
    found
        Along ``direction`` no more than this is, as closely as the rays of the program follow the cones.
    direction
        Unit vector (3,).
    """

    certain: float
    found: float
    direction: FloatArray


def least_extra_load(
    program: ConeProgram, load: FloatArray, counts: FloatArray, axes: slice, enough: float
) -> ExtraLoad:
    """Return the least extra force or moment that forces of contacts do not balance.

    Parameters
    ----------
    program
        Of the contacts.
    load
        The wrench that they give without it, (6,), of length 1.
    counts
        0 for contacts that count, -inf for others, (n,).
    axes
        Of a wrench, which three entries the extra load has.
    enough
        The search ends where the least is known to be more.
    """
    polar = _Polar(program, load, counts, axes)
    sides = np.concatenate([np.eye(3), -np.eye(3)])
    heights = np.array([polar.height(side) for side in sides])
    if not np.isfinite(heights).all():
        return ExtraLoad(0.0, 0.0, sides[np.argmax(heights)])
    corners = np.array([(x, y, z) for x in (0, 3) for y in (1, 4) for z in (2, 5)])
    places = np.where(corners < 3, 1.0, -1.0) * heights[corners]
    for plane in range(len(sides), MOST_PLANES):
        distances = np.linalg.norm(places, axis=1)
        farthest = int(distances.argmax())
        distance = distances[farthest]
        if distance * GREATEST_FORCE <= 1.0:
            return ExtraLoad(np.inf, np.inf, np.zeros(3))
        if distance <= (1.0 + GAP_OF_BOUNDS) * polar.reached or distance * enough < 1.0:
            break
        normal = places[farthest] / distance
        height = polar.height(normal)
        places, corners = _cut_off(places, corners, normal, height, plane)
    certain, found = 1.0 / float(distance), 1.0 / max(polar.reached, 1.0 / GREATEST_FORCE)
    return ExtraLoad(
        certain if certain > LEAST_EXTRA_LOAD else 0.0, found if found > LEAST_EXTRA_LOAD else 0.0, polar.direction
    )


class _Polar:
    """The polar set, asked by directions; it keeps the farthest of its points that were met."""

    def __init__(self, program: ConeProgram, load: FloatArray, counts: FloatArray, axes: slice) -> None:
        self.program, self.load, self.counts, self.axes = program, load, counts, axes
        self.reached, self.direction = 0.0, np.zeros(3)

    def height(self, normal: FloatArray) -> float:
        """Return the greatest height of the set along a unit vector; inf: no bound."""
        objective = np.zeros(6)
        objective[self.axes] = normal
        outcome, motion = self.program.greatest(objective, self.counts, self.load)
        if outcome != OPTIMAL:
            return np.inf
        point = motion[self.axes]
        distance = float(np.linalg.norm(point))
        if distance > self.reached:
            self.reached, self.direction = distance, point / distance
        return max(float(normal @ point), 0.0)


def _cut_off(
    places: FloatArray, planes: NDArray[np.int64], normal: FloatArray, height: float, plane: int
) -> tuple[FloatArray, NDArray[np.int64]]:
    """Cut a polytope by the plane ``normal . x = height``; return its corners and the three planes of each.

    Corners of more planes stand there several times, so that each has three edges. Where an edge is cut, one new corner
    lies between its ends.
    """
    heights = places @ normal - height
    off, on = np.flatnonzero(heights > 0.0), np.flatnonzero(heights <= 0.0)
    shared = (planes[off][:, None, :, None] == planes[on][None, :, None, :]).any(axis=3)
    one, other = np.nonzero(shared.sum(axis=2) == 2)
    out, into = off[one], on[other]
    fractions = (heights[out] / (heights[out] - heights[into]))[:, None]
    cut = places[out] + fractions * (places[into] - places[out])
    both = planes[out][shared[one, other]].reshape(-1, 2)
    new = np.concatenate([both, np.full((len(both), 1), plane)], axis=1)
    return np.concatenate([places[on], cut]), np.concatenate([planes[on], new])
