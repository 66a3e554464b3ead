"""Boxes within the object and points within the cage's shapes: where these are caged, so is the whole (7.16)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import count, product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.errors import SceneError
from cagepose.model.box import Box
from cagepose.model.cage import Cage
from cagepose.model.checks import FloatArray
from cagepose.model.geometry import scene_size
from cagepose.model.hull import hull_of
from cagepose.model.load import Load
from cagepose.model.parts import Object
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.model.shapes import Convex, Rounded, Shape, Turned
from cagepose.model.tolerances import TOUCH_GREATEST, Tolerances
from cagepose.model.volume import BOX_SIGNS
from cagepose.studies.tolerances import SAME_PLACE_IN_TOUCHES

SHARES_OF_FACE = (0.98, 0.9, 0.7)
"""Shares of a face's half edges. Points are taken over so much of it. The widest hold best, but may run off it."""
SIDES_OF_ROUND = 16
"""So many sides stand for what is turned about an axis, with an edge between two of them toward the face."""
SHARE_OF_LEANING = 0.1
"""Share of a way along the face. A point may be so much farther off for it, so that both ends of what leans are taken.
"""


class _Core(NamedTuple):
    """The part of a shape that is blown up: segments (n, 2, 3), flat faces (n_corners, 3) each, and the radius."""

    segments: FloatArray
    faces: list[FloatArray]
    radius_m: float


def inner_scene(scene: Scene) -> Scene | None:
    """Return the boxes of a scene's object in a cage of its points and of points on its shapes.

    A pose that is free in the scene is free there too, so a proof that the object is caged there, with its bounds,
    holds for the scene. None: the object has no box without holes, no solid shape of the cage is over a face of one, or
    these boxes and points make no scene, as they are too far apart.
    """
    pierced = {name for hole in scene.object.holes for name in hole.in_}
    boxes = [box for box in scene.object.boxes if box.name not in pierced]
    opened = {name for hole in scene.cage.holes for name in hole.in_}
    shapes = [shape for shape in scene.cage.shapes if shape.name not in opened]
    pose_cage_object = scene.cage.pose_world_cage.inverse() @ scene.object.pose_world_object
    points, names = scene.cage.points_cage, list(scene.cage.names)
    for shape in shapes:
        free_names = (name for n in count(1) if (name := f"{shape.name} {n}") not in scene.cage.names)
        for box in boxes:
            for point in points_over(box, pose_cage_object @ box.pose_object_box, shape, scene.touch_m):
                if (np.linalg.norm(points - point, axis=1) > SAME_PLACE_IN_TOUCHES * scene.touch_m).all():
                    points = np.vstack([points, point])
                    names.append(next(free_names))
    if not boxes or not names:
        return None
    held = Object(boxes, scene.object.center_of_gravity_m, pose=scene.object.pose_world_object)
    cage = Cage(points, names, scene.cage.pose_world_cage)
    touch = scene.touch_m / scene_size(held, cage)
    if touch > TOUCH_GREATEST:
        return None
    try:
        return Scene(held, cage, [Load("none", gravity=(0, 0, -1))], planar=scene.planar, tolerances=Tolerances(touch))
    except SceneError:
        return None


def points_over(box: Box, pose_cage_box: Pose, shape: Shape, touch_m: float) -> Iterator[FloatArray]:
    """Yield points (3,) of a shape of the cage that are near the faces of a box and over them, in the cage's frame."""
    half, rotation = box.size_m / 2.0, pose_cage_box.rotation
    for axis, sign in product(range(3), (-1.0, 1.0)):
        normal = sign * rotation[:, axis]
        lowest = -float(shape.heights_m(-normal[None])[0])
        if lowest < normal @ pose_cage_box.position_m + half[axis] - touch_m:
            continue
        core = _core_toward(shape, -normal)
        along = rotation[:, [k for k in range(3) if k != axis]]
        for share in SHARES_OF_FACE:
            reach = share * np.delete(half, axis)
            found = _within(core, pose_cage_box.position_m, normal, along, reach)
            if len(found) == 0:
                continue
            heights, ways = found @ normal, (found - pose_cage_box.position_m) @ along
            for toward in product((-1.0, 1.0), repeat=2):
                best = int(np.argmin(heights + SHARE_OF_LEANING * ways @ np.array(toward)))
                yield found[best] - core.radius_m * normal


