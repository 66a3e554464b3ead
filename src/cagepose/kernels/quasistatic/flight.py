"""Whether an object that touches nothing gets away, equation (5.32)."""

from __future__ import annotations

from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.vector import Vector, dot, minus, norm, scaled
from cagepose.kernels.boundary.geometry import middle_of_cage_part
from cagepose.kernels.contact.loads import BENT, BOUND, STRAIGHT, drift_and_sway, flight
from cagepose.kernels.contact.metric import frame_at
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.quasistatic.setting import Setting

OUT_OF_REACH = 10.0
"""In sizes of the scene from all cage points: an object that flies on there has escaped, wherever its load turns to."""


@kernel
def nothing_ahead(setting: Setting, position: Vector, quaternion: Quaternion, velocity: Vector, spin: Vector) -> bool:
    """Whether an object that touches nothing, and begins to move with a velocity and a spin, has got away (5.32).

    Where the way of its centre of gravity is known for ever, straight or winding, no part of the cage may be met on
    it. A way that is not straight also leads away where it is out of reach and goes on. A spring with stiffness brings
    it back.
    """
    kind = flight(setting.load)
    if kind == BOUND:
        return False
    if kind != STRAIGHT and is_out_of_reach(setting, position, velocity):
        return True
    if kind == BENT:
        return False
    whole, sway = drift_and_sway(setting.load, position, quaternion, spin)
    travels = frame_at(setting.body, quaternion).travels
    drift = (travels[0] * whole[0], travels[1] * whole[1], travels[2] * whole[2])
    size = norm(drift)
    if size == 0.0:
        return False
    along = scaled(drift, 1.0 / size)
    parts = setting.geometry.cage.own.parts
    for part in range(len(parts)):
        arm = minus(middle_of_cage_part(setting.geometry, part), position)
        away = norm(minus(arm, scaled(along, max(dot(arm, along), 0.0))))
        if away <= setting.body.reach_m + sway + parts[part].reach:
            return False
    return True


@kernel
def is_out_of_reach(setting: Setting, position: Vector, velocity: Vector) -> bool:
    """Whether the object is sizes of the scene away from all of the cage, and goes away from their middle."""
    if dot(position, velocity) <= 0.0:
        return False
    parts = setting.geometry.cage.own.parts
    for part in range(len(parts)):
        away = norm(minus(middle_of_cage_part(setting.geometry, part), position)) - parts[part].reach
        if away <= OUT_OF_REACH * setting.size_m + setting.body.reach_m:
            return False
    return True
