"""Friction can bring the object to rest within a step, or turn it back: where the loads do no more work along it.

That is one number, the power of what the contacts leave of the load along the step. It is zero where they hold the
object, and below zero where the step has gone too far: past a balance at the limit of friction, or over a kink.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.vector import Vector, dot, transposed_times
from cagepose.kernels.boundary.geometry import place_object
from cagepose.kernels.contact.equilibrium import HELD_BY_FRICTION, MOVES, ON_THE_WAY, equilibrium
from cagepose.kernels.contact.metric import Frame, frame_at
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.quasistatic.first_contact import Twist
from cagepose.kernels.quasistatic.on_the_way import find_touched_before, stepped_from
from cagepose.kernels.quasistatic.setting import Setting
from cagepose.kernels.quasistatic.workspace import QuasistaticWorkspace

TRIALS = 60
"""How many poses of a step are asked at most to find the first rest, to rounding."""
TURNED_BACK = 0.1
"""Share of the power at the start of a step. A step to a balance that goes too far by less is as good."""


@kernel
def power_of(wrench: FloatArray, frame: Frame, twist: Twist) -> float:
    """Return the power of a scaled wrench along a twist, watts for each amount a second."""
    radii = frame.radii
    moment = transposed_times(frame.axes, (radii[0] * wrench[3], radii[1] * wrench[4], radii[2] * wrench[5]))
    return dot((wrench[0], wrench[1], wrench[2]), twist.velocity) + dot(moment, twist.spin)


@kernel
def power_left(
    setting: Setting, position: Vector, quaternion: Quaternion, twist: Twist, work: QuasistaticWorkspace
) -> float:
    """Return the power, at a pose of a step, of what is left of the load by what touched before it, watts for each
    amount a second; zero: it is held there; inf: that is not known.

    What the step reaches does not count: it touches at the end only, and what it holds is asked there.
    """
    frame = frame_at(setting.body, quaternion)
    if not find_touched_before(setting, position, quaternion, frame, work):
        return math.inf
    solver = work.scratch[0].solver
    code = equilibrium(work.ahead, frame, setting.friction.greatest, ON_THE_WAY, solver)
    if code != MOVES:
        return 0.0 if code <= HELD_BY_FRICTION else math.inf
    return power_of(solver.cone.passive.residual, frame, twist)


@kernel
def ends_before(power: float, begun: float) -> bool:
    """Whether a step that begins with one power goes too far, or to where the object is held, as it has another then."""
    return power == 0.0 or power < -TURNED_BACK * begun


@kernel
def first_rest(
    setting: Setting,
    position: Vector,
    quaternion: Quaternion,
    twist: Twist,
    amount: float,
    power: float,
    end: tuple[Vector, Quaternion],
    work: QuasistaticWorkspace,
) -> tuple[Vector, Quaternion]:
    """Return the first pose of a step that is held, or after which the power is below zero, as it is at the end, after
    ``amount``. The placement is that of the pose.

    What forces in their cones leave of a load is not quite the motion that begins, with friction: where it has no power
    along the step at its start, it says nothing about the end.
    """
    low, high, at_low, at_high = 0.0, amount, math.inf, power
    best = end
    if at_high < 0.0:
        place_object(setting.geometry, position, quaternion, work.placement)
        at_low = power_left(setting, position, quaternion, twist, work)
    for _ in range(TRIALS if at_low > 0.0 else 0):
        middle = 0.5 * (low + high)
        if at_high < 0.0 and at_low < math.inf:  # by false position (Illinois)
            middle = low + (high - low) * at_low / (at_low - at_high)
        if not low < middle < high:
            break
        done, there, turned = stepped_from(setting, position, quaternion, twist, middle, work)
        power = power_left(setting, there, turned, twist, work) if done else math.inf
        if power > 0.0:
            low, at_low, at_high = middle, power, 0.5 * at_high
        else:
            high, at_high, at_low = middle, power, 0.5 * at_low
            best = (there, turned)
    place_object(setting.geometry, best[0], best[1], work.placement)
    return best
