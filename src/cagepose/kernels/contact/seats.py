"""A rim that lies all around in the slanted wall of a hole, as that of a countersunk head in its seat: a ball in it.

The rim is on the ball about the place on the axis that its normals lead through. As the object turns about that place
two of its points stay on the wall, equation (5.39): the rim moves as the ball does. Which two carry shows in gaps that
go by the square of the tilt, and so not within the touch tolerance; contacts anywhere else, taken alone, would hold the
object as a wedge, and tip it. So the rim counts as the ball where all of its vertices touch. Where fewer do, arcs are
nearest, and vertices between those that are not do not count.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.vector import Vector, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.collision.geometry import Geometry, Placement
from cagepose.kernels.contact.contact_set import ContactSet, choose, write_directions
from cagepose.kernels.contact.metric import Frame
from cagepose.kernels.contact.on_rim import is_of_same_rim
from cagepose.kernels.contact.tolerances import SAME_CIRCLE
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.shapes.bend import NOTHING, Curvatures, across, write_bend
from cagepose.kernels.shapes.features import EDGE, RIM
from cagepose.kernels.shapes.rims import ARCS, is_rim_on_side


@kernel
def seat_rims(geometry: Geometry, placement: Placement, contacts: ContactSet, frame: Frame) -> None:
    """Write the contacts of rims that lie all around in the slanted wall of a hole as those of balls."""
    for i in range(contacts.used[0]):
        if not is_in_seat(geometry, placement, contacts, i) or is_listed_before(contacts, i):
            continue
        n_vertices, middle = 0, (0.0, 0.0, 0.0)
        for other in range(i, contacts.used[0]):
            if is_of_same_rim(contacts, i, other):
                n_vertices += 1
                middle = plus(middle, vector_from(contacts.bends[other].on_rim.ball))
        if n_vertices < ARCS:
            leave_out_vertices(geometry, placement, contacts, i)
            continue
        middle = scaled(middle, 1.0 / n_vertices)
        for other in range(contacts.used[0] - 1, i - 1, -1):  # this one last: it tells what is of the same rim
            if is_of_same_rim(contacts, i, other):
                write_as_ball(contacts, other, middle, frame)


@kernel
def leave_out_vertices(geometry: Geometry, placement: Placement, contacts: ContactSet, i: int) -> None:
    """Let vertices of a rim not count that touch where an arc between them is nearer to the same wall."""
    rim = contacts.bends[i].on_rim
    arcs, walls = (geometry.cage, placement.body.world) if rim.is_of_cage else (placement.body.world, geometry.cage)
    center, is_off = vector_from(arcs.features[rim.arc_before].point), False
    taper = walls.features[wall_of(contacts, i)].taper
    for other in range(contacts.used[0]):
        row = contacts.rows[other]
        if row.feature < 0 or row.point != contacts.rows[i].point or row.box != contacts.rows[i].box:
            continue
        arc, wall = (row.cage_feature, row.feature) if rim.is_of_cage else (row.feature, row.cage_feature)
        is_same = walls.features[wall].kind == EDGE and walls.features[wall].taper == taper
        away = norm(minus(vector_from(arcs.features[arc].point), center))
        is_off = is_off or (is_same and arcs.features[arc].kind == RIM and away <= SAME_CIRCLE * abs(rim.length))
    for other in range(contacts.used[0] if is_off else 0):
        around = contacts.bends[other].on_rim
        if is_of_same_rim(contacts, i, other) and max(around.before, around.after) == 0.0:
            contacts.rows[other].group = -1
            choose(contacts, other, False)


@kernel
def is_listed_before(contacts: ContactSet, i: int) -> bool:
    """Whether a contact before this one is of the same rim on the same wall."""
    found = False
    for before in range(i):
        found = found or is_of_same_rim(contacts, i, before)
    return found


@kernel
def wall_of(contacts: ContactSet, i: int) -> int:
    """Return the feature that the rim of a contact lies on."""
    is_of_cage = contacts.bends[i].on_rim.is_of_cage
    return contacts.rows[i].feature if is_of_cage else contacts.rows[i].cage_feature


@kernel
def is_in_seat(geometry: Geometry, placement: Placement, contacts: ContactSet, i: int) -> bool:
    """Whether a contact is of a vertex of a rim on the slanted wall of a hole."""
    row = contacts.rows[i]
    if row.feature < 0 or contacts.bends[i].on_rim.length == 0.0:
        return False
    held, cage = placement.body.world.features[row.feature], geometry.cage.features[row.cage_feature]
    wall = held if contacts.bends[i].on_rim.is_of_cage else cage
    return is_rim_on_side(held, cage) and wall.radius < 0.0 and wall.taper != 0.0


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
