"""Scenes turned, scaled, mirrored, with their points renumbered, and far away."""

from __future__ import annotations

import numpy as np

from cagepose import Box, Cage, Force, Load, Object, Pose, Scene

KINDS = ["turned", "small", "large", "mirrored", "renumbered", "far"]


def mirrored(pose, flip, scale):
    """A mirror M takes the rotation R to M R M: seen in mirrored boxes, it is a rotation again."""
    w, *vector = pose.quaternion_wxyz
    return Pose(flip * pose.position_m * scale, (w, *(flip * np.prod(flip) * vector)))


def mapped(scene, *, frame, scale, flip, order):
    """The same scene in another frame, at another scale, mirrored (``flip``), or with points renumbered."""
    held = scene.object
    boxes = [Box(box.size_m * scale, mirrored(box.pose_object_box, flip, scale), box.name) for box in held.boxes]
    points = scene.cage.points_world() * flip * scale
    loads = []
    for load in scene.loads:
        gravity = None if load.gravity_world is None else frame.rotation @ (flip * load.gravity_world)
        force = load.force and Force(
            frame.rotation @ (flip * load.force.direction), flip * load.force.at_object_m * scale
        )
        loads.append(Load(load.name, gravity=gravity, force=force))
    return Scene(
        Object(
            boxes,
            flip * held.center_of_gravity_m * scale,
            pose=frame @ mirrored(held.pose_world_object, flip, scale),
        ),
        Cage(points[order], [scene.cage.names[index] for index in order], frame),
        loads,
        friction_coefficient=scene.friction_coefficient,
        metric=scene.metric,
    )
