"""A scene as engines with spheres and time steps take it: millimetres, unit mass, origin at the centre of gravity.

These engines know no points. A sphere of radius r stands for each, and every box face that a point can reach is moved
inwards by r, so that sphere and face meet exactly where point and face did, whatever the tilt.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.rail_case import FloatArray
from cagepose import Scene

MM = 1e3
SPHERE_RADIUS_MM = 0.2
REACH_MM = 2.0
"""A face is in use if a point starts at most this far above it: twice the play of the rail."""


@dataclass(frozen=True)
class PeerLoad:
    """A dead load of one phase.

    Attributes
    ----------
    direction
        Unit vector in the world, (3,).
    arm_mm
        From the centre of gravity to where it acts, in the object's axes, (3,).
    """

    direction: FloatArray
    arm_mm: FloatArray


@dataclass(frozen=True)
class PeerBody:
    """The object (mass 1, frame at its centre of gravity), its spheres and loads.

    Attributes
    ----------
    half_sizes_mm, centers_mm, box_rotations
        Boxes with the faces in use moved inwards, (n_boxes, 3), (n_boxes, 3) and (n_boxes, 3, 3).
    spheres_mm, faces_in_use
        Centres in the world, (n_points, 3); and (point, box, axis of the box, 1 or -1) of each face that a point starts
        over.
    gyration_mm2
        Inertia for each unit of mass in the object's axes, (3, 3): as in the scene, else uniform density.
    start_mm, start_rotation
        Where the centre of gravity starts, (3,), and how the object is turned, (3, 3).
    corners_mm
        Of the boxes, (n, 3), in the object's axes from the centre of gravity.
    loads
        One for each phase.
    """

    half_sizes_mm: FloatArray
    centers_mm: FloatArray
    box_rotations: FloatArray
    spheres_mm: FloatArray
    faces_in_use: tuple[tuple[int, int, int, int], ...]
    gyration_mm2: FloatArray
    start_mm: FloatArray
    start_rotation: FloatArray
    corners_mm: FloatArray
    loads: tuple[PeerLoad, ...]

    @property
    def pairs(self) -> list[tuple[int, int]]:
        """(point, box) of all faces in use, each once."""
        return sorted({(point, box) for point, box, _, _ in self.faces_in_use})


def peer_body(scene: Scene, radius_mm: float = SPHERE_RADIUS_MM) -> PeerBody:
    """Return the scene with spheres for points."""
    held, pose = scene.object, scene.object.pose_world_object
    cog_mm = held.center_of_gravity_m * MM
    points_mm = scene.cage.points_world() * MM
    in_object_mm = (points_mm - pose.position_m * MM) @ pose.rotation
    half_sizes, centers, rotations = [], [], []
    in_use = list[tuple[int, int, int, int]]()
    for index, box in enumerate(held.boxes):
        rotation, half = box.pose_object_box.rotation, box.size_m * MM / 2.0
        low, high, faces = _shrunken(half, (in_object_mm - box.pose_object_box.position_m * MM) @ rotation, radius_mm)
        half_sizes.append((high - low) / 2.0)
        centers.append(box.pose_object_box.position_m * MM + rotation @ ((high + low) / 2.0) - cog_mm)
        rotations.append(rotation)
        in_use.extend((point, index, axis, sign) for point, axis, sign in faces)
    corners = np.concatenate([box.corners_object() for box in held.boxes]) * MM - cog_mm
    loads = []
    for load in scene.loads:
        if load.force is not None:
            loads.append(PeerLoad(load.force.direction, load.force.at_object(pose) * MM - cog_mm))
        else:
            assert load.gravity_world is not None
            loads.append(PeerLoad(load.gravity_world / np.linalg.norm(load.gravity_world), np.zeros(3)))
    return PeerBody(
        np.array(half_sizes),
        np.array(centers),
        np.array(rotations),
        points_mm,
        tuple(in_use),
        held.gyration_m2 * MM**2,
        pose.transform(held.center_of_gravity_m) * MM,
        pose.rotation,
        corners,
        tuple(loads),
    )


def _shrunken(
    half: FloatArray, points_box: FloatArray, radius: float
) -> tuple[FloatArray, FloatArray, list[tuple[int, int, int]]]:
    """Return (low corner, high corner) of a box whose faces in use are moved inwards, and (point, axis, sign)."""
    low, high = -half, half.copy()
    faces = list[tuple[int, int, int]]()
    for axis in range(3):
        others = [k for k in range(3) if k != axis]
        over_face = (np.abs(points_box[:, others]) <= half[others]).all(axis=1)
        for sign in (-1, 1):
            gaps = sign * points_box[:, axis] - half[axis]
            reached = np.nonzero(over_face & (gaps >= 0.0) & (gaps <= REACH_MM))[0].tolist()
            faces.extend((point, axis, sign) for point in reached)
            if reached:
                (high if sign > 0 else low)[axis] -= sign * radius
    return low, high, faces
