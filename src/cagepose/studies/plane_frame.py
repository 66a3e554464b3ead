"""Poses of a part in its plane as three numbers, and bounds for all poses near one: `PlaneFrame`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from cagepose.kernels.algebra.pose import Quaternion, quaternion_about, quaternion_product
from cagepose.kernels.algebra.vector import Vector, vector_from
from cagepose.model.boundary.features import boundary_of
from cagepose.model.checks import FloatArray
from cagepose.model.facets import Facets
from cagepose.model.planar import normal_axis
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.model.shapes import Shape

N_WAYS = 256
"""Directions in the plane along which it is asked how far parts reach."""
BEYOND = 1.0 / math.cos(math.pi / N_WAYS)
"""Nothing reaches farther between two of them, times that along them."""
NO_FORCES = np.zeros((0, 3))


class InPlane(NamedTuple):
    """A pose: the place of the object's middle along the two axes of the plane, metres, and the turn from where it
    starts, radians.
    """

    u: float
    v: float
    turn: float


class Block(NamedTuple):
    """All poses that differ from one by no more than ``half_m`` along either axis and ``half_rad`` in the turn."""

    middle: InPlane
    half_m: float
    half_rad: float


class PlaneFrame:
    """A scene's plane, what moves in it, and the work of a load there.

    Attributes
    ----------
    start
        The pose at which the object starts.
    reach_m
        No point of the object is farther from its middle, as seen along the plane's normal, metres.
    axes
        Which axes of the world are the plane's.
    load
        The sum of the sizes of all forces in the plane.
    center, outside_m
        Where the object's middle is farther than ``outside_m`` from there, (2,), nothing of the cage is in its reach.
    """

    def __init__(self, scene: Scene, forces: FloatArray = NO_FORCES, points_object: FloatArray = NO_FORCES) -> None:
        """``forces`` (n, 3) act at points (n, 3) of the object and keep their direction; left out: nothing acts."""
        assert scene.planar is not None
        self._normal = normal_axis(scene.planar)
        self.axes = [axis for axis in range(3) if axis != self._normal]
        self._turn_axis = vector_from(self.normal)
        self._sense = -1.0 if self._normal == 1 else 1.0  # about y, z turns toward x
        held, cage = scene.object, scene.cage
        pose = held.pose_world_object
        around, ways = np.linspace(0.0, 2.0 * math.pi, N_WAYS, endpoint=False), np.zeros((N_WAYS, 3))
        ways[:, self.axes] = np.stack([np.cos(around), np.sin(around)], axis=1)
        heights = _heights(held.parts, scene.touch_m, ways @ pose.rotation)
        self._arm, self.reach_m = _circle_around(ways, heights)
        at = cage.pose_world_cage
        heights = _heights(cage.shapes, scene.touch_m, ways @ at.rotation)
        heights = np.maximum(heights, (ways @ at.rotation @ cage.points_cage.T).max(axis=1, initial=-np.inf))
        center, radius_m = _circle_around(ways, heights + ways @ at.position_m)
        self.center, self.outside_m = center[self.axes], radius_m + self.reach_m
        self._quaternion, self._level = pose.as_tuples()[1], float((pose.position_m + self._arm)[self._normal])
        place = (pose.position_m + self._arm)[self.axes]
        self.start = InPlane(float(place[0]), float(place[1]), 0.0)
        # Of a turn, the forces' work is C cos + S sin of the angle.
        arms = (points_object @ pose.rotation.T - self._arm)[:, self.axes]
        acting = forces[:, self.axes]
        self._force = (float(acting[:, 0].sum()), float(acting[:, 1].sum()))
        self.load = float(np.linalg.norm(acting, axis=1).sum())
        even = float((acting * arms).sum())
        odd = self._sense * float((acting * np.stack([-arms[:, 1], arms[:, 0]], axis=1)).sum())
        self._swing, self._phase = math.hypot(even, odd), math.atan2(odd, even)

    def pose_of(self, at: InPlane) -> tuple[Vector, Quaternion]:
        """Return a pose as kernels take it."""
        cosine, sine = math.cos(at.turn), self._sense * math.sin(at.turn)
        a, b = (float(self._arm[axis]) for axis in self.axes)
        position = [0.0, 0.0, 0.0]
        position[self.axes[0]] = at.u - (cosine * a - sine * b)
        position[self.axes[1]] = at.v - (sine * a + cosine * b)
        position[self._normal] = self._level - float(self._arm[self._normal])
        turned = quaternion_product(quaternion_about(self._turn_axis, at.turn), self._quaternion)
        return (position[0], position[1], position[2]), turned

    def pose(self, at: InPlane) -> Pose:
        return Pose(*self.pose_of(at))

    def goes_by(self, block: Block) -> float:
        """Return how far any point of the object moves at most, from the middle of a block to a pose of it, metres."""
        turned = 2.0 * self.reach_m * math.sin(min(0.5 * block.half_rad, 0.5 * math.pi))
        return math.sqrt(2.0) * block.half_m + turned

    def may_be_outside(self, block: Block) -> bool:
        """Whether a pose of a block is out of reach of the cage."""
        u, v = (abs(at - float(to)) + block.half_m for at, to in zip(block.middle[:2], self.center, strict=True))
        return bool(math.hypot(u, v) >= self.outside_m)

    def from_center(self, at: InPlane) -> float:
        """Return how far the object's middle is from that of the cage, metres."""
        return math.hypot(at.u - float(self.center[0]), at.v - float(self.center[1]))

    def place(self, at: InPlane) -> FloatArray:
        """Return where the object's middle is in the world, (3,), metres."""
        found = np.zeros(3)
        found[self.axes], found[self._normal] = at[:2], self._level
        return found

    def at(self, place: FloatArray, turn: float) -> InPlane:
        """Return the pose with the object's middle at a place of the world, (3,)."""
        return InPlane(float(place[self.axes[0]]), float(place[self.axes[1]]), turn)

    @property
    def normal(self) -> FloatArray:
        """The axis of the world that turns are about, (3,)."""
        axis: FloatArray = np.eye(3)[self._normal]
        return axis

    def potential(self, at: InPlane) -> float:
        """Return the work against the load from where its points are in the middle, joules."""
        return -self._force[0] * at.u - self._force[1] * at.v - self._swing * math.cos(at.turn - self._phase)

    def highest(self, begin: InPlane, end: InPlane) -> InPlane:
        """Return the pose of the greatest potential on a turn, or on a travel, from one pose to another."""
        asked = [begin, end]
        if begin.turn != end.turn:
            low, high = sorted((begin.turn, end.turn))
            top = low + (self._phase + math.pi - low) % (2.0 * math.pi)
            asked += [begin._replace(turn=top)] if top < high else []
        return max(asked, key=self.potential)

    def potentials(self, block: Block) -> tuple[float, float]:
        """Return the least and the greatest potential in a block."""
        u, v, turn = block.middle
        level = -self._force[0] * u - self._force[1] * v
        spread = (abs(self._force[0]) + abs(self._force[1])) * block.half_m
        away = abs((turn - self._phase + math.pi) % (2.0 * math.pi) - math.pi)
        near, far = max(0.0, away - block.half_rad), min(math.pi, away + block.half_rad)
        return level - spread - self._swing * math.cos(near), level + spread - self._swing * math.cos(far)


