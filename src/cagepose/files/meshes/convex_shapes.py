"""A convex body of flat faces as the shape that it stands for: `convex_shape`.

A box is one exactly. What is round has its corners on the true surface and its faces within it; by how much, the
sagitta, is its error.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from cagepose.files.meshes.box_corners import box_of_corners
from cagepose.files.meshes.manifolds import Triangles, circle_through
from cagepose.files.meshes.rounded_hulls import ball_through, rounded_hull
from cagepose.files.meshes.tolerances import SINGLE_PRECISION
from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose, turn_from_z
from cagepose.model.shapes import Capsule, Cone, Convex, Cylinder, Shape, Sphere

FEWEST_SIDES = 16
"""What has fewer sides is a prism that was meant so."""
SAGITTA_OF_FEWEST = 1.5 * (1.0 - math.cos(math.pi / FEWEST_SIDES))
"""Fraction of the radius. Faces of a ball that are farther within it are meant so."""
STEPS_OF_FIT = 30
"""The fit of a capsule takes so many steps at most; it converges quadratically."""


class Recognised(NamedTuple):
    """A shape, and by how much the body's surface is off from it at most."""

    shape: Shape
    error: float


def convex_shape(hull: Triangles) -> Recognised | None:
    """Return the box, cylinder, cone, ball, capsule or rounded hull that a body with its corners on its hull stands
    for; None: it is none of these.
    """
    box = box_of_corners(hull.vertices)
    if box is not None:
        return Recognised(box, 0.0)
    allowed = SINGLE_PRECISION * hull.size
    return _turned(hull, allowed) or _ball(hull, allowed) or _capsule(hull, allowed) or _rounded(hull, allowed)


def _turned(hull: Triangles, allowed: float) -> Recognised | None:
    """A cylinder or cone: two flat ends, or one and a tip, that are round."""
    # a flat end: the plane with the most triangles, and the axis across it
    _, planes, counts = np.unique(hull.normals.round(4), axis=0, return_inverse=True, return_counts=True)
    of_cap = np.flatnonzero(planes.ravel() == counts.argmax())  # no other plane has as many triangles
    normal = hull.normals[of_cap[np.linalg.norm(hull.areas[of_cap], axis=1).argmax()]]
    heights = hull.vertices @ normal
    cap = heights > heights.max() - 10.0 * allowed
    if cap.sum() < FEWEST_SIDES:
        return None
    flat = hull.vertices[cap] - hull.vertices[cap].mean(axis=0)
    axis = np.linalg.svd(flat)[2][2]
    if axis[int(np.abs(axis).argmax())] < 0.0:
        axis = -axis
    # circles through both ends, one of which may be a tip
    along = hull.vertices @ axis
    ends = [along < along.min() + allowed, along > along.max() - allowed]
    rims = []
    for end in ends:
        if end.sum() == 1:
            rims.append((hull.vertices[end][0], 0.0, 0.0))
            continue
        rim = circle_through(hull.vertices[end], axis)
        if rim is None or rim.n_sides < FEWEST_SIDES - 0.5 or rim.off > allowed:
            return None
        rims.append((rim.center, rim.radius, rim.sagitta))
    (low, low_radius, low_off), (high, high_radius, high_off) = rims
    if float(np.linalg.norm(np.cross(high - low, axis))) > 2.0 * allowed:
        return None
    pose, length = Pose((low + high) / 2.0, turn_from_z(axis)), float(axis @ (high - low))
    slope = (high_radius - low_radius) / length

    def depths(points: FloatArray) -> FloatArray:
        """How far points are within the shape."""
        above = (points - low) @ axis
        away = np.linalg.norm(points - low - np.outer(above, axis), axis=1)
        within_side = (low_radius + slope * above - away) / math.hypot(1.0, slope)
        found: FloatArray = np.minimum(within_side, np.minimum(above, length - above))
        return found

    if np.abs(depths(hull.vertices)).max() > 3.0 * allowed:
        return None
    error = max(low_off, high_off, float(depths(hull.face_points()).max()))
    if error > 2.0 * SAGITTA_OF_FEWEST * max(low_radius, high_radius):
        return None
    if abs(low_radius - high_radius) <= allowed:
        return Recognised(Cylinder((low_radius + high_radius) / 2.0, length, pose), error)
    return Recognised(Cone(low_radius, high_radius, length, pose), error)


def _ball(hull: Triangles, allowed: float) -> Recognised | None:
    points = hull.vertices
    if len(points) < 2 * FEWEST_SIDES:
        return None
    ball = ball_through(points)
    error = ball.radius - float(np.linalg.norm(hull.face_points() - ball.center, axis=1).min())
    if ball.off > allowed or error > SAGITTA_OF_FEWEST * ball.radius:
        return None
    return Recognised(Sphere(ball.radius, Pose(ball.center)), error)


def _capsule(hull: Triangles, allowed: float) -> Recognised | None:
    """Two ends and a radius by least squares of how far the corners are from the bar's surface (Gauss-Newton)."""
    points = hull.vertices
    if len(points) < 2 * FEWEST_SIDES:
        return None
    middle = points.mean(axis=0)
    axis = np.linalg.svd(points - middle, full_matrices=False)[2][0]
    along = (points - middle) @ axis
    radius = float(np.linalg.norm((points - middle) - np.outer(along, axis), axis=1).max())
    half = max(float(np.abs(along).max()) - radius, 0.1 * radius)
    ends = np.array([middle - half * axis, middle + half * axis])
    for _ in range(STEPS_OF_FIT):
        share, out, away = _from_bar(points, ends)
        rows = np.column_stack([-(1.0 - share)[:, None] * out, -share[:, None] * out, -np.ones(len(points))])
        step = np.linalg.lstsq(rows, radius - away, rcond=None)[0]
        ends, radius = ends + step[:6].reshape(2, 3), radius + float(step[6])
        if np.abs(step).max() <= 1e-15 * hull.size:
            break
    away = _from_bar(points, ends)[2]
    length = float(np.linalg.norm(ends[1] - ends[0]))
    error = radius - float(_from_bar(hull.face_points(), ends)[2].min())
    if not np.abs(away - radius).max() <= allowed or error > SAGITTA_OF_FEWEST * radius or length <= allowed:
        return None
    span = ends[1] - ends[0]
    if span[int(np.abs(span).argmax())] < 0.0:
        span = -span
    return Recognised(Capsule(radius, length, Pose(ends.mean(axis=0), turn_from_z(span))), error)


def _rounded(hull: Triangles, allowed: float) -> Recognised | None:
    found = rounded_hull(hull, allowed)
    if found is None or found.error > SAGITTA_OF_FEWEST * found.radius:
        return None
    return Recognised(Convex(found.core, found.radius), found.error)


def _from_bar(points: FloatArray, ends: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return where along a bar each point is nearest (0 to 1), the direction away from there, and how far."""
    span = ends[1] - ends[0]
    share = np.clip((points - ends[0]) @ span / max(float(span @ span), np.finfo(float).tiny), 0.0, 1.0)
    arms = points - ends[0] - np.outer(share, span)
    away = np.linalg.norm(arms, axis=1)
    return share, arms / np.maximum(away, np.finfo(float).tiny)[:, None], away
