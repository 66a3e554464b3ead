"""The contact problem at a pose within a step: of what touched before it.

What the step reaches does not count: it touches at the end only, and is asked there.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.vector import Vector
from cagepose.kernels.circles.places import within_turn
from cagepose.kernels.contact.contact_set import ContactRow, ContactSet
from cagepose.kernels.contact.find_contacts import find_contacts
from cagepose.kernels.contact.loads import write_load
from cagepose.kernels.contact.metric import Frame
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.quasistatic.setting import Setting
from cagepose.kernels.quasistatic.workspace import QuasistaticWorkspace


@kernel
def find_touched_before(
    setting: Setting, position: Vector, quaternion: Quaternion, frame: Frame, work: QuasistaticWorkspace
) -> bool:
    """Fill ``work.ahead`` and the load where the object is placed, without contacts that ``work.contacts`` do not have;
    False: there are too many.
    """
    if not find_contacts(setting.geometry, work.placement, setting.friction, position, frame, work.ahead):
        return False
    kept = 0
    for i in range(work.ahead.used[0]):
        if place_before(work.contacts, work.ahead.rows[i]) >= 0:
            move_contact(work.ahead, i, kept)
            kept += 1
    work.ahead.used[0] = kept
    solver = work.scratch[0].solver
    solver.load_terms = write_load(setting.load, position, quaternion, frame, solver.load)
    return True


@kernel
def place_before(contacts: ContactSet, one: ContactRow) -> int:
    """Return which of the contacts is of the same features, and of a circle at the nearest place; -1:
    none is.
    """
    found, least = -1, math.inf
    for i in range(contacts.used[0]):
        row = contacts.rows[i]
        if (row.feature, row.cage_feature) == (one.feature, one.cage_feature):
            away = abs(within_turn(row.angle - one.angle))
            if away < least:
                found, least = i, away
    return found


@kernel
def move_contact(contacts: ContactSet, source: int, target: int) -> None:
    """Move what the contact problem needs of one row to another; its whole group is moved as far."""
    if source == target:
        return
    rows = contacts.rows
    old, new = rows[source], rows[target]
    new.part, new.cage_part, new.cage_body = old.part, old.cage_part, old.cage_body
    new.feature, new.cage_feature = old.feature, old.cage_feature
    new.angle, new.gap, new.is_added = old.angle, old.gap, old.is_added
    new.group = old.group - source + target
    for j in range(3):
        new.arm[j] = old.arm[j]
        for k in range(3):
            new.directions[j, k] = old.directions[j, k]
        for k in range(contacts.n_freedoms):
            new.wrenches[j, k], new.columns[j, k] = old.wrenches[j, k], old.columns[j, k]
    contacts.bends[target] = contacts.bends[source]  # type: ignore[index]
