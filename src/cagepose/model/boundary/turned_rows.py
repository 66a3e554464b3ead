"""The features of what is turned about an axis: circles, flat ends, tips and sides."""

from __future__ import annotations

import math

import numpy as np

from cagepose.kernels.boundary.features import CIRCLE, FACE, HALF_SPACE, INSIDE, LINE, VERTEX
from cagepose.model.boundary.blocks import NOWHERE, Row
from cagepose.model.pose import Pose


def circle_row(pose: Pose, height: float, radius: float, out: float, normals: tuple[float, float], number: int) -> Row:
    """Return a circle about the shape's z axis; its own axis leads up (``out`` 1) or down (-1)."""
    turn, center = pose.rotation, pose.transform(np.array((0.0, 0.0, height)))
    axis = out * turn[:, 2]
    reach = radius * np.sqrt(np.maximum(0.0, 1.0 - axis**2))
    box = np.stack([center - reach, center + reach])
    numbers = (radius, 0.0, 0.0, *normals, 0.0, 2.0 * math.pi)
    return Row(CIRCLE, number, center, axis, turn[:, 0], *numbers, [], radius, box)


def disc_row(pose: Pose, height: float, radius: float, out: float, number: int) -> Row:
    """Return a flat face inside of a circle about the shape's z axis."""
    circle = circle_row(pose, height, radius, out, (0.0, 0.0), number)
    bounds = [(INSIDE, NOWHERE, NOWHERE, radius)]
    return circle._replace(kind=FACE, length=0.0, width=0.0, bounds=bounds, least=radius)


def tip_row(pose: Pose, height: float, out: float, slant: float, wide: float, number: int) -> Row:
    """Return the tip of a cone, whose normals lead up (``out`` 1) or down (-1) at least as far as those of its side;
    what touches along the side is told as of the wide end, with this radius.
    """
    place = pose.transform(np.array((0.0, 0.0, height)))
    bounds = [(HALF_SPACE, -out * pose.rotation[:, 2], NOWHERE, -math.sin(slant * out))]
    numbers = (0.0,) * 7
    return Row(VERTEX, number, place, NOWHERE, NOWHERE, *numbers, bounds, wide, np.stack([place, place]))


def side_row(pose: Pose, low: tuple[float, float], high: tuple[float, float], number: int) -> Row:
    """Return the side between two heights with their radii, those of a hole below zero."""
    (start, radius), (end, other) = low, high
    angle = math.atan2(radius - other, end - start)
    sine, cosine = math.sin(angle), math.cos(angle)
    reach = np.array((max(abs(radius), abs(other)),) * 2 + (0.5 * (end - start),))
    middle, half = pose.transform(np.array((0.0, 0.0, 0.5 * (start + end)))), np.abs(pose.rotation) @ reach
    start, end = start - radius * sine / cosine, end - other * sine / cosine
    if abs(other) > abs(radius):  # from the wide end on, as the narrow one may be a tip
        start, end, radius, sine = end, start, other, -sine
    point, along = pose.transform(np.array((0.0, 0.0, start))), math.copysign(1.0, end - start) * pose.rotation[:, 2]
    numbers = (abs(end - start), radius / cosine, sine, 0.0, 0.0, 0.0, 0.0)
    least = min(abs(end - start), *(abs(wide) for wide in (low[1], high[1]) if wide != 0.0))
    box = np.stack([middle - half, middle + half])
    return Row(LINE, number, point, along, pose.rotation[:, 0], *numbers, [], least, box)
