"""Friction can bring the object to rest within a step: the first pose that it holds."""

from __future__ import annotations

from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.vector import Vector
from cagepose.kernels.boundary.geometry import place_object
from cagepose.kernels.contact.equilibrium import HELD_BY_FRICTION, ON_THE_WAY, equilibrium
from cagepose.kernels.contact.metric import frame_at
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.quasistatic.first_contact import Twist
from cagepose.kernels.quasistatic.on_the_way import find_touched_before, stepped_from
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
    if not find_touched_before(setting, position, quaternion, frame, work):
        return False
    solver, greatest = work.scratch[0].solver, setting.friction.greatest
    return equilibrium(work.ahead, frame, greatest, ON_THE_WAY, solver) <= HELD_BY_FRICTION


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
        done, new_position, new_quaternion = stepped_from(setting, position, quaternion, twist, middle, work)
        if done and is_held_on_the_way(setting, new_position, new_quaternion, work):
            high = middle
            best = (new_position, new_quaternion)
        else:
            low = middle
    place_object(setting.geometry, best[0], best[1], work.placement)
    return best
