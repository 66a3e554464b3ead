"""How a load changes with the pose: the Hessian of what has a potential and the symmetric part of the rest (5.28), and
the other part of that, its circulation (5.29).
"""

from __future__ import annotations

from cagepose.kernels.algebra.least_squares import WRENCH
from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.second_order import add_coupling, add_turned_arm
from cagepose.kernels.algebra.vector import Vector, cross, dot, norm, scaled, vector_from
from cagepose.kernels.contact.cardan import add_cardan_curvature, cardan_at
from cagepose.kernels.contact.loads import (
    CARDAN_MOMENT,
    DEAD_FORCE,
    DEAD_MOMENT,
    FIXED_FORCE,
    FOLLOWING_FORCE,
    SPRING,
    Action,
    PhaseLoad,
    acting,
    arm_of,
    is_idle,
    spring_vector,
)
from cagepose.kernels.contact.metric import Frame
from cagepose.kernels.native.kernel import kernel


@kernel
def way_of_point(component: int, arm: Vector, frame: Frame) -> Vector:
    """Return how a point of the object moves with one component of a scaled twist."""
    if component >= 3:
        return scaled(cross(frame.axes[component - 3], arm), 1.0 / frame.radii[component - 3])
    return (
        1.0 if component == 0 else 0.0,
        1.0 if component == 1 else 0.0,
        1.0 if component == 2 else 0.0,
    )


@kernel
def add_spring_curvature(
    action: Action, position: Vector, quaternion: Quaternion, frame: Frame, out: FloatArray
) -> None:
    """Add the Hessian of a spring's potential: of its pull at the arm that turns, and of the pull that changes."""
    arm = arm_of(action, quaternion)
    way = spring_vector(action, position, arm)
    length = norm(way)
    across = action.stiffness  # tension over length
    if action.tension_at_zero != 0.0 and length > 0.0:
        across += action.tension_at_zero / length
    add_turned_arm(scaled(way, across), arm, -1.0, frame.axes, frame.radii, out)
    along = scaled(way, 1.0 / length) if length > 0.0 else (0.0, 0.0, 0.0)
    for j in range(WRENCH):
        one = way_of_point(j, arm, frame)
        for k in range(WRENCH):
            other = way_of_point(k, arm, frame)
            out[j, k] += across * dot(one, other) + (action.stiffness - across) * dot(along, one) * dot(along, other)


@kernel
def add_load_curvature(
    load: PhaseLoad, position: Vector, quaternion: Quaternion, frame: Frame, out: FloatArray
) -> None:
    """Add what a phase's load adds to S of the part that it acts on, (6, 6): nothing for dead and following moments."""
    for which in range(len(load)):
        action = load[which]
        if is_idle(action):
            continue
        if action.kind == DEAD_FORCE:
            force, arm = vector_from(action.vector), arm_of(action, quaternion)
            add_turned_arm(force, arm, -1.0, frame.axes, frame.radii, out)
        elif action.kind == SPRING:
            add_spring_curvature(action, position, quaternion, frame, out)
        elif action.kind == FOLLOWING_FORCE or action.kind == FIXED_FORCE:
            force = acting(action, position, quaternion).force
            add_coupling(force, 0.5, frame.axes, frame.radii, out)
        elif action.kind == CARDAN_MOMENT:
            joint = cardan_at(vector_from(action.anchor), arm_of(action, quaternion))
            add_cardan_curvature(joint, vector_from(action.vector), frame, out)


@kernel
def has_potential(action: Action) -> bool:
    return action.kind == DEAD_FORCE or action.kind == SPRING or action.kind == CARDAN_MOMENT


@kernel
def has_circulation(load: PhaseLoad) -> bool:
    """Whether a part of a phase's load has no potential."""
    found = False
    for which in range(len(load)):
        found = found or not has_potential(load[which])
    return found


@kernel
def add_circulation(load: PhaseLoad, position: Vector, quaternion: Quaternion, frame: Frame, out: FloatArray) -> None:
    """Add the antisymmetric part of the load's stiffness, (6, 6): what no potential has."""
    for which in range(len(load)):
        action = load[which]
        if has_potential(action):
            continue
        one = acting(action, position, quaternion)
        # the wrench of what follows is constant in the object, that of a dead moment or a fixed force in the world
        sign = -0.5 if action.kind == DEAD_MOMENT or action.kind == FIXED_FORCE else 0.5
        for j in range(3):
            turned = cross(one.force, frame.axes[j])
            about = cross(one.moment, frame.axes[j])
            for k in range(3):
                out[k, 3 + j] += sign * turned[k] / frame.radii[j]
                out[3 + j, k] -= sign * turned[k] / frame.radii[j]
                out[3 + k, 3 + j] += sign * dot(frame.axes[k], about) / (frame.radii[k] * frame.radii[j])
