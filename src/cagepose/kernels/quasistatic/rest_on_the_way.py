"""Friction can bring the object to rest within a step: the first pose that it holds."""

from __future__ import annotations

from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.vector import Vector
from cagepose.kernels.collision.first_meeting import NO_HIT
from cagepose.kernels.collision.geometry import place_object
from cagepose.kernels.contact.contact_set import ContactRow, ContactSet, find_contacts
from cagepose.kernels.contact.equilibrium import HELD_BY_FRICTION, ON_THE_WAY, equilibrium
from cagepose.kernels.contact.loads import write_load
from cagepose.kernels.contact.metric import frame_at
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.quasistatic.along_twist import Twist, stepped
from cagepose.kernels.quasistatic.setting import Setting
from cagepose.kernels.quasistatic.workspace import QuasistaticWorkspace

HALVES_TO_REST = 45
"""Halvings of a step in which friction brings the object to rest: to rounding."""


@kernel
def is_held_on_the_way(setting: Setting, position: Vector, quaternion: Quaternion, work: QuasistaticWorkspace) -> bool:
    """Whether friction holds the object at a pose of a step, by what touched before it.

    What the step reaches does not count: it touches at the end only, and what it holds is asked there.
    """
    frame = frame_at(setting.body, quaternion)
    if not find_contacts(
        setting.geometry, work.placement, setting.friction, position, frame, setting.tolerances.touch_m, work.ahead
    ):
        return False
    kept = 0
    for i in range(work.ahead.used[0]):
        if touched_before(work.contacts, work.ahead.rows[i]):
            move_contact(work.ahead, i, kept)
            kept += 1
    work.ahead.used[0] = kept
    solver, greatest = work.scratch[0].solver, setting.friction.greatest
    solver.load_terms = write_load(setting.load, position, quaternion, frame, solver.load)
    return equilibrium(work.ahead, frame, greatest, ON_THE_WAY, solver) <= HELD_BY_FRICTION


@kernel
def touched_before(contacts: ContactSet, one: ContactRow) -> bool:
    """Whether the point and the box of a contact, or its features, touch at the pose of the contacts."""
    for i in range(contacts.used[0]):
        row = contacts.rows[i]
        if (row.point, row.box, row.feature, row.cage_feature) == (one.point, one.box, one.feature, one.cage_feature):
            return True
    return False


@kernel
def move_contact(contacts: ContactSet, source: int, target: int) -> None:
    """Move what the contact problem needs of one row to another; its whole group is moved as far."""
    if source == target:
        return
    rows = contacts.rows
    old, new = rows[source], rows[target]
    new.point, new.box, new.feature, new.cage_feature = old.point, old.box, old.feature, old.cage_feature
    new.group = -1 if old.group < 0 else old.group - source + target
    for j in range(3):
        new.arm[j] = old.arm[j]
        for k in range(3):
            new.directions[j, k] = old.directions[j, k]
        for k in range(6):
            new.columns[j, k] = old.columns[j, k]
    if old.feature >= 0:
        contacts.bends[target] = contacts.bends[source]  # type: ignore[index]


@kernel
def first_rest(
    setting: Setting,
    position: Vector,
    quaternion: Quaternion,
    twist: Twist,
    amount: float,
    end: tuple[Vector, Quaternion],
    work: QuasistaticWorkspace,
) -> tuple[Vector, Quaternion]:
    """Return the first pose of a step that friction holds; at its end, after ``amount``, it does. The placement is that
    of the pose.
    """
    low, high = 0.0, amount
    best = end
    for _ in range(HALVES_TO_REST):
        middle = 0.5 * (low + high)
        place_object(setting.geometry, position, quaternion, work.placement)
        done, new_position, new_quaternion = stepped(
            setting,
            work.placement,
            work.contacts,
            position,
            quaternion,
            twist,
            middle,
            NO_HIT,
            work.path,
        )
        if done and is_held_on_the_way(setting, new_position, new_quaternion, work):
            high = middle
            best = (new_position, new_quaternion)
        else:
            low = middle
    place_object(setting.geometry, best[0], best[1], work.placement)
    return best
