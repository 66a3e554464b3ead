"""Rounded convex bodies, and how far apart two of them are: written anew from their corners, as an oracle must be.

Two points, one of each body, are never nearer than the bodies; a plane between them never says that they are farther.
Here the nearest points are sought over all corners, edges and triangles, and the planes along all faces and pairs of
edges, without asking which of them can count.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations, pairwise

import numpy as np
from scipy.spatial import ConvexHull

from cagepose import Box, Pose
from cagepose.model.shapes import Capsule, Convex, Sphere

CUBE = np.array([(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])


@dataclass(frozen=True, eq=False)
class Body:
    """Corners (n, 3) of the core with its edges (n, 2), triangles (n, 3), directions normal to faces (n, 3), radius."""

    corners: np.ndarray
    edges: np.ndarray
    triangles: np.ndarray
    normals: np.ndarray
    radius: float

    @property
    def size(self) -> float:
        return float(np.linalg.norm(np.ptp(self.corners, axis=0))) + 2.0 * self.radius

    @property
    def is_sharp_solid(self) -> bool:
        return self.radius == 0.0 and len(self.normals) > 1

    def at(self, pose: Pose) -> Body:
        rotation = pose.rotation
        return Body(pose.transform(self.corners), self.edges, self.triangles, self.normals @ rotation.T, self.radius)


def body_of(part: Box | Sphere | Capsule | Convex | np.ndarray) -> Body:
    """Return a part, or a point (3,), in the frame of its object or cage."""
    if isinstance(part, np.ndarray):
        return _body(part[None], 0.0)
    if isinstance(part, Box):
        return _body(part.corners_object(), 0.0)
    corners = part.vertices_m if isinstance(part, Convex) else part.core()
    return _body(part.pose_body_shape.transform(corners), part.radius_m)


def _body(corners: np.ndarray, radius: float) -> Body:
    none = np.empty((0, 2), int), np.empty((0, 3), int)
    if len(corners) == 1:
        return Body(corners, *none, np.empty((0, 3)), radius)
    if len(corners) == 2:
        return Body(corners, np.array([[0, 1]]), none[1], np.empty((0, 3)), radius)
    middle, (_, extents, axes) = corners.mean(axis=0), np.linalg.svd(corners - corners.mean(axis=0))
    if extents[2] < 1e-9 * extents[0]:
        flat = ConvexHull((corners - middle) @ axes[:2].T)
        loop = flat.vertices
        triangles = np.array([(loop[0], one, other) for one, other in pairwise(loop[1:])])
        return Body(corners, flat.simplices, triangles, axes[2:], radius)
    hull = ConvexHull(corners)
    sides = (pair for triangle in hull.simplices.tolist() for pair in combinations(sorted(triangle), 2))
    edges = set(sides)
    return Body(corners, np.array(sorted(edges)), hull.simplices, hull.equations[:, :3], radius)


def cross(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Cross products of rows (..., 3), digit by digit those of `np.cross`, which takes four times as long for a few."""
    a, b, c, u, v, w = (rows[..., k] for rows in (one, other) for k in range(3))
    return np.stack([b * w - c * v, c * u - a * w, a * v - b * u], axis=-1)


def nearest(one: Body, other: Body) -> tuple[float, np.ndarray]:
    """Return the least distance of the cores, and the way from a nearest point of the first to the other's."""
    ways = [
        _corner_to_corner(one, other),
        _corners_to_edges(one, other),
        -_corners_to_edges(other, one),
        _corners_to_triangles(one, other),
        -_corners_to_triangles(other, one),
        _edges_to_edges(one, other),
    ]
    rows = np.concatenate(ways)
    lengths = np.linalg.norm(rows, axis=1)
    at = int(lengths.argmin())
    return float(lengths[at]), rows[at]


def separation(one: Body, other: Body) -> float:
    """Return the greatest distance of two planes between the cores, over all directions that can tell; below zero where
    the cores overlap.
    """
    return _separation(one, other, nearest(one, other)[1])


def _separation(one: Body, other: Body, way: np.ndarray) -> float:
    axes = [one.normals, other.normals, way[None]]
    sides = [_along_edges(body) for body in (one, other)]
    axes.append(cross(sides[0][:, None], sides[1][None]).reshape(-1, 3))
    for side, body in zip(sides, (one, other), strict=True):
        if len(body.normals) == 1:
            axes.append(cross(side, body.normals[0]))
    rows = np.concatenate(axes)
    lengths = np.linalg.norm(rows, axis=1)
    rows = rows[lengths > 1e-9 * lengths.max(initial=0.0)]
    if len(rows) == 0:
        return 0.0
    rows = rows / np.linalg.norm(rows, axis=1)[:, None]
    along_one, along_other = one.corners @ rows.T, other.corners @ rows.T
    ahead = along_other.min(axis=0) - along_one.max(axis=0)
    behind = along_one.min(axis=0) - along_other.max(axis=0)
    return float(max(ahead.max(), behind.max()))


def gap(one: Body, other: Body) -> float:
    """Return the distance of two bodies; of those that overlap, how deep, below zero (of round ones the least)."""
    distance, way = nearest(one, other)
    apart = _separation(one, other, way)
    return (distance if apart > 0.0 else apart) - one.radius - other.radius


