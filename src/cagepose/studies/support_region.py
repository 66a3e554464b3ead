"""Where the centre of gravity may be for the contacts to balance a weight, seen along it: `support_region`, (5.34).

On level ground without friction it is the polygon of the contacts. On slopes, with friction, or between walls it is
not: there forces that point elsewhere than up make it larger, smaller or empty.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice, product
from typing import NamedTuple, TypeAlias

import numpy as np

from cagepose.kernels.algebra.linear_program import INFEASIBLE, OPTIMAL, UNBOUNDED
from cagepose.kernels.contact.contact_set import tangents_to
from cagepose.model.checks import FloatArray, as_vector
from cagepose.runs.cases import contact_friction
from cagepose.runs.methods import chosen_method
from cagepose.runs.run import Run
from cagepose.studies.arcs import places_on_arcs
from cagepose.studies.contact_cones import ConeProgram, ContactCones
from cagepose.studies.contact_problem import ContactProblem, contact_problem
from cagepose.studies.support import LoadView, convex_hull, polygon_within, without_doubles
from cagepose.studies.tolerances import DISTANCE_OF_CORNER, PARALLEL_SINE, ROUNDING_OF_CORNER, VIOLATION_OF_CONE

N_DIRECTIONS = 120
"""3 deg apart; and across each side of the contacts' polygon, so that a polygon comes out exactly."""
HALVINGS_OF_ANGLE = 30
"""The angle between a direction in which a region ends and one in which it does not is halved so many times."""
WAY_WITHOUT_END = 1e3
"""In distances of ends: what has no end is followed so far."""
MOST_CHOICES = 27
"""So many choices of faces at edges are asked: three points on corners."""


@dataclass(frozen=True, eq=False)
class SupportRegion:
    """The region in the picture of a `LoadView`, metres.

    Attributes
    ----------
    corners
        Of the region as far as it is shown, counter-clockwise, (n, 2); none: the contacts balance the weight nowhere.
    margin_m
        How far the centre of gravity is inside; below zero: outside. Infinite: it may be anywhere, or (minus) nowhere.
    """

    corners: FloatArray
    margin_m: float


def support_region(run: Run, phase_index: int, view: LoadView, reach_m: float) -> SupportRegion | None:
    """Return where the contacts at the end of a phase under gravity alone could balance the object's weight.

    They can where the region holds the centre of gravity, with each choice of faces at edges. (That they can does not
    say that they must, see `Proof`.) None: there are too many choices, or a linear program had no sure answer.

    Parameters
    ----------
    run, phase_index, view
        The phase, and how it is seen.
    reach_m
        Farther from the centre of gravity nothing is shown.
    """
    if run.scene.planar is not None:
        return None  # a region of a level plane, of which the load's line passes through a line alone
    problem = contact_problem(run, phase_index)
    choices = list(islice(product(*problem.groups), MOST_CHOICES + 1))
    if len(choices) > MOST_CHOICES:
        return None
    wrenches, friction = _with_arcs(problem, run, phase_index)
    on_arcs = range(len(problem.faces), len(wrenches))
    regions = [_Region(wrenches[at], friction[at], view) for at in ([*choice, *on_arcs] for choice in choices)]
    found = _common(regions, view)
    if found is None:
        return None
    normals, heights, points = found
    margin_m = float(heights.min())
    if margin_m == -math.inf or _is_empty(normals, heights + ROUNDING_OF_CORNER * reach_m):
        return SupportRegion(np.zeros((0, 2)), -math.inf)
    if len(choices) == 1 and heights.max() < reach_m:  # between its farthest points there is next to nothing
        shown = without_doubles(convex_hull(points), ROUNDING_OF_CORNER * reach_m)
    else:
        shown = polygon_within(normals, np.minimum(heights, reach_m))
    return SupportRegion(view.load_point + shown, margin_m)


