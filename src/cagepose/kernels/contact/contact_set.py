"""The contacts at one pose as the mechanics needs them: a row for each place where two parts touch, with its wrenches.

A point that touches several faces lies on an edge: going in means that every one of them goes in (2.4), so one face
that holds or leaves is enough. Such faces form a group, of which one is chosen at a time. The same holds for all sharp
features of two bodies that meet at one place with several normals; where the edge between the faces is hollow, each
holds on its own.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np

from cagepose.kernels.algebra.least_squares import MOST_FREEDOMS, WRENCH
from cagepose.kernels.algebra.record import FloatArray, IntArray, Rows, empty_rows
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, scaled
from cagepose.kernels.boundary.bend import Bend
from cagepose.kernels.boundary.geometry import Geometry, most_rows
from cagepose.kernels.contact.metric import Frame, write_scaled_wrench
from cagepose.kernels.contact.pressing import Pressing, write_pressed
from cagepose.kernels.native.kernel import kernel

STEEP = 0.55
"""Cosine. Each normal is nearer to an axis than this; few ordinary ones are so far from one that rounding would change
which is taken."""


class ContactRow:
    """The geometry of one contact; a record.

    Attributes
    ----------
    part, cage_part, cage_body
        Indices of the parts of the object and of the cage, and of the body of the cage.
    feature, cage_feature
        Indices of their features that touch.
    angle
        Where along a circle, if one of the features is one, radians.
    gap
        Distance, below zero: how deep, metres.
    group
        The first row of those of which one counts at a time.
    is_added
        Whether it is a place of a circle that was not listed at first, see `on_circle`.
    directions, arm
        Outward unit normal and two tangents, rows, and the place as seen from the centre of gravity, in the world. The
        tangents are as long as the contact's coefficient of friction is of the greatest one, so that one coefficient
        does for all contacts: with tangential forces and slip in this unit Coulomb's law reads the same.
    wrenches
        Scaled wrenches of a force along these directions, on all that can move. The contact pushes along their
        negative.
    columns
        The same, but for what contacts without play lock, see `self_stress`.
    drift
        How fast the contact closes, and slips along its tangents, where the object stands still: the cage's body is
        driven. Zero in all questions about rest.
    """

    part: int
    cage_part: int
    cage_body: int
    feature: int
    cage_feature: int
    angle: float
    gap: float
    group: int
    is_added: bool
    directions: Annotated[FloatArray, 3, 3]
    arm: Annotated[FloatArray, 3]
    wrenches: Annotated[FloatArray, 3, MOST_FREEDOMS]
    columns: Annotated[FloatArray, 3, MOST_FREEDOMS]
    drift: Annotated[FloatArray, 3]


class ContactState:
    """What one contact does in the problem that is being solved; a record.

    Attributes
    ----------
    chosen
        Whether it is the face that is asked of its group: all are but the other faces on an edge.
    counts
        Whether it takes part in the problem: chosen, and not left out of it because of what others lock.
    may_share
        Whether it may carry a part of what others carry, see `sharing`.
    forces
        What the contact carries along its columns.
    is_sticking
        Whether it carries and does not slip.
    is_locked
        Whether its gap stays as it is because contacts without play press against each other, see `self_stress`.
    stays_flat
        Whether it is a listed point of a rim that lies flat, and the motion leaves it so, be it that others carry.
    slip_speed, is_rejected
        Of the problem with round cones: De Saxce's correction (5.7), and whether its generator did not help.
    has_carried
        In the first row of a group: whether one of its faces carried, or was locked, in a choice that has been asked.
    kept_chosen, kept_forces
        Of the choice of faces that is kept.
    """

    chosen: bool
    counts: bool
    may_share: bool
    forces: Annotated[FloatArray, 3]
    is_sticking: bool
    is_locked: bool
    stays_flat: bool
    slip_speed: float
    is_rejected: bool
    has_carried: bool
    kept_chosen: bool
    kept_forces: Annotated[FloatArray, 3]


class ContactSet(NamedTuple):
    """The contacts at one pose, 0 to used - 1 (``used`` is (1,)): their geometry, and what they do.

    ``bends`` say of each row how its surfaces bend, ``pressing`` of each body of the cage whether it presses. All that
    can move has ``n_freedoms`` together: of wrenches, motions and loads so many numbers count.
    """

    used: IntArray
    rows: Rows[ContactRow]
    states: Rows[ContactState]
    bends: Rows[Bend]
    pressing: Rows[Pressing]
    n_freedoms: int


def empty_contact_set(n_rows: int, n_freedoms: int = WRENCH, n_bodies: int = 0) -> ContactSet:
    """Return a set with memory for ``n_rows`` contacts, and ``n_bodies`` that may press (plain Python)."""
    return ContactSet(
        np.zeros(1, np.int64),
        empty_rows(ContactRow, n_rows),
        empty_rows(ContactState, n_rows),
        empty_rows(Bend, n_rows),
        empty_rows(Pressing, n_bodies),
        n_freedoms,
    )


def contact_set_for(geometry: Geometry) -> ContactSet:
    """Return a set with memory for all contacts that there may be at one pose (plain Python)."""
    return empty_contact_set(most_rows(geometry), n_bodies=len(geometry.cage.first_nodes) - 1)


@kernel
def is_smooth(contacts: ContactSet, i: int) -> bool:
    """Whether a contact has no friction, though others may have."""
    greatest, columns = 0.0, contacts.rows[i].columns
    for k in range(contacts.n_freedoms):
        greatest = max(greatest, abs(columns[1, k]), abs(columns[2, k]))
    return greatest == 0.0


@kernel
def stays_on_face(contacts: ContactSet, i: int) -> bool:
    """Whether a contact keeps its gap in a motion that begins: it carries, or is locked."""
    return contacts.states[i].forces[0] > 0.0 or contacts.states[i].is_locked


@kernel
def choose(contacts: ContactSet, i: int, chosen: bool) -> None:
    """Choose a face, or not: it counts if it is chosen."""
    contacts.states[i].chosen = contacts.states[i].counts = chosen


@kernel
def count_chosen(contacts: ContactSet) -> None:
    """Let all contacts that are chosen count again."""
    for i in range(contacts.used[0]):
        contacts.states[i].counts = contacts.states[i].chosen


@kernel
def tangents_to(normal: Vector) -> tuple[Vector, Vector]:
    """Return two unit vectors across a unit normal and each other: of the three axes the two that follow the one that
    the normal leads along, turned to be across it. For nearly the same normal they are nearly the same.
    """
    x, y, z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    if abs(normal[2]) >= STEEP:
        first, second = x, y
    elif abs(normal[1]) >= STEEP:
        first, second = z, x
    else:
        first, second = y, z
    one = minus(first, scaled(normal, dot(first, normal)))
    one = scaled(one, 1.0 / norm(one))
    other = cross(normal, one)
    return one, scaled(other, math.copysign(1.0, dot(other, second)))


@kernel
def write_directions(contacts: ContactSet, i: int, normal: Vector, arm: Vector, share: float, frame: Frame) -> None:
    """Write normal and tangents of a contact that does not drift, and its wrenches; the tangents are ``share`` long."""
    contact, (one, other) = contacts.rows[i], tangents_to(normal)
    directions = (normal, scaled(one, share), scaled(other, share))
    for k in range(3):
        contact.arm[k], contact.drift[k] = arm[k], 0.0
    for j in range(3):
        for k in range(3):
            contact.directions[j, k] = directions[j][k]
        write_scaled_wrench(directions[j], cross(arm, directions[j]), frame, contact.wrenches[j])
    if contacts.n_freedoms > WRENCH:
        write_pressed(contacts.pressing, contact.cage_body, contact.directions, contacts.n_freedoms, contact.wrenches)
    for j in range(3):
        for k in range(contacts.n_freedoms):
            contact.columns[j, k] = contact.wrenches[j, k]
