"""What ends a step: numbers that fall through zero along its path.

What is hit closes its gap; a contact runs over the end of a feature; the loads do no more work along the path, as
friction holds the object or it would turn back; the object begins to tip over its support.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.motion import motion_of
from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.vector import Vector, dot
from cagepose.kernels.contact.equilibrium import HELD_BY_FRICTION, MOVES, ON_THE_WAY, equilibrium
from cagepose.kernels.contact.metric import Frame, frame_at, twist_between, wrench_of
from cagepose.kernels.contact.onset import cosine, goes_on
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.quasistatic.edge_crossing import beyond_border, still_meet
from cagepose.kernels.quasistatic.first_contact import NO_HIT, Hit, Twist
from cagepose.kernels.quasistatic.path import Path, gap_of, on_faces, step_to
from cagepose.kernels.quasistatic.setting import Setting
from cagepose.kernels.quasistatic.tipping import tips
from cagepose.kernels.quasistatic.touched_before import find_touched_before
from cagepose.kernels.quasistatic.workspace import QuasistaticWorkspace

ON_ITS_PATH = 0.9
"""Cosine between a motion and that at the start of its path. One that turns by more, at once, has left it."""
GAP_CLOSES, CONTACT_ENDS, POWER_ENDS, BEGINS_TO_TIP = 0, 1, 2, 3
"""Which number a guard is: the gap of what is hit; how far a contact is from its end; the power of what is left of the
load; whether the object goes on as it began.
"""


class Guard(NamedTuple):
    """One number along a path.

    Attributes
    ----------
    kind
        Which.
    hit
        What is hit, for GAP_CLOSES.
    contact
        Which contact, for CONTACT_ENDS.
    spin_each_m
        How fast the object turned at the beginning, radians a metre, for BEGINS_TO_TIP.
    """

    kind: int
    hit: Hit
    contact: int
    spin_each_m: float


@kernel
def value_of(setting: Setting, path: Path, guard: Guard, amount: float, work: QuasistaticWorkspace) -> float:
    """Return the number of a guard after an amount of a path: above zero as long as the step goes on. Where only its
    sign is known it is infinite. For the last two kinds the placement is that of the pose there.
    """
    if guard.kind == GAP_CLOSES:
        done, end, turned = on_faces(setting, path, amount, work)
        return gap_of(setting, guard.hit, end, turned, work) if done else -math.inf
    if guard.kind == CONTACT_ENDS:
        done, end, turned = on_faces(setting, path, amount, work)
        return way_left(setting, path, guard.contact, end, turned, work) if done else -math.inf
    done, end, turned = step_to(setting, path, amount, NO_HIT, work)
    if not done:
        return math.inf
    if guard.kind == POWER_ENDS:
        return power_left(setting, end, turned, path.twist, work)[0]
    can_ask = find_touched_before(setting, end, turned, frame_at(setting.body, turned), work)
    return -math.inf if can_ask and tips(setting, turned, path.twist, guard.spin_each_m, work) else math.inf


@kernel
def way_left(
    setting: Setting, path: Path, i: int, end: Vector, turned: Quaternion, work: QuasistaticWorkspace
) -> float:
    """Return how far a contact is, at a pose of a path, from where it ends, metres, where it is one of a vertex and a
    face; else inf: its features still reach where they meet, or -inf: they do not.
    """
    geometry, placement, contacts = setting.geometry, work.placement, work.contacts
    velocity, spin = twist_between(path.position, path.quaternion, end, turned)
    motion, touch_m = motion_of(path.position, velocity, spin), setting.tolerances.touch_m
    meets = still_meet(geometry, placement, contacts, i, motion, 1.0, touch_m, 0.0)
    left = -beyond_border(geometry, placement, contacts, i, motion, 1.0, touch_m)
    if left > -math.inf and (left > 0.0) == meets:
        return left
    return math.inf if meets else -math.inf


@kernel
def power_of(wrench: FloatArray, frame: Frame, twist: Twist) -> float:
    """Return the power of a scaled wrench along a twist, watts for each amount a second."""
    force, moment = wrench_of(wrench, frame)
    return dot(force, twist.velocity) + dot(moment, twist.spin)


@kernel
def power_left(
    setting: Setting, position: Vector, quaternion: Quaternion, twist: Twist, work: QuasistaticWorkspace
) -> tuple[float, bool]:
    """Return the power, where the object is placed, of what is left of the load by what touched before the step;
    -inf: it is held there; inf: that is not known. And whether it could stay there, and goes on all the same (5.62).

    With friction what is left is not quite the motion that begins, but both vanish together.
    """
    frame = frame_at(setting.body, quaternion)
    if not find_touched_before(setting, position, quaternion, frame, work):
        return math.inf, False
    scratch, friction = work.scratch[0], setting.friction.greatest
    code = equilibrium(work.ahead, frame, friction, ON_THE_WAY, scratch.solver)
    if code == HELD_BY_FRICTION and goes_on(work.ahead, frame, friction, scratch.before, scratch.along, scratch.solver):
        power, turned = (
            power_of(scratch.along, frame, twist),
            cosine(scratch.along, scratch.before, work.ahead.n_freedoms),
        )
        return (power, True) if power > 0.0 and turned > ON_ITS_PATH else (-math.inf, False)
    if code != MOVES:
        return -math.inf if code <= HELD_BY_FRICTION else math.inf, False
    return power_of(scratch.solver.cone.passive.residual, frame, twist), False
