"""How deep two convex shapes are in each other by a convex program: min t over points x with f(x) <= t for what bounds
them, each f the signed distance from a plane, a cylinder or a cone. Below zero there is a point inside both.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.optimize import minimize

from cagepose import Box, Capsule, Cylinder, Pose, Sphere
from cagepose.model.shapes import Cone, Disc, Shape

STARTS = 12
Bound = Callable[[np.ndarray], float]


def bounds_of(shape: Shape) -> list[Bound]:
    """Functions of a point as seen from the shape's own frame."""

    def radius(x: np.ndarray) -> float:
        return float(np.hypot(x[0], x[1]))

    def slab(axis: int, half: float) -> list[Bound]:
        return [lambda x: x[axis] - half, lambda x: -x[axis] - half]

    match shape:
        case Box():
            return [bound for axis in range(3) for bound in slab(axis, shape.size_m[axis] / 2.0)]
        case Sphere():
            return [lambda x: float(np.linalg.norm(x)) - shape.radius_m]
        case Capsule():
            half = shape.length_m / 2.0
            return [lambda x: float(np.linalg.norm(x - (0.0, 0.0, np.clip(x[2], -half, half)))) - shape.radius_m]
        case Disc():
            return [lambda x: radius(x) - shape.radius_m, *slab(2, 0.0)]
        case Cylinder():
            return [lambda x: radius(x) - shape.radius_m, *slab(2, shape.length_m / 2.0)]
        case Cone():
            low, high, length = shape.radius_bottom_m, shape.radius_top_m, shape.length_m
            cosine = length / np.hypot(length, low - high)
            return [
                lambda x: (radius(x) - low - (high - low) * (x[2] / length + 0.5)) * cosine,
                *slab(2, length / 2.0),
            ]
    raise TypeError(shape)


def depth(one: Shape, pose: Pose, other: Shape) -> float:
    """How deep a part at a pose is in another one, metres, twice what the point midway is; below zero: so far apart."""
    frames = [(pose @ one.pose_body_shape, bounds_of(one)), (other.pose_body_shape, bounds_of(other))]

    def inside(x: np.ndarray) -> np.ndarray:
        return np.array([f((x - frame.position_m) @ frame.rotation) for frame, fs in frames for f in fs])

    rng, least = np.random.default_rng(0), np.inf
    for _ in range(STARTS):
        start = np.append(np.array(pose.position_m) + 0.3 * rng.normal(size=3), 1.0)
        limit = {"type": "ineq", "fun": lambda v: v[3] - inside(v[:3])}
        found = minimize(
            lambda v: v[3], start, constraints=[limit], method="SLSQP", options={"maxiter": 500, "ftol": 1e-15}
        )
        least = min(least, float(inside(found.x[:3]).max()))
    return -2.0 * least
