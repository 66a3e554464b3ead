"""A travel moves the loads over what carries them: where the object begins to tip over its support, it ends."""

from __future__ import annotations

from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.vector import Vector, cross, minus, norm, scaled, vector_from
from cagepose.kernels.contact.contact_set import stays_on_face
from cagepose.kernels.contact.equilibrium import HELD_BY_FRICTION, HELD_WITHOUT_FRICTION, MOVES
from cagepose.kernels.contact.metric import frame_at, twist_of
from cagepose.kernels.contact.onset import goes_on, onset
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.quasistatic.first_contact import Twist
from cagepose.kernels.quasistatic.setting import Setting
from cagepose.kernels.quasistatic.touched_before import find_touched_before, place_before
from cagepose.kernels.quasistatic.workspace import QuasistaticWorkspace

TIPS = 1e-3
"""Fraction of the speed. Where the object's ends turn faster across a normal that carried, it travels no more."""
LONG, STRAIGHT = 1e-3, 0.25
"""In sizes of the scene, and in turns of a step: a longer way that turns less is asked, too, as its spin may grow."""


@kernel
def may_tip(setting: Setting, twist: Twist, amount: float) -> bool:
    """Whether a step is a travel, or so long and straight that it is asked like one."""
    turn = amount * norm(twist.spin)
    is_long = amount * norm(twist.velocity) > LONG * setting.size_m
    return turn == 0.0 or (is_long and turn <= STRAIGHT * setting.turn_step_rad)


@kernel
def find_all_carried(setting: Setting, position: Vector, quaternion: Quaternion, work: QuasistaticWorkspace) -> bool:
    """Find the contacts where the object is placed, of what touched before the step; return whether all that carried
    then touches there.
    """
    if not find_touched_before(setting, position, quaternion, frame_at(setting.body, quaternion), work):
        return False
    for i in range(work.contacts.used[0]):
        row = work.contacts.rows[i]  # a point that was added to a rim is not listed again
        if stays_on_face(work.contacts, i) and not row.is_added and place_before(work.ahead, row) < 0:
            return False
    return True


@kernel
def tips(
    setting: Setting, quaternion: Quaternion, twist: Twist, spin_each_m: float, work: QuasistaticWorkspace
) -> bool:
    """Whether, at a pose within a step, a contact that carried at its start tilts faster than twice as in the step, and
    than the object turned at its start; or the object is held there.
    """
    frame = frame_at(setting.body, quaternion)
    scratch, friction = work.scratch[0], setting.friction.greatest
    solver = scratch.solver
    code = onset(work.ahead, frame, friction, solver)
    if code == HELD_BY_FRICTION and goes_on(work.ahead, frame, friction, scratch.before, solver.y, solver):
        code = MOVES
    if code != MOVES:
        return code in (HELD_WITHOUT_FRICTION, HELD_BY_FRICTION)
    velocity, spin = twist_of(solver.y, frame)
    share = norm(velocity) / norm(twist.velocity)
    more, speed, reach_m = minus(spin, scaled(twist.spin, share)), norm(velocity), setting.body.reach_m
    known = max(TIPS * speed, share * norm(twist.spin) * reach_m, spin_each_m * speed * reach_m)
    for i in range(work.ahead.used[0]):
        tilt = norm(cross(vector_from(work.ahead.rows[i].directions[0]), more)) * reach_m
        before = place_before(work.contacts, work.ahead.rows[i])
        if before < 0 or not (stays_on_face(work.contacts, before) or work.contacts.states[before].stays_flat):
            continue
        if tilt > known:
            return True
    return False
