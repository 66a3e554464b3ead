"""A rim that lies all around in the wall of a hole, as that of a countersunk head in its seat: a ball in it.

The rim is on the ball about the place on the axis that its normals lead through. As the object turns about that place
two of its points stay on the wall, equation (5.39): the rim moves as the ball does. Which two carry shows in gaps that
go by the square of the tilt, and so not within the touch tolerance; contacts anywhere else, taken alone, would hold the
object as a wedge, and tip it.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.vector import Vector, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.collision.geometry import Geometry, Placement
from cagepose.kernels.contact.contact_set import ContactSet, write_directions
from cagepose.kernels.contact.metric import Frame
from cagepose.kernels.contact.on_rim import is_of_same_rim
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.shapes.bend import NOTHING, Curvatures, across, write_bend
from cagepose.kernels.shapes.features import EDGE

ALL_AROUND = 1e-9
"""Of a full turn: so much less is one, too."""


@kernel
def seat_rims(geometry: Geometry, placement: Placement, contacts: ContactSet, frame: Frame) -> None:
    """Write the contacts of rims that lie all around in the wall of a hole as those of balls."""
    for i in range(contacts.used[0]):
        if not is_in_hole(geometry, placement, contacts, i) or is_listed_before(contacts, i):
            continue
        angle, middle = 0.0, (0.0, 0.0, 0.0)
        for other in range(i, contacts.used[0]):
            if is_of_same_rim(contacts, i, other):
                around = contacts.bends[other].on_rim
                angle += around.before + around.after
                middle = plus(middle, scaled(vector_from(around.ball), around.before + around.after))
        for other in range(i, contacts.used[0] if angle >= (1.0 - ALL_AROUND) * 2.0 * math.pi else i):
            if is_of_same_rim(contacts, i, other):
                write_as_ball(contacts, other, scaled(middle, 1.0 / angle), frame)


@kernel
def is_listed_before(contacts: ContactSet, i: int) -> bool:
    """Whether a contact before this one is of the same rim on the same wall."""
    found = False
    for before in range(i):
        found = found or is_of_same_rim(contacts, i, before)
    return found


@kernel
def is_in_hole(geometry: Geometry, placement: Placement, contacts: ContactSet, i: int) -> bool:
    """Whether a contact is of a rim on the wall of a hole."""
    row = contacts.rows[i]
    if row.feature < 0 or contacts.bends[i].on_rim.length == 0.0:
        return False
    is_held = contacts.bends[i].on_rim.is_of_cage
    walls, wall = (placement.body.world, row.feature) if is_held else (geometry.cage, row.cage_feature)
    return walls.features[wall].kind == EDGE and walls.features[wall].radius < 0.0


@kernel
def write_as_ball(contacts: ContactSet, i: int, middle: Vector, frame: Frame) -> None:
    """Write normal and bend of a contact of a rim as those of a ball about a place, as seen from the centre of gravity,
    that touches the wall all around.
    """
    row, rim, arm = contacts.rows[i], contacts.bends[i].on_rim, vector_from(contacts.rows[i].arm)
    away = minus(arm, middle)
    radius = math.copysign(norm(away), dot(away, vector_from(row.directions[0])))
    normal = scaled(away, 1.0 / radius)
    write_directions(row, normal, arm, norm(vector_from(row.directions[1])), frame)
    for k in range(3):
        rim.ball[k] = middle[k]
    found = Curvatures(NOTHING, NOTHING, across(normal, radius))
    if rim.is_of_cage:
        found = Curvatures(NOTHING, across(normal, 1.0), across(normal, row.gap - radius))
    write_bend(found, normal, arm, frame.axes, frame.radii, contacts.bends[i])
