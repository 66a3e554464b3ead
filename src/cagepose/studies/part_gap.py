"""How far some parts of the object are from some elements of the cage: `PartGap`, for one pair at pose after pose.

`cagepose.studies.gaps` tells what faces each other in the whole scene. Here a pair is given by name, and what else the
scene has is left out: it neither hides the two from each other nor crowds them out.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from cagepose.kernels.boundary.features import body_of, place_boundary
from cagepose.kernels.boundary.gaps import GapWork, empty_gap_work, find_gaps
from cagepose.kernels.boundary.geometry import Placement, empty_placement, place_object
from cagepose.kernels.native.slots import Slots
from cagepose.model.geometry import Part, pair_geometry
from cagepose.model.hole import Hole
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.model.shapes import Shape
from cagepose.runs.driven_cage import CageAt
from cagepose.studies.between_features import Instant

MOST_GAPS = 2_000
"""Gaps that there is memory for, where it is told of which parts each is."""
FIRST_REACH, FARTHER = 1.0 / 64.0, 4.0
"""How far a search for the gaps of single parts looks at first, in the greatest distance that there can be, and how
many times as far it looks then."""


class PartGap:
    """Measures the least distance between parts of the object and elements of one body of the cage.

    A box or a shape counts with the walls of the holes in it; a hole is its walls, the circles between them and its
    bottom. A hole that is cut out of several parts counts with each.

    Parameters
    ----------
    scene
        The scene.
    parts
        Indices of `Object.element_names`.
    elements
        Indices of `Cage.element_names`.
    """

    def __init__(self, scene: Scene, parts: Sequence[int], elements: Sequence[int]) -> None:
        cage = scene.cage
        self._point = elements[0] if len(elements) == 1 and elements[0] < len(cage.names) else None
        self._body = cage.element_bodies[elements[0]]
        of_cage: list[Part] = [*cage.points_cage, *cage.shapes, *cage.holes]
        if self._point is not None:
            of_cage[self._point] = np.zeros(3)  # placed where it is, as points vary from row to row of a study
        own, is_own = _with_holes([*scene.object.parts, *scene.object.holes], parts)
        other, is_other = _with_holes(of_cage, elements)
        self._reach_m = max(map(_farthest_m, own)) + max(map(_farthest_m, other))
        # Not the scene's touch tolerance: points of the cage change it, and must not change the surfaces.
        geometry = pair_geometry(own, other, scene.tolerances.touch * self._reach_m)
        self._is_own, self._is_other = np.array(is_own), np.array(is_other)
        self._is_whole = all((*is_own, *is_other))
        of_features: Any = geometry.held.features, geometry.cage.own.features
        self._part_of, self._element_of = (np.array(np.asarray(features)["part"]) for features in of_features)
        self._placed_cage = body_of(geometry.cage, geometry.placed, 0)
        self._placement: Placement = empty_placement(geometry)
        self._work: GapWork = empty_gap_work(1 if self._is_whole else MOST_GAPS)
        self._geometry, self._placement_slots = Slots(geometry), Slots(self._placement)
        self._work_slots = Slots(self._work)

    def at(self, instant: Instant) -> float:
        """Return the distance at an instant, metres.

        Exact; 0 where they touch. NaN where nothing of a hole, or of one of several parts that a hole goes through,
        faces the others, or too much does to tell.
        """
        frame, at = self._frame(instant.cage), instant.pose_world_object.as_tuples()
        self._set_touch(instant.touch_m)
        place_boundary(self._placed_cage, *frame.as_tuples())
        place_object(self._geometry, *at, self._placement_slots)
        rows: Any = self._placement.memory.rows[: max(int(self._placement.counts[0, 0]), 0)]
        if self._of_pair(self._part_of[rows["feature"]], self._element_of[rows["cage_feature"]]).any():
            return 0.0
        farthest_m = math.dist(instant.pose_world_object.position_m, frame.position_m) + self._reach_m
        if self._is_whole:
            n_found = find_gaps(self._geometry, *at, farthest_m, True, self._placement_slots, self._work_slots)
            found: Any = self._work.rows[:n_found] if n_found > 0 else None
            return math.nan if found is None else float(found["gap"][0])
        return self._narrowest_of_pair(at, farthest_m)

    def _set_touch(self, touch_m: float) -> None:
        """Take parts that are this near to each other for touching."""
        geometry: Any = self._geometry.value
        if geometry.touch_m != touch_m:
            self._geometry = Slots(geometry._replace(touch_m=touch_m))

    def _narrowest_of_pair(self, at: tuple[Any, Any], farthest_m: float) -> float:
        """Return the narrowest gap of those that count, looking farther and farther."""
        reach_m = FIRST_REACH * farthest_m
        while True:
            n_found = find_gaps(self._geometry, *at, reach_m, False, self._placement_slots, self._work_slots)
            rows: Any = self._work.rows[: max(n_found, 0)]
            gaps = np.array(rows["gap"])[self._of_pair(rows["part"], rows["cage_part"])]
            if len(gaps):
                return float(gaps.min())
            if n_found < 0 or reach_m >= farthest_m:
                return math.nan
            reach_m *= FARTHER

    def _of_pair(self, parts: Any, elements: Any) -> Any:
        """Return which pairs of parts of the two boundaries count."""
        return self._is_own[parts] & self._is_other[elements]

    def _frame(self, cage: CageAt) -> Pose:
        """Return where the frame of what is measured of the cage is."""
        if self._point is not None:
            return Pose(cage.points_world[self._point])
        return cage.displaced[self._body] @ cage.cage.pose_world_cage


def _with_holes(every: Sequence[Part], chosen: Sequence[int]) -> tuple[list[Part], list[bool]]:
    """Return some parts of a body with all that holes join to them, and which of these count."""
    numbers = {part.name: number for number, part in enumerate(every) if isinstance(part, Shape)}
    cut = {number: {numbers[name] for name in part.in_} for number, part in enumerate(every) if isinstance(part, Hole)}
    counted = {*chosen, *(hole for hole, parts in cut.items() if parts.intersection(chosen))}
    needed, n_before = set(counted), 0
    while len(needed) > n_before:
        n_before = len(needed)
        for hole, parts in cut.items():
            if needed & {hole, *parts}:
                needed |= {hole, *parts}
    order = sorted(needed)
    return [every[number] for number in order], [number in counted for number in order]


def _farthest_m(part: Part) -> float:
    """Return how far a part reaches from the origin of its body, metres."""
    return float(np.linalg.norm(part)) if isinstance(part, np.ndarray) else part.farthest_m(np.zeros(3))
