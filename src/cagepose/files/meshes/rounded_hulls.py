"""A convex body of flat faces that stands for a hull blown up by a radius, such as a phone: `rounded_hull`.

Its corners lie on balls about the corners of the core, all of one radius. A corner and its neighbours tell such a ball;
all corners that hang together on it tell it to the last digits.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.files.meshes.edges import edges_of
from cagepose.files.meshes.manifolds import Triangles
from cagepose.files.meshes.tolerances import DISTANCE_OF_BALL
from cagepose.model.checks import FloatArray
from cagepose.model.hull import Hull, hull_of

MOST_SEEDS = 1000
"""Corners of a body that are asked for a ball at most."""
FEWEST_POINTS = 6
"""Points that tell a ball: four lie on one always."""


class RoundedHull(NamedTuple):
    """Corners of the core, (n, 3), the radius, and how far the faces are within at most."""

    core: FloatArray
    radius: float
    error: float


class Ball(NamedTuple):
    """A ball through points, and how far these are off it, from the nearest to the farthest."""

    center: FloatArray
    radius: float
    off: float


def rounded_hull(hull: Triangles, allowed: float) -> RoundedHull | None:
    """Return the rounded hull that a convex body stands for, its corners on it within ``allowed``; None: it is none."""
    balls = _balls(hull, allowed)
    if len(balls) < 2:
        return None
    radius = float(np.median([ball.radius for ball in balls]))
    if max(abs(ball.radius - radius) for ball in balls) > 10.0 * allowed:
        return None
    core = hull_of(np.array([ball.center for ball in balls]))
    if core.dimension < 2 or np.abs(distances(core, hull.vertices) - radius).max() > 3.0 * allowed:
        return None
    return RoundedHull(core.vertices_m, radius, radius - float(distances(core, hull.face_points()).min()))


def _balls(hull: Triangles, allowed: float) -> list[Ball]:
    """Return the balls that parts of a surface lie on."""
    points, beside = hull.vertices, _neighbours(hull)
    left = np.ones(len(points), bool)
    found = []
    for seed in range(0, len(points), max(1, len(points) // MOST_SEEDS)):
        if not left[seed]:
            continue
        patch = np.append(beside[seed], seed)
        if len(patch) < FEWEST_POINTS:
            continue
        ball = ball_through(points[patch])
        if ball.off > allowed or ball.radius > hull.size:
            continue
        patch = _patch(points, beside, seed, ball)
        ball = ball_through(points[patch])
        if ball.off <= 2.0 * allowed:
            left[patch] = False
            found.append(ball)
    return found


def _neighbours(hull: Triangles) -> list[NDArray[np.int64]]:
    """Return the corners at the other ends of the edges of each corner."""
    edges = edges_of(hull).corners
    both = np.concatenate([edges, edges[:, ::-1]])
    both = both[np.argsort(both[:, 0], kind="stable")]
    return np.split(both[:, 1], np.cumsum(np.bincount(both[:, 0], minlength=len(hull.vertices)))[:-1])


def _patch(points: FloatArray, beside: list[NDArray[np.int64]], seed: int, ball: Ball) -> NDArray[np.int64]:
    """Return the corners that are on a ball and hang together with one."""
    is_on = np.abs(np.linalg.norm(points - ball.center, axis=1) - ball.radius) <= DISTANCE_OF_BALL * ball.radius
    patch, waiting = {seed}, [seed]
    while waiting:
        new = [corner for corner in beside[waiting.pop()].tolist() if is_on[corner] and corner not in patch]
        patch.update(new)
        waiting += new
    return np.array(sorted(patch))


def ball_through(points: FloatArray) -> Ball:
    """Return the ball whose surface is nearest to points."""
    middle = points.mean(axis=0)
    arms = points - middle
    rows = np.column_stack([2.0 * arms, np.ones(len(points))])
    found = np.linalg.lstsq(rows, (arms**2).sum(axis=1), rcond=None)[0]
    away = np.linalg.norm(arms - found[:3], axis=1)
    return Ball(middle + found[:3], float(away.mean()), float(np.ptp(away)))


def distances(core: Hull, points: FloatArray) -> FloatArray:
    """Return how far points outside of a hull are from it: of its edges and of the faces that they are above, the
    least.
    """
    least = np.full(len(points), np.inf)
    for start, end in core.vertices_m[core.edges]:
        span = end - start
        share = np.clip((points - start) @ span / (span @ span), 0.0, 1.0)
        least = np.minimum(least, np.linalg.norm(points - start - np.outer(share, span), axis=1))
    for loop, normal in zip(core.faces, core.normals, strict=True):
        corners = core.vertices_m[list(loop)]
        inwards = np.cross(normal, np.roll(corners, -1, axis=0) - corners)
        is_above = np.all(
            [(points - corner) @ side >= 0.0 for corner, side in zip(corners, inwards, strict=True)], axis=0
        )
        heights = (points - corners[0]) @ normal
        least = np.where(is_above & (heights >= 0.0), np.minimum(least, heights), least)
    found: FloatArray = least
    return found