def has_endless_holes(scene: Scene) -> bool:
    """Whether a hole of a scene stands alone: its plate has no end, and so nothing gets out of its reach."""
    return any(not hole.in_ for hole in (*scene.cage.holes, *scene.object.holes))


def nearest_in(block: Block, at: InPlane) -> InPlane:
    """Return the pose of a block that is nearest to one."""
    u, v, turn = block.middle
    away = (at.turn - turn + math.pi) % (2.0 * math.pi) - math.pi
    return InPlane(
        min(max(at.u, u - block.half_m), u + block.half_m),
        min(max(at.v, v - block.half_m), v + block.half_m),
        turn + min(max(away, -block.half_rad), block.half_rad),
    )


def _heights(parts: Sequence[Shape], touch_m: float, ways: FloatArray) -> FloatArray:
    """Return how far parts reach along directions (n, 3) of their body's frame, metres."""
    found: FloatArray = np.max([_height(part, touch_m, ways) for part in parts], axis=0, initial=-np.inf)
    return found


def _height(part: Shape, touch_m: float, ways: FloatArray) -> FloatArray:
    """As `_heights`, of one part: of a round one of triangles, which are within it, as far as the boxes around its
    features.
    """
    if not isinstance(part, Facets) or not part.is_round:
        return part.heights_m(ways)
    boxes = np.asarray(boundary_of((part,), touch_m).nodes)
    boxes = boxes[(boxes["left"] < 0) & (boxes["first"] < boxes["last"])]
    found: FloatArray = (ways @ boxes["middle"].T + np.abs(ways) @ boxes["half"].T).max(axis=1)
    return found


def _circle_around(ways: FloatArray, heights: FloatArray) -> tuple[FloatArray, float]:
    """Return the middle of what reaches so high along directions all around, (3,), and the radius of a circle around it
    there.
    """
    quarter = N_WAYS // 4
    wide = [0.5 * (heights[k] - heights[k + 2 * quarter]) for k in (0, quarter)]
    middle = wide[0] * ways[0] + wide[1] * ways[quarter]
    return middle, BEYOND * float((heights - ways @ middle).max())
