"""Whether two convex bodies overlap, and how deep at most, from how far they reach along directions: no features."""

from __future__ import annotations

import numpy as np
from scipy.optimize import nnls

from cagepose import Pose
from cagepose.model.shapes import Rounded, Shape, Turned

FloatArray = np.ndarray


def support(shape: Shape, pose: Pose, way: FloatArray) -> FloatArray:
    """The place of a shape of a body at a pose that is farthest along a unit vector."""
    seen = pose.rotation.T @ way
    turn = shape.pose_body_shape.rotation
    own = turn.T @ seen
    if isinstance(shape, Turned):
        rho = np.hypot(own[0], own[1])
        out = own[:2] / rho if rho > 0.0 else np.array((1.0, 0.0))
        places = np.array([(*(radius * out), height) for height, radius in shape.rims])
        rounded = 0.0
    else:
        places, rounded = (shape.core(), shape.radius_m) if isinstance(shape, Rounded) else (_corners(shape), 0.0)
    place = places[np.argmax(places @ own)] + rounded * own
    return pose.transform(shape.pose_body_shape.transform(place))


def _corners(box: Shape) -> FloatArray:
    return box.pose_body_shape.inverse_transform(box.nodes_body())


def distance(one: Shape, pose: Pose, other: Shape, other_pose: Pose, tolerance_m: float) -> tuple[float, float]:
    """Bounds of the distance between two bodies: the least vector of their differences, among ever more of them."""
    way, places = np.array((1.0, 0.0, 0.0)), []
    lower, upper = 0.0, np.inf
    for _ in range(200):
        place = support(one, pose, -way) - support(other, other_pose, way)
        lower = max(lower, float(place @ way))
        places.append(place)
        if lower > upper - tolerance_m:
            break
        system = np.vstack([np.array(places).T, 1e3 * np.ones(len(places))])
        shares, _ = nnls(system, np.array((0.0, 0.0, 0.0, 1e3)))
        least = np.array(places).T @ (shares / shares.sum())
        upper = float(np.linalg.norm(least))
        if upper < tolerance_m:
            break
        way = least / upper
    return lower, upper


def least_extent(one: Shape, pose: Pose, other: Shape, other_pose: Pose, ways: FloatArray) -> float:
    """How far one has to go along some of these directions until it is out of the other."""
    return min(float((support(other, other_pose, way) - support(one, pose, -way)) @ way) for way in ways)