def _core_toward(shape: Shape, direction: FloatArray) -> _Core:
    """Return the core of a shape; of what is turned, a prism or a pyramid within it with an edge toward a direction."""
    pose = shape.pose_body_shape
    if isinstance(shape, Turned):
        x, y, _ = (pose.rotation.T @ direction).tolist()
        angles = math.atan2(y, x) + 2.0 * math.pi * np.arange(SIDES_OF_ROUND) / SIDES_OF_ROUND
        around = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        rings = [pose.transform(np.insert(radius * around, 2, z, axis=1)) for z, radius in shape.rims]
        segments = [np.stack([ring, np.roll(ring, -1, axis=0)], axis=1) for ring in rings]
        if len(rings) == 2:
            segments.append(np.stack(rings, axis=1))
        faces = [ring for ring, (_, radius) in zip(rings, shape.rims, strict=True) if radius > 0.0]
        return _Core(np.concatenate(segments), faces, 0.0)
    if isinstance(shape, Rounded):
        hull, radius_m = shape.hull if isinstance(shape, Convex) else hull_of(shape.core()), shape.radius_m
    else:
        assert isinstance(shape, Box)
        hull, radius_m = hull_of(BOX_SIGNS * shape.size_m / 2.0), 0.0
    corners = pose.transform(hull.vertices_m)
    pairs = hull.edges if len(hull.edges) else np.zeros((1, 2), dtype=np.int64)
    return _Core(corners[pairs], [corners[list(loop)] for loop in hull.faces], radius_m)


def _within(core: _Core, middle: FloatArray, normal: FloatArray, along: FloatArray, reach: FloatArray) -> FloatArray:
    """Return points (n, 3) of a core over a rectangle: ends of its segments there, and what is over its corners."""
    starts, ways = core.segments[:, 0], core.segments[:, 1] - core.segments[:, 0]
    here, slopes = (starts - middle) @ along, ways @ along
    first, last = np.zeros(len(starts)), np.ones(len(starts))
    with np.errstate(divide="ignore", invalid="ignore"):
        for k in range(2):
            low, high = (-reach[k] - here[:, k]) / slopes[:, k], (reach[k] - here[:, k]) / slopes[:, k]
            is_along = slopes[:, k] == 0.0
            is_off = is_along & (np.abs(here[:, k]) > reach[k])
            first = np.maximum(first, np.where(is_along, np.where(is_off, np.inf, 0.0), np.minimum(low, high)))
            last = np.minimum(last, np.where(is_along, 1.0, np.maximum(low, high)))
    meets = first <= last
    shares = np.stack([first[meets], last[meets]], axis=1)
    found = [(starts[meets][:, None] + shares[..., None] * ways[meets][:, None]).reshape(-1, 3)]
    corners = middle + np.array(list(product((-1.0, 1.0), repeat=2))) * reach @ along.T
    for face in core.faces:
        found.append(_over_face(corners, normal, face))
    return np.concatenate(found)


def _over_face(points: FloatArray, normal: FloatArray, face: FloatArray) -> FloatArray:
    """Return where lines along a normal through some points meet a flat convex face."""
    ahead = np.roll(face, -1, axis=0) - face
    across = np.cross(face - face[0], ahead).sum(axis=0)
    across /= np.linalg.norm(across)
    slope = float(normal @ across)
    if abs(slope) < SHARE_OF_LEANING:
        return np.zeros((0, 3))
    found = points + ((face[0] - points) @ across / slope)[:, None] * normal
    turned = np.einsum("ijk,k->ij", np.cross(ahead, found[:, None] - face), across)
    is_on_it: NDArray[np.bool_] = (turned >= 0.0).all(axis=1) | (turned <= 0.0).all(axis=1)
    return np.asarray(found[is_on_it])
