"""The contacts at one pose: where two boundaries meet, with what the mechanics asks of each place."""

from __future__ import annotations

from cagepose.kernels.algebra.least_squares import length
from cagepose.kernels.algebra.vector import Vector, minus, vector_from
from cagepose.kernels.boundary.bend import curvatures, write_bend, write_twin
from cagepose.kernels.boundary.features import PlacedBoundary, number_of_bodies
from cagepose.kernels.boundary.geometry import Geometry, Placement, cage_at, held_at, meetings_with
from cagepose.kernels.boundary.met import Meeting
from cagepose.kernels.boundary.on_circle import write_on_circle
from cagepose.kernels.boundary.touching import Meetings, Touching, is_around
from cagepose.kernels.contact.contact_set import ContactSet, choose, write_directions
from cagepose.kernels.contact.friction import Friction, friction_share
from cagepose.kernels.contact.metric import Frame
from cagepose.kernels.contact.seats import seat_circles
from cagepose.kernels.contact.tolerances import ACROSS
from cagepose.kernels.native.kernel import kernel


@kernel
def find_contacts(
    geometry: Geometry, placement: Placement, friction: Friction, center: Vector, frame: Frame, contacts: ContactSet
) -> bool:
    """Fill ``contacts`` where the object is placed, in the order of the scene, those of a group together; False: there
    are more than it has room for.
    """
    contacts.used[0] = first = 0
    held = held_at(geometry, placement)
    for body in range(number_of_bodies(geometry.cage)):
        cage, meetings = cage_at(geometry, body), meetings_with(placement, body)
        if meetings.used[0] < 0 or contacts.used[0] + meetings.used[0] > len(contacts.rows):
            contacts.used[0] = 0
            return False
        order_meetings(geometry, meetings)
        for k in range(meetings.used[0]):
            row = meetings.rows[meetings.order[k]]
            if row.group == meetings.order[k]:
                first = contacts.used[0]
            append_meeting(held, cage, body, row, friction, first, center, frame, contacts)
    seat_circles(geometry, contacts, frame)
    drop_across(contacts)
    return True


@kernel
def drop_across(contacts: ContactSet) -> None:
    """Drop the groups of which one face is across all freedoms that are left: no motion goes into it, and what lies at
    an edge of such a face slides along it.
    """
    kept = first = 0
    while first < contacts.used[0]:
        end, is_across, group = first, False, contacts.rows[first].group
        while end < contacts.used[0] and contacts.rows[end].group == group:
            is_across = is_across or length(contacts.rows[end].columns[0], contacts.n_freedoms) <= ACROSS
            end += 1
        new_group = kept
        for i in range(first, end if not is_across else first):
            if kept < i:
                contacts.rows[kept] = contacts.rows[i]  # type: ignore[index]
                contacts.states[kept] = contacts.states[i]  # type: ignore[index]
                contacts.bends[kept] = contacts.bends[i]  # type: ignore[index]
            contacts.rows[kept].group = new_group
            kept += 1
        first = end
    contacts.used[0] = kept


@kernel
def place_of(geometry: Geometry, meetings: Meetings, at: int) -> tuple[int, int, int]:
    """Return the place of a meeting in the order of the scene: by the part of the cage and that of the object of the
    first of its group, then by groups.
    """
    group = meetings.rows[at].group
    row, held, cage = meetings.rows[group], geometry.held, geometry.cage.own
    pair = cage.features[row.cage_feature].part * len(held.parts) + held.features[row.feature].part
    return pair, group, at


@kernel
def order_meetings(geometry: Geometry, meetings: Meetings) -> None:
    """Write the meetings in the order of the scene (Shell's sort)."""
    order, n = meetings.order, meetings.used[0]
    for at in range(n):
        order[at] = at
    apart = n // 2
    while apart > 0:
        for k in range(apart, n):
            at, before = order[k], k - apart
            place = place_of(geometry, meetings, at)
            while before >= 0 and place_of(geometry, meetings, order[before]) > place:
                order[before + apart] = order[before]
                before -= apart
            order[before + apart] = at
        apart //= 2


@kernel
def append_meeting(
    held: PlacedBoundary,
    cage: PlacedBoundary,
    body: int,
    row: Touching,
    friction: Friction,
    first: int,
    center: Vector,
    frame: Frame,
    contacts: ContactSet,
) -> None:
    """Append one contact with a body of the cage to the group that begins with row ``first``."""
    part, cage_part = held.own.features[row.feature].part, cage.own.features[row.cage_feature].part
    place = contacts.used[0]
    contact = contacts.rows[place]
    contact.part, contact.cage_part, contact.cage_body = part, cage_part, body
    contact.feature, contact.cage_feature, contact.angle = row.feature, row.cage_feature, row.angle
    contact.gap, contact.group, contact.is_added = row.gap, first, False
    choose(contacts, place, place == first)
    normal, arm = vector_from(row.normal), minus(vector_from(row.place), center)
    write_directions(contacts, place, normal, arm, friction_share(friction, cage_part, part), frame)
    met = Meeting(True, row.gap, normal, vector_from(row.place))
    found = curvatures(held, row.feature, cage, row.cage_feature, met, is_around(row))
    write_bend(found, normal, arm, frame.axes, frame.radii, contacts.bends[place])
    if row.twin >= 0:
        found = curvatures(held, row.twin, cage, row.cage_twin, met, False)
        write_twin(found, normal, arm, frame.axes, frame.radii, contacts.bends[place])
    write_on_circle(held, row.feature, cage, row.cage_feature, row, center, contacts.bends[place].on_circle)
    contacts.used[0] += 1
