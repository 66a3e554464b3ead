"""Contacts that slide are put back on their faces: Newton's method on their gaps, the shortest way in the metric.

A screw leaves a curved constraint by the square of its length. Without this, gaps would open or close with the number
of steps.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from cagepose.kernels.algebra.dense import cholesky, remove_span, solve_lower, solve_upper
from cagepose.kernels.algebra.least_squares import WRENCH, PassiveSet, append_column, clear, inner
from cagepose.kernels.algebra.pose import Quaternion, matrix_from_quaternion
from cagepose.kernels.algebra.record import FloatArray, Rows, empty_rows
from cagepose.kernels.algebra.vector import (
    Vector,
    cross,
    minus,
    plus,
    row,
)
from cagepose.kernels.boundary.features import place_feature, place_feature_at
from cagepose.kernels.boundary.geometry import Geometry, Placement, cage_of, held_moved
from cagepose.kernels.boundary.kept import crossed, meeting_kept
from cagepose.kernels.circles.places import within_turn
from cagepose.kernels.contact.contact_set import tangents_to
from cagepose.kernels.contact.metric import (
    Body,
    Frame,
    ScaledVector,
    frame_at,
    moved_along_twist,
    twist_of,
    wrench_of,
    write_scaled_wrench,
)
from cagepose.kernels.native.kernel import kernel

ROUNDS = 12
ON_FACE, NEARLY_ON_FACE = 4e-16, 4e-13
"""In sizes of the scene: a gap that is rounding; and one that will do where rounding does not let it come nearer, as of
an object whose centre of gravity is hundreds of sizes away.
"""


DEPENDENT = 1e-5
"""Constraints that depend on others, but for such a part of their wrench, follow from them: faces of a plate without
play can be tilted by the root of rounding, and to make up for that would take long ways."""
LEAST_SLIP = 1e-10
"""Fraction of a slip squared. A motion beside that lets nothing slip is not made."""

GAP, ALONG, FIXED = 0, 1, 3
"""Which number of two features a constraint is about: their gap; (1 and 2) the way along each tangent; the gap at one
place of a circle, whether it is nearest there or not, as of a circle that lies flat."""
SAME_ANGLE = 1e-9
"""Radians. Two places of a circle that are nearer to each other are one."""


class PositionConstraint:
    """A number that shall have a given value; a record.

    Attributes
    ----------
    feature, cage_feature, angle, which
        The gap of two features, or how far they slip from now on, at an angle of a circle if one of them is one ...
    target
        ... is to be this, metres: zero for a slip.
    """

    feature: int
    cage_feature: int
    angle: float
    which: int
    target: float


class ProjectionWorkspace:
    """How many constraints there are, and scratch; a record.

    Attributes
    ----------
    used, n_stopped
        How many constraints, and motions that contacts without play stop to second order.
    may_slip_m
        How far what sticks may slip where its gaps do not close without, metres.
    stopped_forces, stopped_moments
        Those motions y have s . y = 0 with these wrenches s, about the world's origin.
    column, y, back
        One wrench, and scaled twists: the motion, and what is added to it so that little slips.
    slips
        Matrix of its least squares, and then its Cholesky factor, lower.
    basis, values
        Of the constraints that depend on no others, and what each of these lacks, metres.
    """

    used: int
    n_stopped: int
    may_slip_m: float
    stopped_forces: Annotated[FloatArray, WRENCH, 3]
    stopped_moments: Annotated[FloatArray, WRENCH, 3]
    column: ScaledVector
    y: ScaledVector
    back: ScaledVector
    slips: Annotated[FloatArray, WRENCH, WRENCH]
    basis: PassiveSet
    values: ScaledVector


class Constraints(NamedTuple):
    """Constraints 0 to scratch[0].used - 1 of ``rows`` are to hold."""

    scratch: Rows[ProjectionWorkspace]
    rows: Rows[PositionConstraint]


def empty_constraints(n_constraints: int) -> Constraints:
    """Return a workspace for ``n_constraints`` (plain Python)."""
    return Constraints(empty_rows(ProjectionWorkspace, 1), empty_rows(PositionConstraint, n_constraints))


@kernel
def constrain_features(
    constraints: Constraints, feature: int, cage_feature: int, angle: float, which: int, target: float
) -> bool:
    """Constrain the gap of two features, or their slip; False: there is no room, or it is done already."""
    n = constraints.scratch[0].used
    if n == len(constraints.rows):
        return False
    for i in range(n):
        constraint = constraints.rows[i]
        is_same = (constraint.feature, constraint.cage_feature, constraint.which) == (feature, cage_feature, which)
        if is_same and abs(within_turn(constraint.angle - angle)) <= SAME_ANGLE:
            return False
    constraint = constraints.rows[n]
    constraint.feature, constraint.cage_feature, constraint.angle = feature, cage_feature, angle
    constraint.which, constraint.target = which, target
    constraints.scratch[0].used = n + 1
    return True


@kernel
def drop_constraint(constraints: Constraints, i: int) -> None:
    """Drop a constraint; those behind it move up."""
    n = constraints.scratch[0].used - 1
    for k in range(i, n):
        constraints.rows[k] = constraints.rows[k + 1]  # type: ignore[index]
    constraints.scratch[0].used = n


class Lack(NamedTuple):
    """What a constraint lacks, metres, and the direction and the arm of a motion of the object that makes up for it."""

    value: float
    direction: Vector
    arm: Vector


@kernel
def lack(
    geometry: Geometry,
    constraint: PositionConstraint,
    position: Vector,
    quaternion: Quaternion,
    placement: Placement,
) -> Lack:
    """Return what one of the constraints lacks at a pose; inf: it means nothing there."""
    i, j, is_fixed = constraint.feature, constraint.cage_feature, constraint.which == FIXED
    moved, places = held_moved(geometry, placement), placement.memory.places
    place_feature_at(moved, i, position, matrix_from_quaternion(quaternion))
    cage = cage_of(geometry, j)
    place_feature(cage, j)
    angle, touch_m = constraint.angle, geometry.touch_m
    met = meeting_kept(moved, i, cage, j, angle, is_fixed, touch_m, places)
    arm = minus(met.place, position)
    if not met.is_one:
        return Lack(math.inf, met.normal, arm)
    if constraint.which in (GAP, FIXED):
        return Lack(met.gap - constraint.target, met.normal, arm)
    return Lack(0.0, tangents_to(met.normal)[constraint.which - ALONG], arm)


@kernel
def are_apart(geometry: Geometry, constraint: PositionConstraint, placement: Placement) -> bool:
    """Whether a constraint that means nothing is of edges that crossed: what else touches there counts."""
    held, cage = placement.moved.features[constraint.feature], geometry.placed.features[constraint.cage_feature]
    return crossed(held, cage)


@kernel
def depth_left(
    geometry: Geometry, constraints: Constraints, position: Vector, quaternion: Quaternion, placement: Placement
) -> float:
    """Return how much deeper than they should be constrained features are at a pose, at most, metres; inf: some do not
    meet any more.
    """
    deepest = 0.0
    for i in range(constraints.scratch[0].used):
        value = lack(geometry, constraints.rows[i], position, quaternion, placement).value
        deepest = max(deepest, -value if value < math.inf else math.inf)
    return deepest


@kernel
def keep_stopped(stopped: PassiveSet, position: Vector, frame: Frame, constraints: Constraints) -> None:
    """Let no projection move along what contacts without play stop: their gaps do not show it, to first order."""
    work = constraints.scratch[0]
    work.n_stopped = stopped.used
    for place in range(stopped.used):
        force, moment = wrench_of(stopped.basis[place], frame)
        moment = plus(moment, cross(position, force))
        for k in range(3):
            work.stopped_forces[place, k], work.stopped_moments[place, k] = force[k], moment[k]


@kernel
def is_slip(constraint: PositionConstraint) -> bool:
    """Whether a constraint is that two features do not slip, which lacks nothing."""
    return constraint.which not in (GAP, FIXED)


@kernel
def write_shortest(work: ProjectionWorkspace) -> None:
    """Write the shortest motion that makes up for what the constraints of the basis lack."""
    values = work.values
    for k in range(WRENCH):
        work.y[k] = 0.0
    for i in range(work.basis.used):
        for j in range(i):
            values[i] -= work.basis.triangle[i, j] * values[j]
        values[i] *= work.basis.triangle[i, i]
        for k in range(WRENCH):
            work.y[k] += values[i] * work.basis.basis[i, k]


@kernel
def add_least_slip(
    geometry: Geometry,
    constraints: Constraints,
    position: Vector,
    quaternion: Quaternion,
    frame: Frame,
    placement: Placement,
) -> bool:
    """Add to the motion that closes gaps the one beside it with which features that stick slip least, in the sense of
    least squares; False: they would by more than they may, or a slip means nothing here.

    Two points on slanted walls cannot both go straight off them. To let one not slip at all, and the other where it
    must, would take a way many times longer than the gaps.
    """
    work, rows, slipped = constraints.scratch[0], constraints.rows, 0.0
    for j in range(WRENCH):
        work.back[j] = 0.0
        for k in range(WRENCH):
            work.slips[j, k] = LEAST_SLIP if j == k else 0.0
    for i in range(work.used):
        if not is_slip(rows[i]):
            continue
        slip = lack(geometry, rows[i], position, quaternion, placement)
        if slip.value == math.inf:
            return False
        write_scaled_wrench(slip.direction, cross(slip.arm, slip.direction), frame, work.column)
        on_the_way = inner(work.column, work.y, WRENCH)
        slipped += on_the_way * on_the_way
        remove_span(work.column, work.basis)
        for j in range(WRENCH):
            work.back[j] -= on_the_way * work.column[j]
            for k in range(WRENCH):
                work.slips[j, k] += work.column[j] * work.column[k]
    if not cholesky(work.slips, 0.0, WRENCH):
        return False
    solve_lower(work.slips, work.back, work.back, WRENCH)
    slipped -= inner(work.back, work.back, WRENCH)
    solve_upper(work.slips, work.back, WRENCH)
    for k in range(WRENCH):
        work.y[k] += work.back[k]
    return slipped <= work.may_slip_m * work.may_slip_m


@kernel
def has_slips(constraints: Constraints) -> bool:
    """Whether there are constraints that features do not slip."""
    found = False
    for i in range(constraints.scratch[0].used):
        found = found or is_slip(constraints.rows[i])
    return found


@kernel
def slip_on_the_way(
    geometry: Geometry,
    constraints: Constraints,
    position: Vector,
    quaternion: Quaternion,
    frame: Frame,
    placement: Placement,
) -> float:
    """Return how far what is not to slip does in the shortest motion that makes up for gaps, metres."""
    work, slipped = constraints.scratch[0], 0.0
    for i in range(work.used):
        if is_slip(constraints.rows[i]):
            slip = lack(geometry, constraints.rows[i], position, quaternion, placement)
            write_scaled_wrench(slip.direction, cross(slip.arm, slip.direction), frame, work.column)
            on_the_way = inner(work.column, work.y, WRENCH)
            slipped += on_the_way * on_the_way
    return math.sqrt(slipped)


@kernel
def projected(
    geometry: Geometry,
    body: Body,
    position: Vector,
    quaternion: Quaternion,
    constraints: Constraints,
    size_m: float,
    may_slip: bool,
    placement: Placement,
) -> tuple[bool, Vector, Quaternion]:
    """Move the object so that all constraints hold; return (whether they do, position, quaternion).

    Those that depend on others follow from them: where they do not, that shows as a point inside the object later, or
    as what sticks slips by more than it may. Or, if it ``may_slip``, gaps alone are made to hold, and it slips as
    little as that needs.
    """
    work, rows, values = constraints.scratch[0], constraints.rows, constraints.scratch[0].values
    worst_before, slipped_m = math.inf, 0.0
    for _ in range(ROUNDS):
        frame = frame_at(body, quaternion)
        clear(work.basis, WRENCH, 1.0)
        work.basis.dependent = DEPENDENT
        for i in range(work.n_stopped):
            force = row(work.stopped_forces, i)
            moment = minus(row(work.stopped_moments, i), cross(position, force))
            write_scaled_wrench(force, moment, frame, work.column)
            values[work.basis.used] = 0.0
            append_column(work.basis, work.column, i, 0.0)
        worst, n_left_out = 0.0, 0
        n_rounds = 1 if may_slip else 2  # gaps first: what must not slip only says which way is left to close them
        for at in range(n_rounds * work.used):
            slips, i = at >= work.used, at % work.used
            if is_slip(rows[i]) != slips:
                continue
            lacks = lack(geometry, rows[i], position, quaternion, placement)
            if lacks.value == math.inf and are_apart(geometry, rows[i], placement):
                continue
            if lacks.value == math.inf:
                return False, position, quaternion
            write_scaled_wrench(lacks.direction, cross(lacks.arm, lacks.direction), frame, work.column)
            place = work.basis.used
            if append_column(work.basis, work.column, i, 0.0):
                values[place] = lacks.value
                worst = max(worst, abs(values[place]))
            elif slips:
                n_left_out += 1
        if worst <= ON_FACE * size_m or worst >= worst_before:
            return worst <= NEARLY_ON_FACE * size_m, position, quaternion
        worst_before = worst
        write_shortest(work)
        if n_left_out > 0:
            slipped_m += slip_on_the_way(geometry, constraints, position, quaternion, frame, placement)
        if slipped_m > work.may_slip_m:
            return False, position, quaternion
        if may_slip and not add_least_slip(geometry, constraints, position, quaternion, frame, placement):
            return False, position, quaternion
        velocity, spin = twist_of(work.y, frame)
        position, quaternion = moved_along_twist(position, quaternion, velocity, spin, 1.0)
    return worst_before <= NEARLY_ON_FACE * size_m, position, quaternion