def _with_arcs(problem: ContactProblem, run: Run, phase_index: int) -> tuple[FloatArray, FloatArray]:
    """Return wrenches (n, 3, 6) and friction (n,) of the contacts of a problem, then of places along arcs."""
    scene, ended = run.scene, run.phases[phase_index]
    center, on_arcs = ended.pose.transform(scene.object.center_of_gravity_m), places_on_arcs(run, phase_index)
    of_scene = chosen_method(scene, run.method).friction(scene)
    wrenches = np.zeros((len(on_arcs), 3, 6))
    for place, contact in enumerate(on_arcs):
        assert contact.place_world is not None
        directions = np.array([contact.normal_world, *tangents_to(as_vector(contact.normal_world))])
        wrenches[place] = np.hstack([directions, np.cross(contact.place_world - center, directions)])
    friction = [contact_friction(scene, of_scene, contact.point, contact.box) for contact in on_arcs]
    return np.concatenate([problem.wrenches, wrenches]), np.concatenate([problem.friction, friction])


def _is_empty(normals: FloatArray, heights: FloatArray) -> bool:
    """Whether no point is within these distances of the origin along unit vectors: regions that do not overlap."""
    if heights.min() >= 0.0:
        return False
    farthest = WAY_WITHOUT_END * np.abs(heights[np.isfinite(heights)]).max()
    return len(polygon_within(normals, np.minimum(heights, farthest))) == 0


def _directions(polygon: FloatArray) -> FloatArray:
    """Return unit vectors in the picture, (n, 2), counter-clockwise."""
    angles = 2.0 * np.pi * np.arange(N_DIRECTIONS) / N_DIRECTIONS
    sides = np.roll(polygon, -1, axis=0) - polygon
    sizes = np.linalg.norm(sides, axis=1)
    across = np.stack([sides[:, 1], -sides[:, 0]], axis=1)[sizes > 0.0] / sizes[sizes > 0.0, None]
    directions = np.concatenate([np.stack([np.cos(angles), np.sin(angles)], axis=1), across, -across])
    return _in_order(directions)


def _in_order(normals: FloatArray) -> FloatArray:
    """Return unit vectors, (n, 2), counter-clockwise."""
    return np.asarray(normals[np.argsort(np.arctan2(normals[:, 1], normals[:, 0]))])


_End: TypeAlias = tuple[FloatArray, float, FloatArray]


class _Bounds(NamedTuple):
    """How far a region goes along unit vectors (n, 2), metres from the centre of gravity, and the points there; inf: it
    has no end, -inf: it is empty.
    """

    normals: FloatArray
    heights: FloatArray
    points: FloatArray


def _common(regions: Sequence[_Region], view: LoadView) -> _Bounds | None:
    """Return how far goes what is common to some regions; of several without points."""
    normals = _directions(view.polygon)
    for region in regions:  # each adds the directions that it needs
        found = _farthest(region, normals)
        if found is None or len(regions) == 1:
            return found
        normals = _in_order(found.normals)
    heights = np.full(len(normals), math.inf)
    for region in regions:
        for place, normal in enumerate(normals):
            end = region.reach(normal)
            if end is None:
                return None
            heights[place] = min(heights[place], end[0])
    return _Bounds(normals, heights, np.zeros((0, 2)))


