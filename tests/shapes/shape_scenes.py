"""Seeded random scenes of rounded parts: an object of one to three, three to eight parts and points around it."""

from __future__ import annotations

import numpy as np

from cagepose import Box, Cage, Force, Load, Object, Pose, Scene
from cagepose.model.shapes import Capsule, Convex, Sphere
from shapes.convex_bodies import Body, body_of, gap, placed_at, random_part, random_turn

MM = 1e-3
APART = (0.01 * MM, 0.1 * MM, 1.0 * MM, 3.0 * MM)


def changed(part, scale: float = 1.0, pose: Pose | None = None):
    """The same part in other lengths, and then at a pose in its body; a point, too."""
    pose = pose or Pose()
    if isinstance(part, np.ndarray):
        return pose.transform(part * scale)
    own = part.pose_object_box if isinstance(part, Box) else part.pose_body_shape
    pose = pose @ Pose(own.position_m * scale, own.quaternion_wxyz)
    if isinstance(part, Box):
        return Box(part.size_m * scale, pose)
    if isinstance(part, Sphere):
        return Sphere(part.radius_m * scale, pose)
    if isinstance(part, Capsule):
        return Capsule(part.radius_m * scale, part.length_m * scale, pose)
    return Convex(part.vertices_m * scale, part.radius_m * scale, pose)


def random_cage(rng: np.random.Generator, bodies: list[Body], n_parts: int) -> list:
    """Parts and points beside those of the object, three of them below."""
    found: list = []
    while len(found) < n_parts:
        towards = rng.normal(size=3)
        if len(found) < 3:
            towards[2] = -abs(towards[2])
        part = np.zeros(3) if rng.random() < 0.3 else changed(random_part(rng), 20.0 * MM)
        body = body_of(part)
        beside = bodies[rng.integers(len(bodies))]
        pose = placed_at(body, beside, random_turn(rng), towards, float(rng.choice(APART)))
        if all(gap(body.at(pose), other) > 1e-3 * MM for other in bodies):
            found.append(changed(part, pose=pose))
    return found


def scene_of(parts: list, around: list, loads: list[Load], friction: float, scale: float = 1.0) -> Scene:
    """The scene of these parts, in other lengths."""
    parts, around = ([changed(part, scale) for part in each] for each in (parts, around))
    middle = np.mean([body_of(part).corners.mean(axis=0) for part in parts], axis=0)
    held = Object(
        [part for part in parts if isinstance(part, Box)],
        middle,
        mass_kg=1.0,
        inertia_kg_m2=np.diag((1.0, 1.3, 1.7)) * 1e-5 * scale**2,
        shapes=[part for part in parts if not isinstance(part, Box)],
    )
    points = [part for part in around if isinstance(part, np.ndarray)]
    shapes = [part for part in around if not isinstance(part, np.ndarray)]
    return Scene(held, Cage(points, shapes=shapes), loads, friction_coefficient=friction)


def random_problem(rng: np.random.Generator) -> tuple[list, list, list[Load], float]:
    """The parts of an object and around it, in their frames, loads and a coefficient of friction."""
    parts = [
        changed(random_part(rng, Pose(rng.uniform(-0.4, 0.4, 3), random_turn(rng))), 20.0 * MM)
        for _ in range(rng.integers(1, 4))
    ]
    around = random_cage(rng, [body_of(part) for part in parts], int(rng.integers(3, 9)))
    if rng.random() < 0.7:
        load = Load("gravity", gravity=(0, 0, -1))
    else:
        load = Load("push", force=Force(rng.normal(size=3), rng.uniform(-10.0, 10.0, 3) * MM))
    return parts, around, [load], float(rng.choice([0.0, 0.3]))
