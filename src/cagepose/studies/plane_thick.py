"""A scene whose parts are thick across its plane, so that what is deep in the plane is deep: `thickened`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar, cast

import numpy as np

from cagepose.errors import SceneError
from cagepose.model.cage import Cage
from cagepose.model.checks import FloatArray
from cagepose.model.parts import Object
from cagepose.model.planar import normal_axis
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.model.shapes import Shape
from cagepose.model.stretched import Stretch, stretched

Of = TypeVar("Of", bound=Shape)
MOST = 100.0
"""Times as thick, at most."""


def thickened(scene: Scene) -> Scene:
    """Return a scene that moves in a plane stretched across it, from the level of the object's pose: at the same poses
    the object is in the cage, and what both share is as thick as the object is wide, but for what is more than `MOST`
    times as thin. The same scene, where that needs no stretch, something in it would be no shape of ours, as a ball, or
    the cage has bodies.
    """
    assert scene.planar is not None
    held, cage = scene.object, scene.cage
    normal = np.eye(3)[normal_axis(scene.planar)]
    times = _times(scene, normal)
    if times <= 1.0 or cage.bodies:
        return scene
    level_m = float(held.pose_world_object.position_m @ normal)
    in_object = _in_body(held.pose_world_object, normal, level_m, times)
    in_cage = _in_body(cage.pose_world_cage, normal, level_m, times)
    try:
        parts, shapes = _all_stretched(held.parts, in_object), _all_stretched(cage.shapes, in_cage)
        holes, cage_holes = _all_stretched(held.holes, in_object), _all_stretched(cage.holes, in_cage)
        if parts is None or shapes is None or holes is None or cage_holes is None:
            return scene
        points, center = in_cage.moved(cage.points_cage), held.center_of_gravity_m
        thick = Object((), center, shapes=parts, holes=holes, pose=held.pose_world_object, mass_kg=held.mass_kg)
        around = Cage(points, cage.names, cage.pose_world_cage, shapes=shapes, holes=cage_holes)
        return scene.but_for(object=thick, cage=around)
    except SceneError:  # its touch tolerance is greater: points, or sides of a part, may be too near to each other
        return scene


def _times(scene: Scene, normal: FloatArray) -> float:
    """Return how many times the least thickness that two parts share goes into the width of the object."""
    held, cage = scene.object, scene.cage
    own = _levels(held.parts, held.pose_world_object, normal)
    others = _levels(cage.shapes, cage.pose_world_cage, normal)
    levels = cage.points_world() @ normal  # of these, how far within
    shared = np.minimum(own[:, None, 1], others[None, :, 1]) - np.maximum(own[:, None, 0], others[None, :, 0])
    within = np.minimum(own[:, None, 1] - levels, levels - own[:, None, 0])
    every = np.concatenate([shared, within], axis=1)
    least = every.min(initial=np.inf, where=every > scene.touch_m)
    corners = np.concatenate([part.limits_m() for part in held.parts])
    wide = float(np.linalg.norm(np.ptp(corners, axis=0)))
    return min(wide / float(least), MOST)


def _levels(shapes: Sequence[Shape], pose_world_body: Pose, normal: FloatArray) -> FloatArray:
    """Return the lowest and the highest level of each shape along a normal of the world, (n, 2), metres."""
    ways = np.array([-normal, normal]) @ pose_world_body.rotation
    heights = np.array([shape.heights_m(ways) for shape in shapes]).reshape(-1, 2)
    found: FloatArray = heights * (-1.0, 1.0) + pose_world_body.position_m @ normal
    return found


def _in_body(pose_world_body: Pose, normal: FloatArray, level_m: float, times: float) -> Stretch:
    """Return a stretch along a normal of the world, from a level there, as a body has it."""
    return Stretch(normal @ pose_world_body.rotation, level_m - float(pose_world_body.position_m @ normal), times)


def _all_stretched(shapes: Sequence[Of], by: Stretch) -> list[Of] | None:
    """Return shapes of a body that is stretched; None: one of them is no shape of ours then."""
    found = [stretched(shape, by) for shape in shapes]
    return None if None in found else cast("list[Of]", found)
