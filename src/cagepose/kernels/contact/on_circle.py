"""A circle that lies flat touches with all its points, of which some are listed: others are added where they count.

Of a cylinder that stands on a floor, or of a ball in a round hole, eight contacts are listed. If they do not hold the
load, the motion that begins goes in deepest at some point of the circle, in closed form; this is added, and the
question asked again, until no point goes in: the exchange method of semi-infinite programs. The points close in on the
two between which the circle carries, halving the angle each time. Of a balance with friction it is the point whose
force would take the most power from the twist that is left.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.least_squares import length
from cagepose.kernels.algebra.pose import matrix_from_quaternion, quaternion_about
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.boundary.bend import write_turned
from cagepose.kernels.contact.cone import ConeWorkspace
from cagepose.kernels.contact.contact_set import ContactSet, choose, stays_on_face, write_directions
from cagepose.kernels.contact.edges import has_one_choice
from cagepose.kernels.contact.metric import Frame, twist_of
from cagepose.kernels.contact.pressing import velocity_of_body
from cagepose.kernels.contact.tolerances import LAST_TURN_RAD, ROUNDING_OF_SPEED, SAME_WAY, SPEED_OF_ENTRY
from cagepose.kernels.native.kernel import kernel

MOST_ADDED_POINTS = 40
"""So many points of circles are added for one question."""
MOST_FOLLOWED = 30
"""The slip is followed along a circle so many times at most."""


@kernel
def is_under_circle(contacts: ContactSet, i: int, touch_m: float) -> bool:
    """Whether a contact is of a circle that a face lies on, to the touch tolerance."""
    around, normal = contacts.bends[i].on_circle, vector_from(contacts.rows[i].directions[0])
    if around.length == 0.0 or around.is_on_ball:
        return False
    return abs(around.length) * norm(cross(vector_from(around.axis), normal)) <= touch_m


@kernel
def is_along_wall(contacts: ContactSet, i: int) -> bool:
    """Whether a contact is of a circle that lies along the wall of a hole. One that lies around a cone is held by it as
    by a wedge, and one around a ball stays where it is.
    """
    around, row = contacts.bends[i].on_circle, contacts.rows[i]
    if around.length == 0.0 or not around.is_on_ball:
        return False
    away = minus(vector_from(row.arm), vector_from(around.ball))
    return (dot(away, vector_from(row.directions[0])) > 0.0) != around.is_of_cage


@kernel
def is_of_same_circle(contacts: ContactSet, i: int, other: int) -> bool:
    """Whether another contact is of the same circle, around the same round side."""
    row, one = contacts.rows[i], contacts.rows[other]
    if one.feature != row.feature or one.cage_feature != row.cage_feature:
        return False
    around, beside = contacts.bends[i].on_circle, contacts.bends[other].on_circle
    return bool(around.length != 0.0 and beside.length != 0.0 and around.is_on_ball and beside.is_on_ball)


@kernel
def keeps_on_circle(
    contacts: ContactSet, i: int, velocity: Vector, spin: Vector, touch_m: float, slowest: float
) -> bool:
    """Whether a contact is of a circle that a motion leaves all on what it lies on, to a speed and to first order."""
    if contacts.bends[i].on_circle.length == 0.0:
        return False
    around, normal = contacts.bends[i].on_circle, vector_from(contacts.rows[i].directions[0])
    if is_along_wall(contacts, i):  # all normals lead through one place; but as it tilts, it is an ellipse to the wall
        slides = norm(plus(velocity, cross(spin, vector_from(around.ball))))
        return max(slides, abs(around.length) * norm(cross(vector_from(around.axis), spin))) <= slowest
    away = abs(dot(normal, plus(velocity, cross(spin, vector_from(contacts.rows[i].arm)))))
    tilt = abs(around.length) * norm(cross(normal, spin))  # about a point of it, a circle may tip
    return is_under_circle(contacts, i, touch_m) and max(away, tilt) <= slowest


@kernel
def is_on_flat(contacts: ContactSet, i: int) -> bool:
    """Whether a point that was added is of a circle that stays flat on the same face."""
    row, found = contacts.rows[i], False
    for j in range(contacts.used[0]):
        other = contacts.rows[j]
        is_same = other.part == row.part and other.cage_part == row.cage_part
        if is_same and contacts.states[j].stays_flat:
            turned = dot(vector_from(other.directions[0]), vector_from(row.directions[0]))
            found = found or turned > SAME_WAY
    return found


@kernel
def is_kept(contacts: ContactSet, i: int) -> bool:
    """Whether a step puts a contact back on its face: it carries, is locked or is of a circle that stays flat.

    Of such a circle the points that were listed stand for those that were added, which are nowhere in particular.
    """
    if contacts.states[i].stays_flat:
        return True
    return stays_on_face(contacts, i) and not (contacts.rows[i].is_added and is_on_flat(contacts, i))


@kernel
def place_on_circle(contacts: ContactSet, i: int, angle: float) -> tuple[Vector, Vector]:
    """Return (arm, normal) of the contact at an angle along the circle from a place of it that touches."""
    row, around = contacts.rows[i], contacts.bends[i].on_circle
    axis, outward = vector_from(around.axis), vector_from(around.outward)
    center = minus(vector_from(row.arm), scaled(outward, around.length))
    there = plus(scaled(outward, math.cos(angle)), scaled(cross(axis, outward), math.sin(angle)))
    arm, normal = plus(center, scaled(there, around.length)), vector_from(row.directions[0])
    if around.is_on_ball:
        away = minus(arm, vector_from(around.ball))
        side = math.copysign(1.0, dot(minus(vector_from(row.arm), vector_from(around.ball)), normal))
        normal = scaled(away, side / norm(away))
    return arm, normal


@kernel
def angle_of_deepest(
    contacts: ContactSet, i: int, friction: float, velocity: Vector, spin: Vector, start: float
) -> float:
    """Return the angle along the circle, from a place of it that touches, to where a contact would resist a motion
    most: a maximum of n . v + mu |v_t|, uphill from the slip at ``start``.

    With the direction of the slip given, that is in closed form; the direction follows from where it is.
    """
    row, around = contacts.rows[i], contacts.bends[i].on_circle
    axis, outward = vector_from(around.axis), vector_from(around.outward)
    share = friction * norm(vector_from(row.directions[1]))
    angle = start
    for _ in range(MOST_FOLLOWED if share > 0.0 else 1):
        arm, normal = place_on_circle(contacts, i, angle)
        way = plus(velocity, cross(spin, arm))
        slip = minus(way, scaled(normal, dot(normal, way)))
        rubs = scaled(slip, share / norm(slip)) if norm(slip) > 0.0 else (0.0, 0.0, 0.0)
        if around.is_on_ball:  # n . v(p) = (p - c) . v(c) / r, or its opposite
            away, ball = minus(arm, vector_from(around.ball)), vector_from(around.ball)
            side = math.copysign(1.0 / norm(away), dot(away, normal))
            along = plus(scaled(plus(velocity, cross(spin, ball)), side), cross(rubs, spin))
        else:  # g . (w x p) = p . (g x w)
            along = cross(plus(normal, rubs), spin)
        along, before = scaled(along, around.length), angle
        angle = math.atan2(dot(along, cross(axis, outward)), dot(along, outward))
        if abs(angle - before) <= LAST_TURN_RAD:
            break
    return angle


@kernel
def deepest_on_arc(
    contacts: ContactSet, i: int, friction: float, velocity: Vector, spin: Vector
) -> tuple[float, float]:
    """Return (angle, speed): where a contact along the arc around a place that touches would resist a motion most, and
    by n . v + mu |v_t| there, which is the support function of its forces; (0, -inf): at the place alone.

    With friction there may be several maxima: uphill from the place, and from the one without friction.
    """
    around, share = contacts.bends[i].on_circle, norm(vector_from(contacts.rows[i].directions[1]))
    found, fastest = 0.0, -math.inf
    if around.length == 0.0:
        return found, fastest
    deepest = angle_of_deepest(contacts, i, 0.0, velocity, spin, 0.0)
    for k in range(2 if friction > 0.0 else 1):
        angle = deepest
        if friction > 0.0:
            angle = angle_of_deepest(contacts, i, friction, velocity, spin, deepest if k == 0 else 0.0)
        if angle == 0.0 or abs(angle) > (1.0 + SPEED_OF_ENTRY) * (around.after if angle > 0.0 else around.before):
            continue
        arm, normal = place_on_circle(contacts, i, angle)
        way = plus(velocity, cross(spin, arm))
        speed = dot(normal, way)
        speed += friction * share * norm(minus(way, scaled(normal, speed)))
        if speed > fastest:
            found, fastest = angle, speed
    return found, fastest


@kernel
def add_point(contacts: ContactSet, i: int, angle: float, frame: Frame) -> None:
    """Append the contact at an angle along the circle from a place of it that touches."""
    row, place = contacts.rows[i], contacts.used[0]
    arm, normal = place_on_circle(contacts, i, angle)
    new, state, around = contacts.rows[place], contacts.states[place], contacts.bends[i].on_circle
    new.part, new.cage_part, new.cage_body = row.part, row.cage_part, row.cage_body
    new.gap, new.group, new.is_added = row.gap, place, True
    new.feature, new.cage_feature, new.angle = row.feature, row.cage_feature, row.angle + angle
    write_directions(contacts, place, normal, arm, norm(vector_from(row.directions[1])), frame)
    choose(contacts, place, True)
    state.is_locked = state.is_sticking = state.has_carried = state.kept_chosen = False
    for k in range(3):
        state.forces[k] = state.kept_forces[k] = 0.0
    contacts.bends[place] = contacts.bends[i]  # type: ignore[index]
    contacts.bends[place].on_circle.length = 0.0
    by = matrix_from_quaternion(quaternion_about(vector_from(around.axis), angle))
    normal = vector_from(new.directions[0])
    write_turned(contacts.bends[i], by, normal, vector_from(new.arm), frame.axes, frame.radii, contacts.bends[place])
    contacts.used[0] = place + 1


@kernel
def drop_idle(contacts: ContactSet, cone: ConeWorkspace) -> None:
    """Drop the points that were added and carry nothing. Where edges leave a choice of faces another one may need them.

    The labels of ``cone`` go with them.
    """
    for i in range(contacts.used[0] - 1 if has_one_choice(contacts) else -1, -1, -1):
        if not contacts.rows[i].is_added or stays_on_face(contacts, i):
            continue
        last = contacts.used[0] - 1  # those behind one that was added were added, too
        contacts.rows[i] = contacts.rows[last]  # type: ignore[index]
        contacts.states[i] = contacts.states[last]  # type: ignore[index]
        contacts.bends[i] = contacts.bends[last]  # type: ignore[index]
        contacts.rows[i].group = i
        contacts.used[0] = last
        for k in range(cone.passive.used):
            if cone.contacts[cone.passive.labels[k]] == last:
                cone.contacts[cone.passive.labels[k]] = i


@kernel
def add_on_circles(contacts: ContactSet, frame: Frame, friction: float, y: FloatArray, terms: float) -> bool:
    """Append the point of a flat circle that a motion y goes in fastest at; False: none counts, or there is no room.

    With friction y is a twist that forces are asked to resist, which they do up to mu |v_t| faster. What y is the rest
    of has ``terms`` of this length: slower than their rounding, nothing goes in.
    """
    of_object, spin = twist_of(y, frame)
    fastest, at_fastest = -1, 0.0
    least = max(SPEED_OF_ENTRY * length(y, contacts.n_freedoms), ROUNDING_OF_SPEED * terms)
    for i in range(contacts.used[0]):
        velocity = minus(of_object, velocity_of_body(contacts.pressing, contacts.rows[i].cage_body, y))
        angle, speed = deepest_on_arc(contacts, i, friction, velocity, spin)
        if speed > least:
            fastest, at_fastest, least = i, angle, speed
    if fastest < 0 or contacts.used[0] == len(contacts.rows):
        return False
    add_point(contacts, fastest, at_fastest, frame)
    return True
