"""A travel moves the loads over what carries them: where the object begins to tip over its support, it ends."""

from __future__ import annotations

from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.vector import Vector, cross, norm, vector_from
from cagepose.kernels.collision.first_meeting import NO_HIT
from cagepose.kernels.collision.geometry import place_object
from cagepose.kernels.contact.contact_set import stays_on_face
from cagepose.kernels.contact.equilibrium import MOVES
from cagepose.kernels.contact.metric import frame_at, moved_along_twist, twist_of
from cagepose.kernels.contact.onset import onset
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.quasistatic.along_twist import Twist, stepped
from cagepose.kernels.quasistatic.on_the_way import find_touched_before, place_before
from cagepose.kernels.quasistatic.setting import Setting
from cagepose.kernels.quasistatic.workspace import QuasistaticWorkspace

TIPS = 1e-3
"""Of the speed: where the object's ends turn faster across a normal that carried, it travels no more."""
HALVINGS = 24
"""Of a travel, to where the object begins to tip."""
BEFORE_END = 4.0
"""In touch tolerances: so far before its end a travel is asked, where what it reaches does not touch yet, and what it
runs off does.
"""


@kernel
def tips(setting: Setting, position: Vector, quaternion: Quaternion, work: QuasistaticWorkspace) -> bool:
    """Whether the loads tilt, at a pose of a travel, a contact that carried at its start."""
    place_object(setting.geometry, position, quaternion, work.placement)
    frame, solver = frame_at(setting.body, quaternion), work.scratch[0].solver
    if not find_touched_before(setting, position, quaternion, frame, work):
        return False
    if onset(work.ahead, frame, setting.friction.greatest, solver) != MOVES:
        return False
    velocity, spin = twist_of(solver.y, frame)
    for i in range(work.ahead.used[0]):
        tilt = norm(cross(vector_from(work.ahead.rows[i].directions[0]), spin)) * setting.body.reach_m
        before = place_before(work.contacts, work.ahead.rows[i])
        if tilt > TIPS * norm(velocity) and before >= 0 and stays_on_face(work.contacts, before):
            return True
    return False


@kernel
def tips_on_the_way(
    setting: Setting,
    position: Vector,
    quaternion: Quaternion,
    twist: Twist,
    amount: float,
    end: tuple[Vector, Quaternion],
    work: QuasistaticWorkspace,
) -> tuple[bool, Vector, Quaternion]:
    """Return whether the object begins to tip on a travel, and where it ends then; else its end. The placement is that
    of the pose.
    """
    velocity, spin = twist.velocity, twist.spin
    low, high = 0.0, amount - BEFORE_END * setting.tolerances.touch_m / norm(velocity)
    if high > 0.0:
        last = moved_along_twist(position, quaternion, velocity, spin, high)
        if tips(setting, last[0], last[1], work):
            for _ in range(HALVINGS):
                middle = 0.5 * (low + high)
                there = moved_along_twist(position, quaternion, velocity, spin, middle)
                if tips(setting, there[0], there[1], work):
                    high = middle
                else:
                    low = middle
            place_object(setting.geometry, position, quaternion, work.placement)
            done, new_position, new_quaternion = stepped(
                setting, work.placement, work.contacts, position, quaternion, twist, high, NO_HIT, work.path
            )
            if done:
                return True, new_position, new_quaternion
        place_object(setting.geometry, end[0], end[1], work.placement)
    return False, end[0], end[1]