def _along_edges(body: Body) -> np.ndarray:
    along = body.corners[body.edges[:, 1]] - body.corners[body.edges[:, 0]]
    return along / np.linalg.norm(along, axis=1)[:, None] if len(along) else along.reshape(0, 3)


def _corner_to_corner(one: Body, other: Body) -> np.ndarray:
    return (other.corners[None] - one.corners[:, None]).reshape(-1, 3)


def _corners_to_edges(one: Body, other: Body) -> np.ndarray:
    starts = other.corners[other.edges[:, 0]]
    along = other.corners[other.edges[:, 1]] - starts
    seen = one.corners[:, None] - starts
    share = np.clip((seen * along).sum(-1) / np.maximum((along * along).sum(-1), 1e-300), 0.0, 1.0)
    return (share[..., None] * along - seen).reshape(-1, 3)


def _corners_to_triangles(one: Body, other: Body) -> np.ndarray:
    first = other.corners[other.triangles[:, 0]]
    u, w = (other.corners[other.triangles[:, k]] - first for k in (1, 2))
    normal = cross(u, w)
    square = np.maximum((normal * normal).sum(-1), 1e-300)
    seen = one.corners[:, None] - first
    a = (cross(seen, w) * normal).sum(-1) / square
    b = (cross(u, seen) * normal).sum(-1) / square
    inside = (a >= 0.0) & (b >= 0.0) & (a + b <= 1.0)
    return (a[..., None] * u + b[..., None] * w - seen)[inside]


def _edges_to_edges(one: Body, other: Body) -> np.ndarray:
    p, q = one.corners[one.edges[:, 0]][:, None], other.corners[other.edges[:, 0]][None]
    u = one.corners[one.edges[:, 1]][:, None] - p
    w = other.corners[other.edges[:, 1]][None] - q
    crossed = cross(u, w)
    square = np.maximum((crossed * crossed).sum(-1), 1e-300)
    s = (cross(q - p, w) * crossed).sum(-1) / square
    t = (cross(q - p, u) * crossed).sum(-1) / square
    inside = (s >= 0.0) & (s <= 1.0) & (t >= 0.0) & (t <= 1.0)
    return (q + t[..., None] * w - p - s[..., None] * u)[inside]


def random_part(rng: np.random.Generator, pose: Pose | None = None) -> Box | Sphere | Capsule | Convex:
    """A part of about unit size: a ball, a round bar, a box, a plate or a hull, with sharp or round edges."""
    kind = rng.choice(["sphere", "capsule", "box", "box", "hull", "hull", "prism", "plate"])
    radius = float(10.0 ** rng.uniform(-2.5, -0.3))
    if kind == "sphere":
        return Sphere(radius, pose)
    if kind == "capsule":
        return Capsule(radius, float(rng.uniform(0.2, 2.0)), pose)
    edges = rng.uniform(0.2, 1.0, 3)
    if rng.random() < 0.2:
        edges[rng.integers(3)] *= 10.0 ** rng.uniform(-2.0, 1.0)
    if kind == "box":
        return Box(edges, pose)
    rounding = radius if rng.random() < 0.5 else float(rng.choice([0.0, 0.0, 1e-12]))
    if kind == "prism":
        n = int(rng.integers(3, 7))
        angles = 2.0 * np.pi * np.arange(n) / n
        ring = np.column_stack([np.cos(angles), np.sin(angles)])
        corners = np.concatenate([np.column_stack([ring, np.full(n, z)]) for z in (-1.0, 1.0)]) * edges / 2.0
    elif kind == "plate":
        corners, rounding = rng.normal(size=(int(rng.integers(3, 7)), 3)) * (*edges[:2], 0.0), radius
    else:
        corners = rng.normal(size=(int(rng.integers(4, 13)), 3)) * edges / 2.0
    return Convex(corners, rounding, pose)


def random_turn(rng: np.random.Generator) -> np.ndarray:
    """A quaternion: any, or by quarters of a turn about axes, or nearly so."""
    if rng.random() < 0.5:
        return rng.normal(size=4)
    turn = Pose(euler_zyx=np.pi / 4.0 * rng.choice([0, 0, 1, 2, 2, 4, 6], 3)).quaternion_wxyz
    return turn + rng.normal(size=4) * (10.0 ** rng.uniform(-14, -2) if rng.random() < 0.4 else 0.0)


def placed_at(one: Body, other: Body, turn: np.ndarray, towards: np.ndarray, distance: float) -> Pose:
    """Return a pose of the first body, turned, with a gap of ``distance`` (above minus its radii) to the other.

    It stands off in a direction, and then goes along the way between the nearest points.
    """
    middle = other.corners.mean(axis=0)
    away = towards / np.linalg.norm(towards) * (one.size + other.size + abs(distance))
    turned = Pose((0, 0, 0), turn)
    start = middle - turned.transform(one.corners).mean(axis=0) + away
    apart, way = nearest(one.at(Pose(start, turn)), other)
    return Pose(start + way / apart * (apart - one.radius - other.radius - distance), turn)
