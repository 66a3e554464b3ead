"""Cylinders, cones, discs and all rounded parts as hulls of circles, and how far apart two of them are: an oracle.

Any two points, one of each body, are no nearer to each other than the bodies; two planes across a direction with a body
beyond each are no farther apart. Both are sought at once: of the points where the bodies end along directions so far,
the nearest combination is found by least squares, and the way between is the next direction.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.optimize import nnls

from cagepose import Box, Pose
from cagepose.model.shapes import Capsule, Cone, Cylinder, Disc, Rounded, Shape, Sphere, Turned
from shapes.convex_bodies import random_part

ITERATIONS, ENOUGH, MOST_POINTS = 200, 1e-14, 24
ORIGIN = np.array((0.0, 0.0, 0.0, 1.0))


@dataclass(frozen=True, eq=False)
class Circles:
    """The hull of circles (a radius of zero: a point), blown up by a radius.

    Attributes
    ----------
    centers, axes, radii
        Of the circles, (n, 3), (n, 3), (n,).
    radius
        Added on all sides.
    """

    centers: np.ndarray
    axes: np.ndarray
    radii: np.ndarray
    radius: float

    @property
    def size(self) -> float:
        spread = float(np.linalg.norm(np.ptp(self.centers, axis=0)))
        return spread + 2.0 * (float(self.radii.max()) + self.radius)

    @property
    def middle(self) -> np.ndarray:
        return self.centers.mean(axis=0)

    @property
    def reach(self) -> float:
        return float((np.linalg.norm(self.centers - self.middle, axis=1) + self.radii).max()) + self.radius

    def at(self, pose: Pose) -> Circles:
        return Circles(pose.transform(self.centers), self.axes @ pose.rotation.T, self.radii, self.radius)

    def moved(self, by: np.ndarray) -> Circles:
        return Circles(self.centers + by, self.axes, self.radii, self.radius)

    @cached_property
    def is_sharp(self) -> bool:
        """Whether all circles are points."""
        return not self.radii.any()

    def end_along(self, normal: np.ndarray) -> np.ndarray:
        """Return a point where the body, without the radius, ends along a unit normal."""
        if self.is_sharp:
            return self.centers[(self.centers @ normal).argmax()]
        across = normal - (self.axes @ normal)[:, None] * self.axes
        sines = np.sqrt(np.einsum("ij,ij->i", across, across))
        at = int((self.centers @ normal + self.radii * sines).argmax())
        center, axis, radius, sine = self.centers[at], self.axes[at], self.radii[at], sines[at]
        if sine * radius < 1e-15:
            return center
        outward = across[at] / sine
        outward = outward - (axis @ outward) * axis  # by rounding, where the normal is nearly the axis
        return center + radius / math.sqrt(outward @ outward) * outward


class Nearest(NamedTuple):
    """Bounds on how far apart two bodies are without their radii, and the normal of the first that gives the lower."""

    low: float
    high: float
    normal: np.ndarray


def circles_of(part: Shape) -> Circles:
    """Return a part in the frame of its object or cage."""
    if isinstance(part, Turned):
        pose, (heights, radii) = part.pose_body_shape, np.array(part.rims).T
        centers = pose.transform(np.column_stack([0.0 * heights, 0.0 * heights, heights]))
        return Circles(centers, np.tile(pose.rotation[:, 2], (len(radii), 1)), radii, 0.0)
    corners = part.corners_object() if isinstance(part, Box) else part.nodes_body()
    radius = part.radius_m if isinstance(part, Rounded) else 0.0
    return Circles(corners, np.zeros_like(corners), np.zeros(len(corners)), radius)


def nearest(one: Circles, other: Circles, enough: float = ENOUGH, plenty: float = np.inf) -> Nearest:
    """Return how far apart two bodies are without their radii; they are into each other: the lower bound is -inf.

    Bounds that differ by a share ``enough`` of the bodies' size will do; of what is farther apart than ``plenty``,
    a tenth of what is beyond that may stay open.
    """
    size = max(one.reach, other.reach)
    way = other.middle - one.middle
    if not way.any():
        way = np.array((0.0, 0.0, 1.0))
    points, n_points = np.ones((4, MOST_POINTS + 1)), 0
    low, high, normal, stalled = -np.inf, np.inf, way, 0
    for _ in range(ITERATIONS):
        along = way / math.sqrt(way @ way)
        point = other.end_along(-along) - one.end_along(along)
        points[:3, n_points] = point / size
        n_points += 1
        if along @ point > low:
            low, normal, stalled = float(along @ point), along, 0
        try:
            shares, _ = nnls(points[:, :n_points], ORIGIN)
        except RuntimeError:  # goes round in circles, of points that differ by rounding alone
            break
        way = size * (points[:3, :n_points] @ (shares / shares.sum()))
        apart = math.sqrt(way @ way)
        high, stalled = min(high, apart), stalled + 1
        if high - low <= max(enough * size, 0.1 * (low - plenty)) or stalled > 12 or apart <= 1e-15 * size:
            break
        if n_points > MOST_POINTS:
            kept = points[:, :n_points][:, shares > 0.0]
            n_points = kept.shape[1]
            points[:, :n_points] = kept
    return Nearest(low, high, normal)


def gap(
    one: Circles,
    other: Circles,
    normal: np.ndarray | None = None,
    enough: float = ENOUGH,
    is_rough: bool = False,
) -> tuple[float, np.ndarray]:
    """Return how far apart two bodies are at least, below zero how deep into each other at most, and the normal there.

    Those that touch or overlap are moved apart along a normal first, and nowhere farther than by so much: of those that
    are not deep in each other, with a normal near the true one, what is left over is their gap. It ends where that
    changes by a share ``enough`` of their size at most. Of those that are apart a rough answer is a tenth too low.
    """
    size, radius = max(one.size, other.size), one.radius + other.radius
    told = nearest(one, other, enough, radius if is_rough else np.inf)
    if told.low > (radius if is_rough else 1e-2 * size):
        return told.low - radius, told.normal
    if told.low > 0.0 or normal is None:
        normal = told.normal
    best, by = max(told.low, -size), 0.5 * size
    for _ in range(ITERATIONS):
        told = nearest(one.moved(-by * normal), other, enough)
        is_better = told.low - by > best + enough * size
        if is_better:
            best, normal = told.low - by, told.normal
        if (
            by > 2e-3 * size
        ):  # the nearer, the faster the normal turns into the true one, and the more there is rounding
            by = max(0.2 * by, 2e-3 * size, -2.0 * best)
        elif not is_better:
            break
    return best - radius, normal


def overlap(one: Circles, other: Circles) -> bool:
    """Whether two bodies surely have points in common."""
    return nearest(one, other).high < one.radius + other.radius - 1e-14 * max(one.size, other.size)


def placed_at(one: Circles, other: Circles, turn: np.ndarray, towards: np.ndarray, distance: float) -> Pose:
    """Return a pose of the first body, turned, with a gap of ``distance`` (a little below zero: so deep) to the other.

    It stands off in a direction, and then goes along the way between the nearest points.
    """
    away = towards / np.linalg.norm(towards) * (one.size + other.size + abs(distance))
    start = other.middle - Pose((0, 0, 0), turn).transform(one.middle) + away
    told = nearest(one.at(Pose(start, turn)), other)
    return Pose(start + told.normal * (told.low - one.radius - other.radius - distance), turn)


ROUND_NUMBERS = np.array([0.25, 0.5, 1.0])


def random_turned(rng: np.random.Generator, pose: Pose | None = None) -> Shape:
    """A cylinder, a cone, one with a tip, a disc, or another part, of about unit size, often in round numbers."""
    kind = rng.choice(["cylinder", "cylinder", "cone", "cone", "tip", "disc", "ball", "bar", "other"])
    if kind == "other":
        return random_part(rng, pose)
    a, b, c = rng.choice(ROUND_NUMBERS, 3) if rng.random() < 0.5 else 10.0 ** rng.uniform(-1.0, 0.0, 3)
    if kind == "cylinder":
        return Cylinder(a, 2.0 * b, pose)
    if kind == "cone":
        return Cone(a, c, 2.0 * b, pose)
    if kind == "tip":
        return Cone(*((a, 0.0) if rng.random() < 0.5 else (0.0, a)), 2.0 * b, pose)
    if kind == "disc":
        return Disc(a, pose)
    return Sphere(a, pose) if kind == "ball" else Capsule(a, 2.0 * b, pose)
