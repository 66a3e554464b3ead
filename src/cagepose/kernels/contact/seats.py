"""A circle that lies all around in the slanted wall of a hole, as that of a countersunk head in its seat: a ball in it.
So does the tube around one on that around another, as a rounded rim on a rounded mouth.

The circle is on the ball about the place on the axis that its normals lead through. As the object turns about that
place two of its points stay on the wall, equation (5.39): the circle moves as the ball does. Which two carry shows in
gaps that go by the square of the tilt, and so not within the touch tolerance; contacts anywhere else, taken alone,
would hold the object as a wedge, and tip it.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.vector import Vector, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.boundary.bend import NOTHING, Curvatures, across, write_bend
from cagepose.kernels.boundary.features import CIRCLE, LINE
from cagepose.kernels.boundary.geometry import Geometry
from cagepose.kernels.contact.contact_set import ContactSet, write_directions
from cagepose.kernels.contact.metric import Frame
from cagepose.kernels.contact.on_circle import is_of_same_circle
from cagepose.kernels.native.kernel import kernel


@kernel
def seat_circles(geometry: Geometry, contacts: ContactSet, frame: Frame) -> None:
    """Write the contacts of circles that lie all around in the slanted wall of a hole as those of balls."""
    for i in range(contacts.used[0]):
        if not is_in_seat(geometry, contacts, i) or is_listed_before(contacts, i):
            continue
        n_places, middle = 0, (0.0, 0.0, 0.0)
        for other in range(i, contacts.used[0]):
            if is_of_same_circle(contacts, i, other):
                n_places += 1
                middle = plus(middle, vector_from(contacts.bends[other].on_circle.ball))
        middle = scaled(middle, 1.0 / n_places)
        for other in range(contacts.used[0] - 1, i - 1, -1):  # this one last: it tells what is of the same circle
            if is_of_same_circle(contacts, i, other):
                write_as_ball(contacts, other, middle, frame)


@kernel
def is_listed_before(contacts: ContactSet, i: int) -> bool:
    """Whether a contact before this one is of the same circle on the same wall."""
    found = False
    for before in range(i):
        found = found or is_of_same_circle(contacts, i, before)
    return found


@kernel
def is_in_seat(geometry: Geometry, contacts: ContactSet, i: int) -> bool:
    """Whether a contact is of a circle that lies all around on the slanted wall of a hole, or on a tube."""
    row = contacts.rows[i]
    if contacts.bends[i].on_circle.length == 0.0:
        return False
    held, cage = geometry.held.features[row.feature], geometry.cage.own.features[row.cage_feature]
    if held.kind == CIRCLE and cage.kind == CIRCLE:
        return bool(contacts.bends[i].on_circle.is_on_ball)
    circle, wall = (cage, held) if contacts.bends[i].on_circle.is_of_cage else (held, cage)
    return bool(circle.kind == CIRCLE and wall.kind == LINE and wall.radius < 0.0 and wall.taper != 0.0)


@kernel
def write_as_ball(contacts: ContactSet, i: int, middle: Vector, frame: Frame) -> None:
    """Write normal and bend of a contact of a circle as those of a ball about a place, as seen from the centre of
    gravity, that touches the wall all around.
    """
    row, around, arm = contacts.rows[i], contacts.bends[i].on_circle, vector_from(contacts.rows[i].arm)
    away = minus(arm, middle)
    radius = math.copysign(norm(away), dot(away, vector_from(row.directions[0])))
    normal = scaled(away, 1.0 / radius)
    write_directions(contacts, i, normal, arm, norm(vector_from(row.directions[1])), frame)
    for k in range(3):
        around.ball[k] = middle[k]
    found = Curvatures(NOTHING, NOTHING, across(normal, radius))
    if around.is_of_cage:
        found = Curvatures(NOTHING, across(normal, 1.0), across(normal, row.gap - radius))
    write_bend(found, normal, arm, frame.axes, frame.radii, contacts.bends[i])