class _Region:
    """Where some contacts, with wrenches (n, 3, 6) and friction (n,), balance the weight.

    With unit forces F_r of rays and their moments, the centre of gravity is M x d off for a weight of 1 along d, if the
    forces add up to -d and M has no part along d. The dual of what is greatest of it along a has four unknowns, a
    velocity and a turn about the load, and forces for its multipliers.
    """

    def __init__(self, wrenches: FloatArray, friction: FloatArray, view: LoadView) -> None:
        self.down = np.cross(view.up_world, view.right_world)
        self.seen = np.stack([view.right_world, view.up_world], axis=1)
        moments = np.linalg.norm(wrenches[:, :, 3:], axis=(1, 2))  # of three unit forces across each other
        self.length_m = float(moments.max(initial=0.0)) / math.sqrt(2.0) or 1.0
        columns = np.concatenate([-wrenches[:, :, :3], -wrenches[:, :, 3:] / self.length_m], axis=2)
        self.program = ConeProgram(ContactCones(columns, friction, self.length_m), VIOLATION_OF_CONE)
        free = np.eye(4, 6)
        free[3, 3:] = self.down
        self.program.confine(free)
        self.is_empty = self._solve(np.zeros(3))[0] == UNBOUNDED  # be it that moments have no end

    def _solve(self, across: FloatArray) -> tuple[int, FloatArray]:
        """Find what M . ``across`` is at most; return how the program ended, and its motion."""
        objective, offset = np.append(self.down, np.zeros(3)), np.append(np.zeros(3), -across)
        return self.program.greatest(objective, np.zeros(len(self.program.work.friction)), offset=offset)

    def reach(self, normal: FloatArray) -> tuple[float, FloatArray] | None:
        """Return how far it goes along a unit vector, and the point there; None: the program had no sure answer."""
        if self.is_empty:
            return -math.inf, np.zeros(2)
        outcome, motion = self._solve(np.cross(self.down, self.seen @ normal))
        if outcome == OPTIMAL:
            moment = self.length_m * self.program.wrench()[3:]
            return -self.length_m * float(self.down @ motion[:3]), np.cross(moment, self.down) @ self.seen
        return (math.inf, np.zeros(2)) if outcome == INFEASIBLE else None  # the dual of what has no end


def _farthest(region: _Region, normals: FloatArray) -> _Bounds | None:
    """Return how far a region goes along some directions, along those where it begins to have no end, and along those
    that its corners need; None: a program had no sure answer.
    """
    if region.is_empty:
        return _Bounds(normals, np.full(len(normals), -math.inf), np.zeros((len(normals), 2)))
    found = [(normal, region.reach(normal)) for normal in normals]
    last_ends = []
    for (one, at_one), (other, at_other) in zip(found, [*found[1:], found[0]], strict=True):
        if at_one is None or at_other is None:
            return None
        if (at_one[0] == math.inf) != (at_other[0] == math.inf):
            last_ends += _last_ends(region, *((one, other) if at_other[0] == math.inf else (other, one)))
    known = [(normal, *end) for normal, end in (*found, *last_ends) if end is not None]
    ended = sorted((one for one in known if one[1] < math.inf), key=lambda one: math.atan2(one[0][1], one[0][0]))
    waiting = list(zip(ended, [*ended[1:], *ended[:1]], strict=True))
    while waiting:
        one, other = waiting.pop()
        outward = _direction_between(one, other, region.length_m)
        if outward is not None:
            end = region.reach(outward)
            if end is None:
                return None
            middle = (outward, *end)
            known.append(middle)
            waiting += [(one, middle), (middle, other)]
    return _Bounds(*(np.array(column) for column in zip(*known, strict=True)))


def _direction_between(one: _End, other: _End, length_m: float) -> FloatArray | None:
    """Return the direction across the way between two ends; None: their corner is as near to the region as is told."""
    turned = float(one[0][0] * other[0][1] - one[0][1] * other[0][0])
    if turned < PARALLEL_SINE or float(one[0] @ other[0]) < 0.0:
        return None  # no corner, or one beyond what has no end
    corner = np.linalg.solve(np.stack([one[0], other[0]]), [one[1], other[1]])
    chord = other[2] - one[2]
    outward, size = np.array([chord[1], -chord[0]]), float(np.linalg.norm(chord))
    if size == 0.0:
        return None
    off = float(outward @ (corner - one[2])) / size
    return outward / size if off > DISTANCE_OF_CORNER * max(float(np.linalg.norm(corner)), length_m) else None


def _last_ends(
    region: _Region, bounded: FloatArray, endless: FloatArray
) -> list[tuple[FloatArray, tuple[float, FloatArray]]]:
    """Return directions ever nearer to an endless one in which the region still ends, and where."""
    found = []
    for _ in range(HALVINGS_OF_ANGLE):
        between = bounded + endless
        between /= np.linalg.norm(between)
        end = region.reach(between)
        if end is None or end[0] == math.inf:
            endless = between
        else:
            found.append((between, end))
            bounded = between
    return found
