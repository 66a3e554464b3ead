"""The path of a step: along a twist, with the contacts that carry on their faces.

A screw leaves curved constraints by the square of its length. So every pose of a step is one of the screw put back on
the faces, and all that is asked of a step is asked of such poses.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.vector import Vector, norm
from cagepose.kernels.boundary.geometry import place_object
from cagepose.kernels.contact.contact_set import ContactSet
from cagepose.kernels.contact.loads import total_load, work_done
from cagepose.kernels.contact.metric import moved_along_twist, twist_between, way_between
from cagepose.kernels.contact.on_circle import is_kept
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.quasistatic.first_contact import Hit, Twist
from cagepose.kernels.quasistatic.projection import GAP, constrain_features, depth_left, drop_constraint, lack
from cagepose.kernels.quasistatic.pushing_out import allow_depths, constrain_contacts, has_fixed, pushed_out, put_back
from cagepose.kernels.quasistatic.setting import Setting
from cagepose.kernels.quasistatic.step_length import straightened
from cagepose.kernels.quasistatic.workspace import QuasistaticWorkspace

MAY_SLIP = 0.01
"""Share of the way of a step. What sticks in two places may slip by as much, where it cannot turn without, as in a V.
That is of second order in the step, by which its path is wrong anyway."""
TO_FIRST_ORDER = 2.0
"""Times what is worked out to first order."""
LEAST_SPEED = 1e-300
"""Metres for each unit of an amount: a slower motion is a turn."""
HALVINGS_TO_FACES = 6
"""How often a step is halved at whose end contacts cannot be put back on their faces."""


class Path(NamedTuple):
    """Where a step begins, and the twist that it follows.

    Attributes
    ----------
    position, quaternion
        Pose of the object at its beginning.
    twist
        See there.
    """

    position: Vector
    quaternion: Quaternion
    twist: Twist


@kernel
def speed_along(setting: Setting, path: Path) -> float:
    """Return how far the object moves at most for each amount, metres."""
    return norm(path.twist.velocity) + setting.body.reach_m * norm(path.twist.spin)


@kernel
def constrain_step(setting: Setting, path: Path, amount: float, work: QuasistaticWorkspace) -> float:
    """Constrain the contacts that stay on their faces in a step; return the way of the step, metres."""
    constraints, way = work.path.constraints, amount * speed_along(setting, path)
    constrain_contacts(work.contacts, setting.tolerances.rounding_m, constraints)
    constraints.scratch[0].may_slip_m = max(setting.tolerances.touch_m, MAY_SLIP * way)
    return way


@kernel
def on_faces(
    setting: Setting, path: Path, amount: float, work: QuasistaticWorkspace
) -> tuple[bool, Vector, Quaternion]:
    """Return the pose after an amount where contacts that stay on their faces are on them; False: they cannot be put
    back, or not by a way that is shorter.
    """
    way = constrain_step(setting, path, amount, work)
    moved = moved_along_twist(path.position, path.quaternion, path.twist.velocity, path.twist.spin, amount)
    done, end, turned = put_back(setting, work.placement, moved[0], moved[1], work.path.constraints)
    done = done and way_between(moved[0], moved[1], end, turned, setting.body.reach_m) <= way
    if done:
        deepest = depth_left(setting.geometry, work.path.constraints, end, turned, work.placement)
        done = deepest <= work.path.allowed_m[0]
    return done, end, turned


@kernel
def gap_of(setting: Setting, one: Hit, position: Vector, quaternion: Quaternion, work: QuasistaticWorkspace) -> float:
    """Return the gap, at a pose, of features that are not constrained, metres; inf: they do not meet, or are."""
    constraints = work.path.constraints
    if not constrain_features(constraints, one.feature, one.cage_feature, one.angle, GAP, 0.0):
        return math.inf
    last = constraints.scratch[0].used - 1
    gap = lack(setting.geometry, constraints.rows[last], position, quaternion, work.placement).value
    drop_constraint(constraints, last)
    return gap


@kernel
def on_faces_with_one_open(
    setting: Setting, path: Path, amount: float, work: QuasistaticWorkspace
) -> tuple[bool, Vector, Quaternion]:
    """As `on_faces` where one of the contacts opens, by the square of the way: of four feet on a floor that bends three
    carry. It carries nothing any more then.
    """
    contacts = work.contacts
    for i in range(contacts.used[0]):
        row, state, carried = contacts.rows[i], contacts.states[i], contacts.states[i].forces[0]
        if carried == 0.0 or state.is_locked or state.is_sticking or state.stays_flat:
            continue
        state.forces[0] = 0.0
        done, end, turned = on_faces(setting, path, amount, work)
        if done:
            one = Hit(0.0, row.feature, row.cage_feature, row.angle)
            if setting.tolerances.rounding_m < gap_of(setting, one, end, turned, work) < math.inf:
                return True, end, turned
        state.forces[0] = carried
    return False, path.position, path.quaternion


@kernel
def along_faces(setting: Setting, path: Path, work: QuasistaticWorkspace) -> tuple[Path, bool]:
    """Return the path whose twist leads, in an amount of one, to where contacts that stay on their faces are on them
    again at the end of a twist, after the way of a size of the scene or a part of it; and whether it is all of it. A
    travel without end is kept, and so is the direction of a motion that nothing guides, and of one of a circle that
    lies flat or fits all around, whose places change as it tilts.
    """
    twist = path.twist
    allow_depths(setting.geometry, work.placement, setting.tolerances, work.path)
    constrain_contacts(work.contacts, setting.tolerances.rounding_m, work.path.constraints)
    if twist.end == math.inf or not is_guided(work):
        return path, True
    amount = min(twist.end, setting.size_m / max(norm(twist.velocity), LEAST_SPEED))
    if has_fixed(work.contacts):
        return Path(path.position, path.quaternion, Twist(twist.velocity, twist.spin, amount)), True
    for halving in range(HALVINGS_TO_FACES):
        done, end, turned = on_faces(setting, path, amount, work)
        if not done:
            done, end, turned = on_faces_with_one_open(setting, path, amount, work)
        if done and way_between(path.position, path.quaternion, end, turned, setting.body.reach_m) > 0.0:
            velocity, spin = twist_between(path.position, path.quaternion, end, turned)
            spin = straightened(velocity, spin, setting.body.reach_m, 0.0)
            return Path(path.position, path.quaternion, Twist(velocity, spin, 1.0)), halving == 0
        amount *= 0.5
    constrain_contacts(work.contacts, setting.tolerances.rounding_m, work.path.constraints)
    return Path(path.position, path.quaternion, Twist(twist.velocity, twist.spin, amount)), False


@kernel
def is_guided(work: QuasistaticWorkspace) -> bool:
    """Whether contacts are constrained, as after `constrain_step`."""
    return work.path.constraints.scratch[0].used > 0


@kernel
def work_of_depths(contacts: ContactSet) -> float:
    """Return the work of the forces that contacts carry as they come out of what they are deep in, to first order."""
    work = 0.0
    for i in range(contacts.used[0]):
        if is_kept(contacts, i):
            work += contacts.states[i].forces[0] * max(0.0, -contacts.rows[i].gap)
    return work


@kernel
def step_to(
    setting: Setting, path: Path, amount: float, hit: Hit, work: QuasistaticWorkspace
) -> tuple[bool, Vector, Quaternion]:
    """Move by ``amount``, keep the contacts that carry on their faces, and put the one that is hit on its own.

    A contact that touches across a gap, within the touch tolerance, keeps the gap, as its gap rate of zero says.
    False: a point would be inside, a contact would not stay on its face, to put all back would be a longer way than the
    step, or the loads would do negative work, more than it takes to bring contacts out that were a little deep. The
    placement is that of the new pose, or of the old one.
    """
    constraints, placement, position, quaternion = work.path.constraints, work.placement, path.position, path.quaternion
    way = constrain_step(setting, path, amount, work)
    moved = moved_along_twist(position, quaternion, path.twist.velocity, path.twist.spin, amount)
    end, turned = moved
    if hit.feature >= 0:
        if is_guided(work):
            _, end, turned = put_back(setting, placement, end, turned, constraints)
        constrain_features(constraints, hit.feature, hit.cage_feature, hit.angle, GAP, 0.0)
    done, end, turned = pushed_out(setting, placement, end, turned, work.path)
    strayed = way_between(moved[0], moved[1], end, turned, setting.body.reach_m)
    if done and strayed <= way + setting.tolerances.touch_m:
        total = total_load(setting.load, position, quaternion, setting.size_m)
        least = -setting.tolerances.resolution_m * total - TO_FIRST_ORDER * work_of_depths(work.contacts)
        if work_done(setting.load, position, quaternion, end, turned) >= least:
            return True, end, turned
    place_object(setting.geometry, position, quaternion, placement)
    return False, position, quaternion
