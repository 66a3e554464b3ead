"""The first contact along a twist, but for what touches already."""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.motion import motion_of
from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.vector import Vector, dot, minus, norm, plus, vector_from
from cagepose.kernels.boundary.features import number_of_bodies
from cagepose.kernels.boundary.first_meeting import Search, first_to_meet
from cagepose.kernels.boundary.geometry import (
    Placement,
    cage_at,
    held_at,
    held_moved,
    meetings_with,
    middle_of_cage_part,
)
from cagepose.kernels.boundary.touching import Meetings
from cagepose.kernels.contact.contact_set import ContactSet
from cagepose.kernels.contact.on_circle import is_kept
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.quasistatic.setting import Setting
from cagepose.kernels.quasistatic.straying import STRAYED, strayed

LOOKED_AT_AGAIN = 64
"""Features that are met because contacts stray are passed over so many times at most."""


class Twist(NamedTuple):
    """A motion at constant twist.

    Attributes
    ----------
    velocity, spin
        Of the centre of gravity, and angular, for each unit of the amount.
    end
        The greatest amount; inf: a travel with no end of its own.
    """

    velocity: Vector
    spin: Vector
    end: float


class Hit(NamedTuple):
    """What is reached, and after which amount of a twist.

    Attributes
    ----------
    amount
        Inf: nothing is.
    feature, cage_feature, angle
        The features that do, -1: none do; and where along a circle, if one of them is one.
    """

    amount: float
    feature: int
    cage_feature: int
    angle: float


NO_HIT = Hit(math.inf, -1, -1, 0.0)


@kernel
def until_past(setting: Setting, position: Vector, velocity: Vector) -> float:
    """Return the amount of a travel after which the object is past all of the cage; zero: nothing is ahead."""
    parts, farthest = setting.geometry.cage.own.parts, 0.0
    for part in range(len(parts)):
        ahead = dot(velocity, minus(middle_of_cage_part(setting.geometry, part), position)) / norm(velocity)
        farthest = max(farthest, ahead + parts[part].reach + setting.body.reach_m)
    return farthest / norm(velocity)


@kernel
def note_kept(meetings: Meetings, body: int, contacts: ContactSet, center: Vector) -> None:
    """Note which meetings with a body of the cage a motion keeps, also at places of circles that were added to those
    that are listed.
    """
    rows, last = meetings.rows, max(meetings.used[0], 0)
    for at in range(last):
        rows[at].is_kept = False
        for i in range(contacts.used[0]):
            contact = contacts.rows[i]
            is_same = contact.feature == rows[at].feature and contact.cage_feature == rows[at].cage_feature
            rows[at].is_kept = rows[at].is_kept or (
                is_same and contact.angle == rows[at].angle and is_kept(contacts, i)
            )
    for i in range(contacts.used[0]):
        contact = contacts.rows[i]
        if contact.is_added and contact.cage_body == body and is_kept(contacts, i) and last < len(rows):
            row, place = rows[last], plus(center, vector_from(contact.arm))
            row.feature, row.cage_feature, row.angle = contact.feature, contact.cage_feature, contact.angle
            row.gap, row.is_kept = contact.gap, True
            for k in range(3):
                row.place[k], row.normal[k] = place[k], contact.directions[0, k]
            last += 1
    meetings.used[1] = last


@kernel
def first_contact(
    setting: Setting,
    placement: Placement,
    contacts: ContactSet,
    position: Vector,
    quaternion: Quaternion,
    twist: Twist,
    reach_m: float,
) -> Hit:
    """Return the first contact along a twist, but for what touches already.

    Contacts that stay on their faces stray on a screw, by the square of its length, and are put back afterwards. Where
    something is met because of that, not because it came nearer, it is passed over: what was no farther than they stray
    where it is met, at most ``reach_m``. Whether it is reached shows at the end.
    """
    hit = NO_HIT
    end = until_past(setting, position, twist.velocity) if twist.end == math.inf else twist.end
    for body in range(number_of_bodies(setting.geometry.cage) if end > 0.0 else 0):
        until = Twist(twist.velocity, twist.spin, min(end, hit.amount))
        found = first_with_body(setting, body, placement, contacts, position, quaternion, until, reach_m)
        if found.amount < hit.amount:
            hit = found
    return hit


@kernel
def first_with_body(
    setting: Setting,
    body: int,
    placement: Placement,
    contacts: ContactSet,
    position: Vector,
    quaternion: Quaternion,
    twist: Twist,
    reach_m: float,
) -> Hit:
    """As `first_contact`, with one of the cage's bodies, along a twist that ends."""
    geometry, velocity, spin = setting.geometry, twist.velocity, twist.spin
    motion, touch_m = motion_of(position, velocity, spin), setting.tolerances.touch_m
    speed = norm(velocity) + motion.rate * setting.body.reach_m
    held, moved = held_at(geometry, placement), held_moved(geometry, placement)
    cage, meetings = cage_at(geometry, body), meetings_with(placement, body)
    note_kept(meetings, body, contacts, position)
    hit, near = NO_HIT, 0.0
    for _ in range(LOOKED_AT_AGAIN):
        search = Search(motion, twist.end, near, reach_m, speed, touch_m, setting.size_m)
        found = first_to_meet(held, cage, search, meetings, placement.queue, moved)
        if found.feature < 0:
            return NO_HIT
        if found.is_open:  # nothing is reached before; the next step asks from there
            return Hit(found.amount, -1, -1, 0.0)
        hit = Hit(found.amount, found.feature, found.cage_feature, found.angle)
        if found.gap > reach_m or found.gap <= near:
            break
        away = strayed(geometry, placement, contacts, position, quaternion, velocity, spin, found.amount, 0.0)
        near_here = min(STRAYED * away, reach_m)
        if found.gap > near_here:
            break
        near = near_here
    return hit
