"""Whether two convex bodies overlap, and how deep at most, from how far they reach along directions: no features."""

from __future__ import annotations

import numpy as np
from scipy.optimize import nnls

from cagepose import Box, Pose
from cagepose.model.shapes import Capsule, Cone, Convex, Cylinder, Rounded, Shape, Sphere, Turned

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


def drawn_convex(rng: np.random.Generator, widest_m: float = 1.5) -> Shape:
    """A box, hull, rounded hull, cylinder, cone, ball or capsule, as wide as this at most or somewhat wider."""
    kind, wide, long = int(rng.integers(7)), widest_m * rng.uniform(0.2, 1.0), rng.uniform(0.2, 3.0)
    pose = Pose(0.2 * widest_m * rng.uniform(-1.0, 1.0, 3), rng.standard_normal(4) if widest_m > 1.0 else None)
    if kind == 0:
        return Box(wide * rng.uniform(0.1, 1.3, 3), pose)
    if kind == 1:
        return Convex(0.5 * wide * rng.standard_normal((int(rng.integers(4, 20)), 3)), 0.0, pose)
    if kind == 2:
        points = 0.4 * wide * rng.standard_normal((int(rng.integers(1, 9)), 3))
        return Convex(points, wide * rng.uniform(0.05, 0.5), pose)
    if kind == 3:
        return Cylinder(wide, long, pose)
    if kind == 4:
        return Cone(wide, wide * rng.choice([0.0, 0.5, 1.2]), long, pose)
    return Sphere(wide, pose) if kind == 5 else Capsule(0.5 * wide, long, pose)


def samples(shape: Shape, n: int, rng: np.random.Generator) -> FloatArray:
    """Places of a convex shape in the frame of its body, (n, 3), most of them on its surface and its edges."""
    if isinstance(shape, Turned):
        (low, wide), (high, narrow) = shape.rims[0], shape.rims[-1]
        share, angles = np.clip(rng.uniform(-0.5, 1.5, n), 0.0, 1.0), rng.uniform(0.0, 2.0 * np.pi, n)
        out = (wide + share * (narrow - wide)) * np.clip(rng.uniform(0.0, 3.0, n), 0.0, 1.0)
        places = np.stack([out * np.cos(angles), out * np.sin(angles), low + share * (high - low)], axis=1)
        return shape.pose_body_shape.transform(places)
    core, rounded = (shape.core(), shape.radius_m) if isinstance(shape, Rounded) else (_corners(shape), 0.0)
    shares = rng.dirichlet((0.3, 0.3, 0.3), n)
    shares[: n // 5] = (1.0, 0.0, 0.0)
    shares[n // 5 : 3 * n // 5, 2] = 0.0
    shares /= shares.sum(axis=1)[:, None]
    ways = rng.standard_normal((n, 3))
    ways *= rounded / np.linalg.norm(ways, axis=1)[:, None]
    places = np.einsum("ij,ijk->ik", shares, core[rng.integers(len(core), size=(n, 3))]) + ways
    return shape.pose_body_shape.transform(places)
