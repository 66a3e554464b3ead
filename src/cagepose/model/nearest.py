"""The nearest points of two convex parts, by the method of Gilbert, Johnson and Keerthi.

The difference of two convex bodies is one, too, and their distance is how far it is from the origin. A simplex of its
points is led there: each next point is the farthest one against the simplex's nearest. Bodies with a radius are their
cores, and the radius is taken off at the end.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import combinations
from typing import NamedTuple

import numpy as np

from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled
from cagepose.model.box import Box
from cagepose.model.checks import FloatArray, as_vector
from cagepose.model.pose import Pose
from cagepose.model.shapes import Rounded, Shape, Turned
from cagepose.model.tolerances import LAST_GAIN

MOST_STEPS = 60


class Core(NamedTuple):
    """A convex part in the world.

    Attributes
    ----------
    farthest
        Returns the core's farthest point in a direction, (3,) both, metres.
    radius_m
        By which the core is blown up, metres.
    middle, reach_m
        A ball around the part, radius and all, (3,) and metres.
    """

    farthest: Callable[[FloatArray], FloatArray]
    radius_m: float
    middle: FloatArray
    reach_m: float

    def least_gap(self, other: Core) -> float:
        """Return how far apart two parts are at least, metres, by the balls around them."""
        return float(np.linalg.norm(self.middle - other.middle)) - self.reach_m - other.reach_m

    def gap_along(self, way: FloatArray, other: Core) -> float:
        """Return how far apart two parts are along a unit vector, which is how far they are at least."""
        between = other.farthest(-way) - self.farthest(way)
        return float(between @ way) - self.radius_m - other.radius_m


def core_of(part: Box | Shape | FloatArray, pose_world_body: Pose) -> Core:
    """Return a part of a body at a pose as `nearest_points` takes it; a single point (3,) of the world is one, too."""
    if isinstance(part, np.ndarray):
        return Core(lambda _: part, 0.0, part, 0.0)
    middle = part.nodes_body().mean(axis=0)
    ball = pose_world_body.transform(middle), part.farthest_m(middle)
    if isinstance(part, Turned):
        return Core(_farthest_of_turned(part, pose_world_body @ part.pose_body_shape), 0.0, *ball)
    nodes = pose_world_body.transform(part.nodes_body())
    radius_m = part.radius_m if isinstance(part, Rounded) else 0.0
    return Core(lambda way: nodes[int(np.argmax(nodes @ way))], radius_m, *ball)


def _farthest_of_turned(part: Turned, pose: Pose) -> Callable[[FloatArray], FloatArray]:
    rotation = pose.rotation

    def farthest(way: FloatArray) -> FloatArray:
        x, y, z = (way @ rotation).tolist()
        across = float(np.hypot(x, y))
        height, radius = max(part.rims, key=lambda rim: z * rim[0] + across * rim[1])
        outward = radius / across if across > 0.0 else 0.0
        found: FloatArray = rotation @ (outward * x, outward * y, height) + pose.position_m
        return found

    return farthest


def nearest_points(one: Core, other: Core) -> tuple[FloatArray, FloatArray]:
    """Return the points of two bodies, (3,) each, metres, that are nearest to each other; of bodies whose cores meet,
    twice about the same one.
    """
    pairs, shares = [_farthest_pair(one, other, np.ones(3))], [1.0]
    between = pairs[0].apart
    for _ in range(MOST_STEPS):
        square = dot(between, between)
        pair = _farthest_pair(one, other, -np.array(between))
        if square == 0.0 or square - dot(between, pair.apart) <= LAST_GAIN * square:
            break
        chosen, found, nearer = _nearest_subset([*pairs, pair])
        if dot(nearer, nearer) >= square:
            break
        pairs, shares, between = chosen, found, nearer
    place = shares @ np.array([pair.place for pair in pairs])
    foot = shares @ np.array([pair.foot for pair in pairs])
    apart = float(np.linalg.norm(place - foot))
    if apart == 0.0:
        return place, foot
    way = (foot - place) / apart
    return place + one.radius_m * way, foot - other.radius_m * way


class _Pair(NamedTuple):
    """Farthest points of two bodies, (3,) each, and the way from the second to the first."""

    place: FloatArray
    foot: FloatArray
    apart: Vector


def _farthest_pair(one: Core, other: Core, way: FloatArray) -> _Pair:
    place, foot = one.farthest(way), other.farthest(-way)
    return _Pair(place, foot, as_vector(place - foot))


def _nearest_subset(pairs: list[_Pair]) -> tuple[list[_Pair], list[float], Vector]:
    """Return the points of a simplex, the last one among them, that bear its point nearest to the origin, their shares
    in it, and that point.
    """
    points = [pair.apart for pair in pairs]
    last, best = len(pairs) - 1, (math.inf, [len(pairs) - 1], [1.0], points[-1])
    if last < 4:
        shares = _shares([minus(point, points[last]) for point in points[:last]], points[last])
        all_shares = [*shares, 1.0 - sum(shares)]
        if min(all_shares) > 0.0:  # within the simplex: all points bear it
            return pairs, all_shares, _mixed(points, all_shares)
    for size in range(min(len(pairs), 4)):
        for others in combinations(range(last), size):
            shares = _shares([minus(points[index], points[last]) for index in others], points[last])
            all_shares = [*shares, 1.0 - sum(shares)]
            if min(all_shares) < 0.0:
                continue
            chosen = [*others, last]
            nearest = _mixed([points[index] for index in chosen], all_shares)
            best = min(best, (norm(nearest), chosen, all_shares, nearest), key=lambda found: found[0])
    return [pairs[index] for index in best[1]], best[2], best[3]


def _mixed(points: list[Vector], shares: list[float]) -> Vector:
    mixed = (0.0, 0.0, 0.0)
    for point, share in zip(points, shares, strict=True):
        mixed = plus(mixed, scaled(point, share))
    return mixed


def _shares(ways: list[Vector], base: Vector) -> list[float]:
    """Return how much of each of up to three ways leads from a place nearest to the origin, by Cramer's rule; where
    there are two, their normal is the third. Ways in one line or plane get none: fewer of them lead there, too.
    """
    if len(ways) < 2:
        return [-dot(base, way) / (dot(way, way) or math.inf) for way in ways]
    one, other = ways[:2]
    normal = cross(one, other)
    third = ways[2] if len(ways) == 3 else normal
    volume = dot(normal, third) or math.inf
    volumes = dot(cross(base, other), third), dot(cross(one, base), third), dot(normal, base)
    return [-part / volume for part in volumes[: len(ways)]]
