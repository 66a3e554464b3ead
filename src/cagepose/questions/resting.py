"""How a part comes to rest on a level plane: `resting_poses`."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.errors import Problem, SceneError
from cagepose.model.box import Box
from cagepose.model.checks import FloatArray, expect, unit_rows
from cagepose.model.hull import Hull, hull_of
from cagepose.model.parts import Object
from cagepose.model.pose import Pose, turn_from_z
from cagepose.model.scene import Scene
from cagepose.questions.contact_area import ContactArea, contact_area
from cagepose.questions.drains import Pass
from cagepose.questions.outer_points import N_AROUND, is_round, lowest_points, outer_points
from cagepose.questions.rolling import Rest, Rolling, rolling

SAME_HEIGHT = 1e-9
"""Of the part's size. Heights that differ by no more are the same."""
SAME_DOWN, SAME_SIDE = math.cos(0.01), math.cos(0.15)
"""Two downs with a greater cosine are one, or beside each other."""
APART = math.cos(1e-3)
"""Two downs with a lesser cosine are two."""
LOW = 1e-3
"""Of the part's size. Points this much above the lowest one may be next to touch."""
LEVEL = 1e-12
"""Of one. A cosine that falls short of it by no more is one."""
N_ZOOMS, MOST_TRIES = 6, 40
"""So often a place on something round is looked at again, ten times as near each time; and tries, at most."""
N_ON_WAY = 9
"""Places on the way from one down to a lower one that are looked at."""
ROUNDING = 1e-12
"""Of the part's size. What is lower by no more is not lower."""
BENT, OFF_ROW = 1e-3, 0.05
"""Downs this near to a line or to a plane lie in it."""
RING = np.concatenate([np.zeros((1, 2)), np.array([(math.cos(a), math.sin(a)) for a in np.arange(8) * math.pi / 4.0])])


def is_on_floor_alone(scene: Scene) -> bool:
    """Whether the cage is one box with a level face, which is as good as a plane, under the first phase's weight."""
    cage, gravity = scene.cage, scene.loads[0].gravity_world
    if len(cage.shapes) != 1 or len(cage.names) or cage.holes or cage.bodies or not scene.loads[0].is_weight_alone:
        return False
    (floor,) = cage.shapes
    if not isinstance(floor, Box) or gravity is None:
        return False
    axes = (cage.pose_world_cage @ floor.pose_body_shape).rotation
    return bool(np.abs(gravity @ axes).max() >= (1.0 - LEVEL) * np.linalg.norm(gravity))


@dataclass(frozen=True, eq=False)
class RestingPose:
    """One way to lie, or a row of ways that roll into each other without effort.

    Attributes
    ----------
    down_object
        Unit vector of the object's frame that points down then, (3,); of a row, one of them.
    pose
        That pose, on the plane z = 0, the centre of gravity above the origin.
    touching
        Names of what lies on the plane.
    height_m
        Of the centre of gravity above the plane, metres.
    margin_m
        How far the foot of the centre of gravity is from the edge of the contact, metres; where this is a line, from
        its nearer end; of a single point, zero.
    rise_m
        How much the centre of gravity must be raised, at least, to tip it into another row, metres; infinite: there is
        no other one. Times the weight, it is the energy.
    probability
        To end here, let go slowly in an orientation that may be any, each as likely.
    rolls
        "no", "about an axis", or "all ways" as a ball.
    axis_object
        That axis, in the object's frame, (3,); None: there is none.
    """

    down_object: FloatArray
    pose: Pose
    touching: tuple[str, ...]
    height_m: float
    margin_m: float
    rise_m: float
    probability: float
    rolls: str
    axis_object: FloatArray | None

    def __repr__(self) -> str:
        return f"<RestingPose on {', '.join(self.touching)}: {self.probability:.4g}, rise {self.rise_m:.6g} m>"


@dataclass(frozen=True, eq=False)
class RestingPoses:
    """All of them, the most probable first.

    Attributes
    ----------
    poses
        In turn.
    is_exact
        Whether all numbers are, but for rounding: of parts with nothing round. Else probabilities are within some
        thousandths, and heights, margins and rises within a thousandth of what is round.
    """

    poses: tuple[RestingPose, ...]
    is_exact: bool

    def __repr__(self) -> str:
        return f"<{len(self.poses)} RestingPoses: {', '.join(f'{pose.probability:.3g}' for pose in self.poses)}>"


