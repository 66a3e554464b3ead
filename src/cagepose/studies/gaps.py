"""How far the object is from the cage at any moment: `GapFinder`, for the dimensions of a picture."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.boundary.gaps import GapWork, empty_gap_work, find_gaps
from cagepose.kernels.native.slots import Slots
from cagepose.model.checks import FloatArray, unit_rows
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.driven_cage import CageAt
from cagepose.studies.touching import TouchFinder

MOST_GAPS, ENOUGH = 2_000, 100
"""Gaps that there is memory for. Of a crowd, those beyond so many need not be found."""
FIRST_REACH, USUAL_REACH, FARTHEST, FARTHER = 1.0 / 64.0, 1.0 / 8.0, 4.0, 4.0
"""In sizes of the scene: how far the search looks at first, how far it does in any case, and at most. It looks so many
times as far then, until it has found enough, or all of the cage. The next pose is begun with as far as it took."""
SAME_GAP = 4.0
"""In touch tolerances: gaps of two parts along one direction that differ by less are one, as between parallel faces."""
SAME_WAY = 1e-6
"""Radians."""


class Gaps(NamedTuple):
    """Where n pairs of parts are nearest to each other, the narrowest gap first.

    Attributes
    ----------
    elements
        Indices of the cage's points, shapes and holes, in this order, (n,).
    parts
        Indices of the object's parts and holes, (n,).
    gaps_m
        Metres, (n,); zero: they touch.
    places_world, others_world
        On the object and on the cage, metres, (n, 3); of parts that touch one place.
    """

    elements: NDArray[np.int64]
    parts: NDArray[np.int64]
    gaps_m: FloatArray
    places_world: FloatArray
    others_world: FloatArray

    def chosen(self, which: NDArray[np.int64]) -> Gaps:
        """Return some of them, by their indices (m,)."""
        places, others = self.places_world[which], self.others_world[which]
        return Gaps(self.elements[which], self.parts[which], self.gaps_m[which], places, others)


NO_GAPS = Gaps(np.zeros(0, np.int64), np.zeros(0, np.int64), np.zeros(0), np.zeros((0, 3)), np.zeros((0, 3)))


class _Alike(NamedTuple):
    """Gaps of two parts that are one: how wide, along which unit vector, which rows they are, and their places."""

    gap: float
    way: list[float]
    rows: list[int]
    places: list[list[float]]


class GapFinder:
    """Finds the gaps of one scene, at pose after pose, in the same memory."""

    def __init__(self, scene: Scene) -> None:
        self._touches = TouchFinder(scene)
        self._scene, self._touch_m = scene, scene.geometry.touch_m
        self._reach_m = FIRST_REACH * scene.size_m
        self._work: GapWork = empty_gap_work(MOST_GAPS)
        self._written = Slots(self._work)
        held, cage = scene.object, scene.cage
        self._is_plain = np.array([part.is_convex for part in held.parts] + [False] * len(held.holes))
        cut = {name for hole in (*held.holes, *cage.holes) for name in hole.in_}
        self._is_plain &= [name not in cut for name in held.element_names]
        names = cage.element_names[len(cage.names) :]
        shapes = [shape.is_convex and name not in cut for name, shape in zip(names, cage.shapes, strict=False)]
        self._is_plain_cage = np.array([True] * len(cage.names) + shapes + [False] * len(cage.holes))

    def at(self, pose_world_object: Pose, cage: CageAt) -> Gaps:
        """Return the gaps with the object at a pose and the bodies of the cage where they are, and what touches.

        Each place is one where the distance is the least nearby, or, in a hole, the greatest: exact, and along a common
        normal that nothing is in the way of. Parallel faces have one gap, in the middle of where they face each other.
        How far off gaps are told hangs on the pose before, the narrowest do not.
        """
        touching = self._touches.at(pose_world_object, cage)
        zero = np.zeros(len(touching.elements))
        touch = Gaps(touching.elements, touching.parts, zero, touching.places_world, touching.places_world)
        found = self._open(pose_world_object, set(touching.elements.tolist()))
        both = [np.concatenate(pair) for pair in zip(touch, found, strict=True)]
        gaps = self._merged(Gaps(*both))
        return gaps.chosen(np.argsort(gaps.gaps_m, kind="stable"))

    def _open(self, pose: Pose, touching: set[int]) -> Gaps:
        """Return the gaps that are wider than what touches, as far as it takes to find all of the cage."""
        size_m, everything = self._scene.size_m, len(self._scene.cage.element_names)
        reach_m, least_failed = self._reach_m, np.inf
        rows = self._rows(pose, reach_m)
        while rows is None and reach_m > self._touch_m:  # a crowd
            least_failed, reach_m = reach_m, reach_m / FARTHER
            rows = self._rows(pose, reach_m)
        rows = NO_GAPS if rows is None else rows
        while FARTHER * reach_m < least_failed and FARTHER * reach_m <= FARTHEST * size_m:
            is_known = len(touching | set(rows.elements.tolist())) == everything
            if len(rows.elements) >= ENOUGH or (is_known and reach_m >= USUAL_REACH * size_m):
                break
            reach_m *= FARTHER
            farther = self._rows(pose, reach_m)
            if farther is None:
                least_failed = reach_m
                break
            rows = farther
        self._reach_m = reach_m if len(rows.elements) < ENOUGH else max(reach_m / FARTHER, FIRST_REACH * size_m)
        if not len(rows.elements) and least_failed < np.inf:
            return self._rows(pose, FARTHEST * size_m, narrowest=True) or NO_GAPS
        return rows

    def _rows(self, pose: Pose, reach_m: float, *, narrowest: bool = False) -> Gaps | None:
        """Return the gaps up to a length, or the narrowest alone; None: there are too many."""
        at, touches = pose.as_tuples(), self._touches
        n_found = find_gaps(touches.geometry, *at, reach_m, narrowest, touches.placement, self._written)
        if n_found < 0:
            return None
        rows: Any = self._work.rows[:n_found]
        columns = (np.array(rows[key]) for key in ("cage_part", "part", "gap", "place", "cage_place"))
        return Gaps(*columns)

    def _merged(self, gaps: Gaps) -> Gaps:
        """Return the gaps of parallel faces once, in the middle of where they face each other."""
        pairs = gaps.elements * len(self._is_plain) + gaps.parts
        _, pair, n_of_pair = np.unique(pairs, return_inverse=True, return_counts=True)
        rows = np.flatnonzero((gaps.gaps_m > 0.0) & (n_of_pair[pair] > 1))  # contacts are told one by one
        if not len(rows):
            return gaps
        is_kept = np.ones(len(pairs), dtype=np.bool_)
        known = dict[int, list[_Alike]]()
        ways = unit_rows(gaps.others_world[rows] - gaps.places_world[rows]).tolist()
        columns = (pairs[rows].tolist(), gaps.gaps_m[rows].tolist(), ways, gaps.places_world[rows].tolist())
        same_m = SAME_GAP * self._touch_m
        for row, of, gap, way, place in zip(rows.tolist(), *columns, strict=True):
            of_pair = known.setdefault(of, [])
            for alike in of_pair:
                if abs(gap - alike.gap) <= same_m and math.dist(way, alike.way) <= SAME_WAY:
                    is_kept[row] = False
                    if all(math.dist(place, other) > same_m for other in alike.places):
                        alike.rows.append(row)
                        alike.places.append(place)
                    break
            else:
                of_pair.append(_Alike(gap, way, [row], [place]))
        for all_rows in (alike.rows for of_pair in known.values() for alike in of_pair if len(alike.rows) > 1):
            first = all_rows[0]
            middle = gaps.places_world[all_rows].mean(axis=0), gaps.others_world[all_rows].mean(axis=0)
            # In the middle of what is hollow or cut there need not be anything.
            if not (self._is_plain[gaps.parts[first]] and self._is_plain_cage[gaps.elements[first]]):
                nearest = all_rows[int(np.linalg.norm(gaps.places_world[all_rows] - middle[0], axis=1).argmin())]
                middle = gaps.places_world[nearest].copy(), gaps.others_world[nearest].copy()
            gaps.places_world[first], gaps.others_world[first] = middle
        return gaps.chosen(np.flatnonzero(is_kept))
