"""Where points touch, how deep they are and what the loads are worth: written anew from docs/theory, in numpy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from math import prod

import numpy as np

from audit.case import FloatArray
from cagepose import Contact, Load, Pose, Scene

PROBE = 3.0
PROBE_MARGIN = 1.5
"""The margin of (2.7), in touch tolerances."""
SAME_PLACE, SAME_NORMAL = 4.0, 1e-9
"""Contacts whose places are so near, in touch tolerances, and whose normals differ by less are one."""
WEIGHT_BESIDE_FORCE = 1e-6
"""Where mass or magnitude is missing: docs/theory/mechanics, how loads are weighed."""


@dataclass(frozen=True)
class Touch:
    """One cage point on one face: outward normal and place in the world, and the gap, metres."""

    point: int
    box: int
    axis: int
    normal: FloatArray
    place: FloatArray
    gap: float


@dataclass(frozen=True)
class Acting:
    """A force of a load, fixed in the world, at a point of the object."""

    force: FloatArray
    at_object: FloatArray


def half_sizes(scene: Scene) -> FloatArray:
    return np.array([box.size_m / 2.0 for box in scene.object.boxes])


def points_in_boxes(scene: Scene, pose: Pose) -> FloatArray:
    """The cage points in the frame of each box, (boxes, points, 3)."""
    in_object = pose.inverse_transform(scene.cage.points_world())
    return np.array([box.pose_object_box.inverse_transform(in_object) for box in scene.object.boxes])


def gaps(scene: Scene, pose: Pose) -> FloatArray:
    """The gap (2.4) of each point to the union of the boxes, (points,), metres; below zero: how deep it is."""
    each = (np.abs(points_in_boxes(scene, pose)) - half_sizes(scene)[:, None, :]).max(axis=2)
    nearest: FloatArray = each.min(axis=0)
    return nearest


def deepest(scene: Scene, pose: Pose) -> float:
    """How deep a point is inside the part at most, in sizes of the scene; below zero: none is."""
    return -float(gaps(scene, pose).min()) / scene.size_m


def touches(scene: Scene, pose: Pose, touch_m: float | None = None) -> list[Touch]:
    """Every point on every face, within the touch tolerance of face and box; covered faces are left out (2.7)."""
    tau = scene.touch_m if touch_m is None else touch_m
    halves, places = half_sizes(scene), points_in_boxes(scene, pose)
    world = scene.cage.points_world()
    found = []
    for box, (half, in_box) in enumerate(zip(halves, places, strict=True)):
        beyond = np.abs(in_box) - half
        rotation = pose.rotation @ scene.object.boxes[box].pose_object_box.rotation
        for point, axis in np.argwhere((beyond.max(axis=1) <= tau)[:, None] & (np.abs(beyond) <= tau)).tolist():
            if _is_covered(scene, box, in_box[point], axis, tau):
                continue
            normal = np.copysign(1.0, in_box[point, axis]) * rotation[:, axis]
            found.append(Touch(point, box, axis, normal, world[point], float(beyond[point, axis])))
    return found


def _is_covered(scene: Scene, box: int, in_box: FloatArray, axis: int, tau: float) -> bool:
    half = scene.object.boxes[box].size_m / 2.0
    probe = in_box.copy()
    others = np.arange(3) != axis
    on_edge = others & (np.abs(in_box) > half - tau)
    if not on_edge.any():
        return False
    probe[on_edge] = np.copysign(half - PROBE * tau, in_box)[on_edge]
    probe[axis] = np.copysign(half[axis] + PROBE * tau, in_box[axis])
    in_object = scene.object.boxes[box].pose_object_box.transform(probe)
    return any(
        (np.abs(other.pose_object_box.inverse_transform(in_object)) - other.size_m / 2.0).max() < -PROBE_MARGIN * tau
        for k, other in enumerate(scene.object.boxes)
        if k != box
    )


def are_one(one: Touch, other: Touch, touch_m: float) -> bool:
    """Whether two contacts are one: at one place, and with one normal."""
    apart_m = float(np.linalg.norm(one.place - other.place))
    return apart_m <= SAME_PLACE * touch_m and float(np.linalg.norm(one.normal - other.normal)) <= SAME_NORMAL


def touches_are_clear(scene: Scene, pose: Pose) -> bool:
    """Whether a slightly other touch tolerance finds the same contacts, so that rounding decides nothing."""
    found = [{(t.point, t.box, t.axis) for t in touches(scene, pose, k * scene.touch_m)} for k in (0.98, 1.0, 1.02)]
    return found[0] == found[1] == found[2]


def choices(found: Sequence[Touch], most: int, rng: np.random.Generator) -> tuple[list[list[Touch]], bool]:
    """Return the choices of one face for each point and box, and whether these are all: ``most`` at most, else drawn.

    Faces of one box that a point touches on its edge count one at a time.
    """
    groups: dict[tuple[int, int], list[Touch]] = {}
    for touch in found:
        groups.setdefault((touch.point, touch.box), []).append(touch)
    sides = list(groups.values())
    if prod(map(len, sides)) <= most:
        return [list(chosen) for chosen in product(*sides)], True
    return [[side[rng.integers(len(side))] for side in sides] for _ in range(most)], False


def friction_of(scene: Scene, contact: Touch | Contact) -> float:
    """The coefficient of a contact: that of its point, else that of its box, else that of the scene."""
    if isinstance(contact, Touch):
        point, box = scene.cage.names[contact.point], str(scene.object.boxes[contact.box].name)
    else:
        point, box = contact.point, contact.box
    of_scene = scene.friction_coefficient or 0.0
    return scene.friction_of.get(point, scene.friction_of.get(box, of_scene))


def acting(scene: Scene, load: Load) -> list[Acting]:
    """The dead forces of a load: in newtons if masses and magnitudes say all, else relative to each other."""
    center, mass, down = scene.object.center_of_gravity_m, scene.object.mass_kg, load.gravity_world
    magnitudes = [push.magnitude_n for push in load.pushes]
    pushes = [
        Acting(push.direction * (1.0 if magnitude is None else magnitude), push.at_object_m)
        for push, magnitude in zip(load.pushes, magnitudes, strict=True)
        if push.at_object_m is not None and not push.follows
    ]
    if down is None:
        return pushes
    if mass is not None and None not in magnitudes:
        return [*pushes, Acting(mass * down, center)]
    beside = WEIGHT_BESIDE_FORCE * np.linalg.norm(pushes[0].force) if pushes else 1.0
    return [*pushes, Acting(beside * down / np.linalg.norm(down), center)]


def acting_at(
    scene: Scene, load: Load, pose: Pose, driven: Mapping[str, Pose] | None = None
) -> tuple[list[Acting], FloatArray]:
    """All forces of a load at a pose, those that follow the object or stay in the world and those of springs too, and
    its moments, (3,).

    Bodies that were ``driven`` are where this says, in the cage's frame, all others where they start.
    """
    acts, couple = acting(scene, load), np.zeros(3)
    for push in load.pushes:
        if push.follows or push.at_world_m is not None:
            magnitude = 1.0 if push.magnitude_n is None else push.magnitude_n
            direction = pose.rotation @ push.direction if push.follows else push.direction
            acts.append(Acting(magnitude * direction, push.at_object(pose)))
    for spring in load.springs:
        start = scene.object.pose_world_object.transform(spring.at_object_m)
        end = scene.cage.spring_end_world(spring)
        at_start = float(np.linalg.norm(end - start))
        if driven and spring.of is not None and spring.of in driven:
            end = scene.cage.pose_world_cage.transform(driven[spring.of].transform(spring.to_m))
        way = end - pose.transform(spring.at_object_m)
        length = float(np.linalg.norm(way))
        longer = length - at_start
        tension = spring.preload_n + spring.stiffness_n_per_m * longer
        acts.append(Acting(tension / length * way, spring.at_object_m))
    for moment in load.moments:
        turned = pose.rotation @ moment.direction if moment.follows else moment.direction
        couple = couple + moment.magnitude_nm * turned
    return acts, couple


def load_of(scene: Scene, name: str) -> Load:
    return next(load for load in scene.loads if load.name == name)


def load_size(acts: Sequence[Acting]) -> float:
    """The sum of the forces' magnitudes."""
    return float(sum(np.linalg.norm(act.force) for act in acts))


def potential(acts: Sequence[Acting], pose: Pose) -> float:
    """V of (5.2), joules or unit load times metres."""
    return -float(sum(act.force @ pose.transform(act.at_object) for act in acts))


def corners(scene: Scene, pose: Pose) -> FloatArray:
    """The corners of all boxes in the world, (8 n, 3), metres."""
    return pose.transform(np.vstack([box.corners_object() for box in scene.object.boxes]))


def farthest_move(scene: Scene, one: Pose, other: Pose) -> float:
    """The greatest way of a corner between two poses, in sizes of the scene."""
    return float(np.linalg.norm(corners(scene, one) - corners(scene, other), axis=1).max() / scene.size_m)


def tangents(normal: FloatArray) -> FloatArray:
    """Two unit vectors across a normal, (2, 3)."""
    first = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    first /= np.linalg.norm(first)
    return np.array([first, np.cross(normal, first)])