def resting_poses(part: Object) -> RestingPoses:
    """Return how a part comes to rest on a level plane without friction, let go slowly.

    Only its hull and its centre of gravity matter. It turns as this falls fastest, the same about all axes (the metric
    "drag"), and comes to rest on a face of the hull. Holes do not count.

    Raises
    ------
    SceneError
        The centre of gravity does not lie within the hull of the part, or the part spans no volume.
    """
    expect(part, Object, "part")
    outside = _Outside(part)
    rolled = outside.rolled()
    found = [outside.lowest(rest) for rest in rolled.rests]
    rows = outside.rows(found, rolled.passes)
    number_of = {rest: number for number, row in enumerate(rows) for rest in row.rests}
    rises = [math.inf] * len(rows)
    for top in rolled.passes:
        one, other = (number_of[rest] for rest in top.between)
        for number in (one, other) if one != other else ():
            rises[number] = min(rises[number], top.height_m - rows[number].at.height_m)
    poses = [
        outside.pose(row.at, sum(rolled.rests[rest].area for rest in row.rests), max(rise, 0.0))
        for row, rise in zip(rows, rises, strict=True)
    ]
    return RestingPoses(tuple(sorted(poses, key=lambda pose: -pose.probability)), not outside.is_round)


class _Lowest(NamedTuple):
    """A down at which the centre of gravity is lowest, and how the part rolls on from there without effort."""

    down: FloatArray
    height_m: float
    rolls: str = "no"
    axis: FloatArray | None = None


class _Row(NamedTuple):
    """Rests (their numbers) that roll into each other without effort, and where one of them is."""

    at: _Lowest
    rests: tuple[int, ...]


