"""The contacts at one pose as the mechanics needs them: one row for each face that a point touches, with its wrenches.

A point that touches several faces of one box lies on an edge: going in means that every one of them goes in (2.4), so
one face that holds or leaves is enough. Such faces form a group, of which one is chosen at a time. Faces of different
boxes hold each on its own.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.contacts import face_normal, is_hidden, touches_face
from cagepose.kernels.geometry import FloatArray, Geometry, Placement, box_gap
from cagepose.kernels.jit import kernel
from cagepose.kernels.metric import Frame, write_scaled_wrench
from cagepose.kernels.vector import Vector, cross, minus, norm, row

SAME_NORMAL = 1e-9
"""Radians. Flush faces of two boxes give one contact."""

CONTACTS_PER_POINT = 6
"""Faces that one point may touch, flush ones counted once. More: the run stalls, by name."""


class ContactSet(NamedTuple):
    """Rows 0 to used - 1 are in use.

    Attributes
    ----------
    used
        How many contacts there are, (1,).
    points, boxes, axes
        Indices of the cage point, the box and the axis of the face, (n,).
    sides
        +1 or -1: which of the two faces along the axis, (n,).
    gaps
        Distance from the plane of the face, below zero inside, (n,), metres.
    groups
        The first row of the same point and box, (n,).
    chosen
        Whether this face counts, (n,): all but the other faces on an edge.
    normals, arms
        Outward unit normal, and the point as seen from the centre of gravity, in the world, (n, 3).
    columns
        Scaled wrenches of a unit force along the normal and along two tangents, (n, 3, 6). The contact pushes along
        their negative.
    forces
        What the contact carries along them, (n, 3).
    """

    used: NDArray[np.int64]
    points: NDArray[np.int64]
    boxes: NDArray[np.int64]
    axes: NDArray[np.int64]
    sides: FloatArray
    gaps: FloatArray
    groups: NDArray[np.int64]
    chosen: NDArray[np.bool_]
    normals: FloatArray
    arms: FloatArray
    columns: FloatArray
    forces: FloatArray


def empty_contact_set(n_rows: int) -> ContactSet:
    """Return room for ``n_rows`` contacts (plain Python)."""
    return ContactSet(
        np.zeros(1, np.int64),
        np.zeros(n_rows, np.int64),
        np.zeros(n_rows, np.int64),
        np.zeros(n_rows, np.int64),
        np.zeros(n_rows),
        np.zeros(n_rows),
        np.zeros(n_rows, np.int64),
        np.zeros(n_rows, np.bool_),
        np.zeros((n_rows, 3)),
        np.zeros((n_rows, 3)),
        np.zeros((n_rows, 3, 6)),
        np.zeros((n_rows, 3)),
    )


@kernel
def face_is_listed(contacts: ContactSet, point: int, normal: Vector) -> bool:
    """Whether the last rows hold the same point with the same normal: the flush face of another box."""
    for i in range(contacts.used[0] - 1, -1, -1):
        if contacts.points[i] != point:
            return False
        if norm(minus(row(contacts.normals, i), normal)) <= SAME_NORMAL:
            return True
    return False


@kernel
def append_contact(
    contacts: ContactSet, placement: Placement, point: int, box: int, axis: int, side: float, arm: Vector, frame: Frame
) -> None:
    i = contacts.used[0]
    contacts.points[i], contacts.boxes[i], contacts.axes[i], contacts.sides[i] = point, box, axis, side
    normal = face_normal(placement, box, axis, side)
    for k in range(3):
        contacts.normals[i, k] = normal[k]
        contacts.arms[i, k] = arm[k]
    for j in range(3):
        direction = normal if j == 0 else face_normal(placement, box, (axis + j) % 3, 1.0)
        write_scaled_wrench(direction, cross(arm, direction), frame, contacts.columns[i, j])
    contacts.used[0] = i + 1


@kernel
def find_contacts(
    geometry: Geometry, placement: Placement, center: Vector, frame: Frame, touch_m: float, contacts: ContactSet
) -> bool:
    """Fill ``contacts`` at a pose; False: there are more than it has room for."""
    contacts.used[0] = 0
    for point in range(len(geometry.points_world)):
        if placement.depths[point] < -touch_m:
            continue
        arm = minus(row(geometry.points_world, point), center)
        for box in range(geometry.n_own_boxes):
            half_size = row(geometry.half_sizes, box)
            point_box = row(placement.points_box[box], point)
            if box_gap(point_box, half_size) > touch_m:
                continue
            first = contacts.used[0]
            for axis in range(3):
                if not touches_face(point_box, half_size, axis, touch_m):
                    continue
                side = math.copysign(1.0, point_box[axis])
                if face_is_listed(contacts, point, face_normal(placement, box, axis, side)) or is_hidden(
                    geometry, placement, box, point, axis, touch_m
                ):
                    continue
                i = contacts.used[0]
                if i == len(contacts.points):
                    return False
                contacts.gaps[i] = abs(point_box[axis]) - half_size[axis]
                contacts.groups[i] = first
                contacts.chosen[i] = i == first
                append_contact(contacts, placement, point, box, axis, side, arm, frame)
    return True


@kernel
def choose_next_faces(contacts: ContactSet) -> bool:
    """Choose the next combination of faces on edges; False: all have been, and the first is chosen again."""
    for first in range(contacts.used[0]):
        if contacts.groups[first] != first:
            continue
        last = first
        while last + 1 < contacts.used[0] and contacts.groups[last + 1] == first:
            last += 1
        for i in range(first, last):
            if contacts.chosen[i]:
                contacts.chosen[i] = False
                contacts.chosen[i + 1] = True
                return True
        contacts.chosen[last] = False
        contacts.chosen[first] = True
    return False
