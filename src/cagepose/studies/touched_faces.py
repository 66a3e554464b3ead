"""What touches at a pose, `Touch`, and which faces of boxes the cage's points touch: `touched_faces`.

In plain NumPy, by (2.4) and (2.7); but for the choice of tangents nothing here is shared with the kernels.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from cagepose.kernels.contact.contact_set import tangents_to
from cagepose.kernels.contact.tolerances import SAME_NORMAL_RAD
from cagepose.model.checks import FloatArray, as_vector
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.drives import points_displaced

PROBE, PROBE_MARGIN = 3.0, 1.5
"""In touch tolerances, of (2.7): a face is hidden where a point that far outside of it, and that far from its edge,
lies so deep in another box."""


@dataclass(frozen=True, order=True)
class ContactFace:
    """One cage point on one face of one box, or one place where two shapes touch.

    Attributes
    ----------
    point, box
        Names of the cage's point or shape, and of the object's box or shape.
    side
        The face as seen from the box's middle: "+x", "-x", "+y", "-y", "+z" or "-z". Of shapes "1", "2", ...: which of
        the places where these two touch.
    """

    point: str
    box: str
    side: str

    def __str__(self) -> str:
        if self.side.isdecimal():
            return f"{self.point} at place {self.side} of {self.box}"
        return f"{self.point} on {self.side} of {self.box}"


class Touch(NamedTuple):
    """One contact, in the world.

    Attributes
    ----------
    face
        Its name.
    directions
        Outward normal of the object and two tangents, unit vectors (3, 3).
    place
        (3,), metres.
    group
        The same for contacts of which one counts at a time: of a point on an edge, or of sharp edges that meet.
    """

    face: ContactFace
    directions: FloatArray
    place: FloatArray
    group: object


def touched_faces(scene: Scene, pose: Pose, displaced: FloatArray) -> list[Touch]:
    """Return the contacts of the cage's points with the object's boxes, bodies being displaced as in `at_start`."""
    points, half_sizes = points_displaced(scene, displaced), scene.boxes.half_sizes
    rotations = pose.rotation @ scene.boxes.box_rotations
    middles = pose.transform(scene.boxes.box_positions)
    touch_m, touched = scene.touch_m, list[Touch]()
    for name, point in zip(scene.cage.names, points, strict=True):
        normals = list[FloatArray]()
        for box, held in enumerate(scene.object.boxes):
            place = (point - middles[box]) @ rotations[box]
            gaps = np.abs(place) - half_sizes[box]
            if gaps.max() > touch_m:
                continue
            found = [
                axis for axis in np.nonzero(np.abs(gaps) <= touch_m)[0].tolist()
                if not _is_hidden(box, axis, place, gaps, touch_m, half_sizes, rotations, middles)
            ]  # fmt: skip
            outward = [np.copysign(1.0, place[axis]) * rotations[box][:, axis] for axis in found]
            if all(any(np.linalg.norm(one - other) <= SAME_NORMAL_RAD for other in normals) for one in outward):
                continue  # flush faces of another box say nothing new
            for axis, normal in zip(found, outward, strict=True):
                side = ("+" if place[axis] > 0.0 else "-") + "xyz"[axis]
                tangents = tangents_to(as_vector(normal))
                face = ContactFace(name, str(held.name), side)
                touched.append(Touch(face, np.array([normal, *tangents]), point, (name, held.name)))
            normals += outward
    return touched


def _is_hidden(
    box: int, axis: int, place: FloatArray, gaps: FloatArray, touch_m: float,
    half_sizes: FloatArray, rotations: FloatArray, middles: FloatArray,
) -> bool:  # fmt: skip
    """Whether another box covers the face at a point near its edge (2.7)."""
    is_near_edge = gaps > -touch_m
    is_near_edge[axis] = False
    if not is_near_edge.any():
        return False
    probe = np.where(is_near_edge, np.copysign(half_sizes[box] - PROBE * touch_m, place), place)
    probe[axis] = np.copysign(half_sizes[box][axis] + PROBE * touch_m, place[axis])
    seen = rotations[box] @ probe + middles[box]
    depths = half_sizes - np.abs(np.einsum("bij,bi->bj", rotations, seen - middles))
    depths[box] = -np.inf
    return bool((depths.min(axis=1) > PROBE_MARGIN * touch_m).any())