class _Outside:
    """A part as seen from the plane."""

    def __init__(self, part: Object) -> None:
        self._part, self._center = part, part.center_of_gravity_m
        self._points = np.concatenate([outer_points(shape) for shape in part.parts])
        self.is_round = any(is_round(shape) for shape in part.parts)
        self._hull = self._checked_hull()
        self._size_m = part.reach_m

    def _checked_hull(self) -> Hull:
        hull = hull_of(self._points)
        if hull.dimension < 3:
            raise SceneError([Problem(("object",), "is flat, so it has no faces to rest on; give it a thickness")])
        above = np.einsum("ij,ij->i", hull.normals, hull.vertices_m[[loop[0] for loop in hull.faces]] - self._center)
        if above.min() <= 0.0:
            found = "does not lie within the hull of the part, so the part need not come to rest on a face"
            raise SceneError([Problem(("object", "center_of_gravity"), f"{found}; move it inside")])
        return hull

    def heights(self, downs: FloatArray) -> FloatArray:
        """Return how high the centre of gravity is while unit vectors (n, 3) point down, (n,), metres."""
        highest: FloatArray = np.max([shape.heights_m(downs) for shape in self._part.parts], axis=0)
        return highest - downs @ self._center

    def rolled(self) -> Rolling:
        return rolling(self._hull, self._center, self.heights if self.is_round else None)

    def lowest(self, rest: Rest) -> _Lowest:
        downs = self._hull.normals[list(rest.faces)]
        heights = self.heights(downs)
        first = self._nearer(downs[np.argmin(heights)])
        if len(downs) == 1:
            return first
        other = self._nearer(downs[np.argmin(downs @ first.down)])
        if abs(other.height_m - first.height_m) > SAME_HEIGHT * self._size_m or other.down @ first.down > SAME_DOWN:
            return min(first, other, key=lambda at: at.height_m)
        # Of a row, the one that is nearest to an axis of the object's frame: its numbers are the simplest.
        simplest = self._nearer(downs[np.argmax((downs**4).sum(axis=1))])
        return simplest._replace(**self._row_from(simplest.down, downs))

    def rows(self, found: list[_Lowest], passes: tuple[Pass, ...]) -> list[_Row]:
        """Return the rests in rows: two are in one if, between them, it falls to a third of their height
        from hardly more.
        """
        height_m = SAME_HEIGHT * self._size_m
        between: dict[int, list[_Lowest]] = {rest: [] for rest in range(len(found))}
        same_as, asked = list(range(len(found))), set[tuple[int, int]]()
        for top in sorted(passes, key=lambda one: one.height_m) if self.is_round else ():
            one, other = (found[rest] for rest in top.between)
            is_known = same_as[top.between[0]] == same_as[top.between[1]] or top.between in asked
            asked |= {top.between, top.between[::-1]}
            is_high = top.height_m - one.height_m > LOW * self._size_m
            if is_known or is_high or abs(one.height_m - other.height_m) > height_m:
                continue
            third = self._nearer(top.down)
            if (
                abs(third.height_m - one.height_m) <= height_m
                and max(third.down @ one.down, third.down @ other.down) < APART
            ):
                first, second = sorted(same_as[rest] for rest in top.between)
                same_as = [first if same == second else same for same in same_as]
                between[top.between[0]].append(third)
        rows = []
        for first in sorted(set(same_as)):
            rests = tuple(rest for rest, same in enumerate(same_as) if same == first)
            at = found[first]
            if len(rests) > 1:
                downs = np.array([place.down for rest in rests for place in (found[rest], *between[rest])])
                at = at._replace(**self._row_from(at.down, downs))
            rows.append(_Row(at, rests))
        return rows

    def _row_from(self, down: FloatArray, downs: FloatArray) -> dict[str, Any]:
        """Return how a row of downs (n, 3) lies that roll into each other."""
        other = self._nearer(downs[np.argmin(downs @ down)]).down
        way = (other - down) / np.linalg.norm(other - down)
        beside = downs - down - np.outer((downs - down) @ way, way)
        third = self._nearer(downs[np.argmax(np.linalg.norm(beside, axis=1))]).down
        axis = np.cross(other - down, third - down)
        if np.linalg.norm(axis) <= BENT:
            axis = np.cross(down, other)
        axis /= np.linalg.norm(axis)
        if np.abs((downs - down) @ axis).max() > OFF_ROW:
            return {"rolls": "all ways"}
        return {"rolls": "about an axis", "axis": axis * math.copysign(1.0, axis[np.argmax(np.abs(axis))]) + 0.0}

    def _nearer(self, down: FloatArray) -> _Lowest:
        """Look for what is lowest about a down where something is round, ten times as near each time."""
        height_m, zoom, n_tries = float(self.heights(down[None])[0]), 0, 0
        if not self.is_round or self._lies_flat(down, height_m):
            return _Lowest(down, height_m)
        while zoom < N_ZOOMS and n_tries < MOST_TRIES:
            ways = np.linalg.svd(down[None])[2][1:]
            near = unit_rows(down + 2.0 * math.pi / N_AROUND / 10.0**zoom * RING @ ways)
            points = [lowest_points(shape, near) for shape in self._part.parts]
            beside = hull_of(np.concatenate([*points, self._points[self._is_low(down)]])).normals
            beside = beside[beside @ down > SAME_SIDE]
            heights = self.heights(beside)
            if len(beside) and self._falls(down, beside[best := int(np.argmin(heights))]):
                down, height_m = beside[best], float(heights[best])
            else:
                zoom += 1
            n_tries += 1
        return _Lowest(down, height_m)

    def _lies_flat(self, down: FloatArray, height_m: float) -> bool:
        """Whether the part lies on a flat place of its own, not on one that stands for something round."""
        own_m = float(((self._points - self._center) @ down).max())
        return height_m - own_m <= SAME_HEIGHT * self._size_m and self._contact(down).is_flat

    def _falls(self, down: FloatArray, other: FloatArray) -> bool:
        """Whether the centre of gravity sinks all the way from one down to another."""
        shares = np.linspace(0.0, 1.0, N_ON_WAY)[:, None]
        heights = self.heights(unit_rows(down + shares * (other - down)))
        rounding = ROUNDING * self._size_m
        return bool((np.diff(heights) <= rounding).all() and heights[-1] < heights[0] - rounding)

    def _contact(self, down: FloatArray) -> ContactArea:
        return contact_area(self._part.parts, down, self._center, SAME_HEIGHT * self._size_m)

    def _is_low(self, down: FloatArray) -> NDArray[np.bool_]:
        depths = (self._points - self._center) @ down
        is_low: NDArray[np.bool_] = depths >= depths.max() - LOW * self._size_m
        return is_low

    def pose(self, at: _Lowest, area: float, rise_m: float) -> RestingPose:
        lies_on = self._contact(at.down)
        names = [self._part.element_names[index] for index in lies_on.parts]
        return RestingPose(
            at.down,
            _standing(at, self._center),
            tuple(names),
            at.height_m,
            lies_on.margin_m,
            rise_m,
            area / (4.0 * math.pi),
            at.rolls,
            at.axis,
        )


def _standing(at: _Lowest, center_m: FloatArray) -> Pose:
    """Return the pose on the plane z = 0 that has a vector of the object point down."""
    w, x, y, z = turn_from_z(-at.down).tolist()
    turned = Pose(quaternion_wxyz=(w, -x, -y, -z))
    return Pose(np.array((0.0, 0.0, at.height_m)) - turned.transform(center_m), turned.quaternion_wxyz)
