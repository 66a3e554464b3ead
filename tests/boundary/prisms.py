"""Prisms with arcs in their profiles, as triangles that stand for planes and cylinders."""

from __future__ import annotations

import math
from typing import NamedTuple

import manifold3d
import numpy as np

from cagepose import Facets
from cagepose.model.surfaces import CYLINDER, PLANE, Surface

CHORD = 2.0 * math.pi / 64.0


class Corner(NamedTuple):
    """A corner of a profile, (x, z), and the centre of the arc that leads from there to the next; None: a line does."""

    at: tuple[float, float]
    center: tuple[float, float] | None = None


def prism(profile: list[Corner], length: float, name: str = "prism") -> Facets:
    """Return a prism along y, its middle at y = 0. The profile leads around it counter-clockwise as x is drawn to the
    right and z up; arcs are less than half a turn, or just that to the left.
    """
    points, sides = list[np.ndarray](), list[int]()
    surfaces = list[Surface]()
    half = length / 2.0
    for k, corner in enumerate(profile):
        start, end = np.array(corner.at), np.array(profile[(k + 1) % len(profile)].at)
        surfaces.append(_side(corner, start, end))
        steps = _steps(corner, start, end)
        points += steps
        sides += [k] * len(steps)
    n = len(points)
    rows = np.array(points)
    vertices = np.concatenate([np.insert(rows, 1, -half, axis=1), np.insert(rows, 1, half, axis=1)])
    caps = manifold3d.triangulate([rows])
    triangles, on = [], []
    for a, b, c in np.asarray(caps).tolist():
        triangles += [(a, b, c), (n + a, n + c, n + b)]
        on += [len(profile), len(profile) + 1]
    for k in range(n):
        beside = (k + 1) % n
        triangles += [(k, n + k, n + beside), (k, n + beside, beside)]
        on += [sides[k]] * 2
    surfaces += [Surface(PLANE, (0.0, -half, 0.0), (0.0, -1.0, 0.0)), Surface(PLANE, (0.0, half, 0.0), (0.0, 1.0, 0.0))]
    return Facets(vertices, np.array(triangles), None, None, name, surfaces, on)


def cradle(wide: float = 0.02, deep: float = 0.01, radius: float = 0.005) -> Facets:
    """A block with a half-round groove of the given radius along the middle of its top, which is at z = 0."""
    return prism(
        [
            Corner((-wide, -deep)),
            Corner((wide, -deep)),
            Corner((wide, 0.0)),
            Corner((radius, 0.0), (0.0, 0.0)),
            Corner((0.0, -radius), (0.0, 0.0)),
            Corner((-radius, 0.0)),
            Corner((-wide, 0.0)),
        ],
        0.04,
        "cradle",
    )


def _side(corner: Corner, start: np.ndarray, end: np.ndarray) -> Surface:
    if corner.center is None:
        x, z = (end - start) / np.linalg.norm(end - start)
        return Surface(PLANE, (float(start[0]), 0.0, float(start[1])), (float(z), 0.0, float(-x)))
    cx, cz = corner.center
    radius = math.hypot(start[0] - cx, start[1] - cz)
    return Surface(CYLINDER, (cx, 0.0, cz), (0.0, 1.0, 0.0), math.copysign(radius, _turn(corner, start, end)))


def _turn(corner: Corner, start: np.ndarray, end: np.ndarray) -> float:
    """Return how far an arc turns to the left, radians; below zero: to the right, which is hollow."""
    assert corner.center is not None
    (x, z), (u, w) = start - corner.center, end - corner.center
    return math.atan2(x * w - z * u, x * u + z * w)


def _steps(corner: Corner, start: np.ndarray, end: np.ndarray) -> list[np.ndarray]:
    """Return the corners of the triangles along one side of the profile, but for its last."""
    if corner.center is None:
        return [start]
    turn, center = _turn(corner, start, end), np.array(corner.center)
    n = max(2, math.ceil(abs(turn) / CHORD - 1e-9))
    x, z = start - center
    angles = [turn * k / n for k in range(n)]
    arms = [(x * math.cos(a) - z * math.sin(a), x * math.sin(a) + z * math.cos(a)) for a in angles]
    return [center + np.array(arm) for arm in arms]
