"""Play: how far the object can move inside the cage before a point would enter it, exactly.

A motion is that of the object as it stands at the start, in a frame with the cage's axes and its origin amid the cage's
points. The greatest value of what is asked for is found by linear programs in a trust region, each seen from where the
last one led (7.5), and by Newton's steps on the rows that limit them (7.6).
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.least_squares import aim, aim_at, inner, least_target
from cagepose.kernels.algebra.linear_program import OPTIMAL, renew_rows, solve_program, write_corner
from cagepose.kernels.algebra.pose import euler_zyx_from_quaternion
from cagepose.kernels.algebra.record import FloatArray, IntArray, Rows
from cagepose.kernels.algebra.vector import norm, vector_from
from cagepose.kernels.collision.boxes import BoxesAndPoints
from cagepose.kernels.native.kernel import entry, kernel
from cagepose.kernels.play.ends import (
    change_faces,
    find_prices,
    moved,
    note_extreme,
    note_open,
    put_on_faces,
    start_beyond_others,
    turn_around_edges,
)
from cagepose.kernels.play.extreme import (
    NOT_FOUND,
    OPEN,
    REACHED,
    UNFINISHED,
    Extreme,
    find_linear,
    travels_without_end,
    write_limits,
)
from cagepose.kernels.play.goal import SHIFT, Goal, value_at, write_curvature, write_slope
from cagepose.kernels.play.newton import hold_limits, hold_row, join_steps, size_of_step, write_steps
from cagepose.kernels.play.polytope import (
    START_MOTION,
    Motion,
    PlayWorkspace,
    gap_at,
    least_gap,
    place,
    write_farthest_faces,
    write_rows,
    write_start,
    write_trust_region,
)
from cagepose.kernels.play.tolerances import (
    DISTANCE_OF_ESCAPE,
    FIRST_RADIUS,
    GAP_OF_TOUCH,
    GREATEST_PITCH_RAD,
    LAST_NEWTON_STEP,
    LAST_RADIUS,
    LEAST_PRICE,
    RESIDUAL_OF_SLOPE,
    ROUNDING_OF_GAP,
    ROUNDING_OF_SUM,
    ROUNDING_OF_TERMS,
    SHORTEST_STEP,
)

MOST_PROGRAMS = 200
"""A dozen are usual, forty where curvature alone limits the motion."""


@kernel
def size_of(motion: Motion) -> float:
    """Return the size of a motion: of its travel in lengths of the scene and its turn in radians."""
    return norm(motion[0]) + 2.0 * norm((motion[1][1], motion[1][2], motion[1][3]))


@kernel
def is_out(goal: Goal, motion: Motion) -> bool:
    """Whether a search has left the range in which there is an extreme to find."""
    value = abs(value_at(goal, motion))
    if goal.kind == SHIFT:
        return value > DISTANCE_OF_ESCAPE
    pitch = euler_zyx_from_quaternion(motion[1])[1]
    return abs(pitch) > GREATEST_PITCH_RAD or value > 0.9 * math.pi


@kernel
def merit_at(geometry: BoxesAndPoints, goal: Goal, motion: Motion, penalty: float, work: PlayWorkspace) -> float:
    """Return the value less the penalty on the deepest point."""
    place(geometry, motion, work)
    return value_at(goal, motion) + penalty * min(least_gap(geometry, work), 0.0)


@kernel
def total_price(work: PlayWorkspace) -> float:
    """Return the sum of the multipliers of all gaps."""
    passive = work.program.passive
    total = 0.0
    for k in range(passive.used):
        if passive.labels[k] < len(work.faces):
            total += passive.x[k]
    return total


@kernel
def write_newton_step(
    goal: Goal, motion: Motion, factor: float, goes_on: bool, longest: float, work: PlayWorkspace
) -> bool:
    """Write Newton's step on the rows that the program leans on, and those that block it; False: it leads to no top.

    A search that goes on has just taken such a step, and stays on its rows: from beside the top, a program leans on
    rows that have no price at the top itself, and would send the search along a flat direction to meet them.
    """
    newton, objective, n_pairs = work.newton, work.program.objective, len(work.faces)
    if goes_on:
        renew_rows(work.rows, work.bounds, newton.held)
    else:
        hold_limits(work.rows, n_pairs, work.program, newton)
    is_top = False
    for _ in range(6):
        aim_at(newton.held, objective)
        aim(newton.held)
        write_curvature(goal, motion, factor, work)
        is_top = write_steps(work.bounds, objective, newton)
        blocks = join_steps(work.rows, work.bounds, n_pairs, is_top, longest, newton)
        if blocks < 0 or newton.held.used == 6 or not hold_row(work.rows, blocks, newton):
            break
    return is_top


@kernel
def moved_along_faces(geometry: BoxesAndPoints, motion: Motion, work: PlayWorkspace) -> Motion:
    """Return the motion after Newton's step, put back on the faces that the step's curvature has left.

    Without this the penalty would refuse good steps along curved limits.
    """
    newton = work.newton
    motion = moved(motion, newton.step)
    place(geometry, motion, work)
    for i in range(newton.held.used):
        pair = newton.held.labels[i]
        work.bounds[pair] = gap_at(geometry, pair, work)
    write_corner(work.bounds, newton.held, newton.onto)
    return moved(motion, newton.onto)


@kernel
def copy_faces(faces: IntArray, copy: IntArray) -> None:
    for pair in range(len(faces)):
        copy[pair] = faces[pair]


@kernel
def climb(geometry: BoxesAndPoints, goal: Goal, start: Motion, work: PlayWorkspace, extreme: Extreme) -> None:
    """Follow linear programs in a trust region to a greatest value (7.5), from a pose beyond all points.

    Where their limiting rows leave something free, Newton's step on these rows is tried too, and the better one taken.
    """
    newton, program = work.newton, work.program
    motion = last_motion = start
    radius = longest = FIRST_RADIUS  # of the program's steps, and of Newton's
    penalty, has_arrived, goes_on, turned_at = 0.0, False, False, -math.inf
    copy_faces(work.faces, work.last_faces)
    for _ in range(MOST_PROGRAMS):
        size = size_of(motion)

        # Here the search ends, unless points that limit the value here may go around edges: there it goes on, once.
        if has_arrived or radius < max(LAST_RADIUS * size, SHORTEST_STEP):
            motion = put_on_faces(geometry, motion, work)
            changed = change_faces(geometry, motion, work)
            factor, rate = find_prices(geometry, goal, motion, work)
            if least_gap(geometry, work) < -ROUNDING_OF_TERMS:
                break
            note_extreme(goal, motion, UNFINISHED, extreme)
            if rate <= RESIDUAL_OF_SLOPE and not turn_around_edges(geometry, goal, motion, work):
                if note_extreme(goal, motion, REACHED, extreme):
                    write_limits(program.passive, len(work.faces), factor, extreme.limits)
                break
            value = value_at(goal, motion)
            if (rate > RESIDUAL_OF_SLOPE and not changed) or value <= turned_at + ROUNDING_OF_TERMS:
                break
            turned_at = value
            radius = longest = FIRST_RADIUS
            penalty, has_arrived, goes_on = 0.0, False, False

        # Solve the linear program here. If no small motion brings all points out, the last step was too long, and so
        # would be any Newton step beyond the new radius.
        inside = write_rows(geometry, motion, work)
        factor = write_slope(goal, motion, program.objective)
        if inside == 0.0:
            note_extreme(goal, motion, UNFINISHED, extreme)
        if inside <= GAP_OF_TOUCH and (is_out(goal, motion) or (size > 1.0 and travels_without_end(work))):
            note_open(goal, extreme)
            break
        write_trust_region(work, radius)
        if solve_program(work.rows, work.bounds, program) != OPTIMAL:
            motion, goes_on = last_motion, False
            copy_faces(work.last_faces, work.faces)
            radius = longest = 0.25 * radius
            continue

        # Compare what it promises with what Newton's step gains, the depth of the deepest point at its price.
        value = value_at(goal, motion)
        penalty = max(penalty, 2.0 * factor * total_price(work))
        merit = value - penalty * inside
        promised = factor * inner(program.objective, program.x, 6) + penalty * inside
        is_top = write_newton_step(goal, motion, factor, goes_on, longest, work)
        newton_motion = moved_along_faces(geometry, motion, work)
        newton_gain = merit_at(geometry, goal, newton_motion, penalty, work) - merit
        newton_size = size_of_step(newton.step)
        noise = ROUNDING_OF_TERMS * abs(value) + ROUNDING_OF_SUM
        is_limited = inside <= ROUNDING_OF_GAP and least_target(newton.held) >= -LEAST_PRICE
        is_last = is_top and is_limited and newton_size < min(LAST_NEWTON_STEP * size, 0.5 * longest)
        has_arrived = is_last or max(promised, newton_gain) <= noise
        if has_arrived:
            motion = newton_motion if newton_gain > 0.0 else motion
            continue

        # Let the trust regions follow how much of its promise the program's own step keeps, and whether Newton's gains.
        linear_motion = moved(motion, program.x)
        linear_gain = merit_at(geometry, goal, linear_motion, penalty, work) - merit
        if linear_gain < 0.5 * promised:  # a parabola's top lies nearer than the step is long
            radius = 0.5 * min(radius, size_of_step(program.x))
        elif linear_gain > 0.75 * promised:
            radius = min(FIRST_RADIUS, 2.0 * radius)
        shorter = max(radius, 0.5 * min(longest, newton_size))
        longest = min(FIRST_RADIUS, 2.0 * longest) if newton_gain > 0.0 else shorter

        # Take the better of the two steps, if it is good at all.
        copy_faces(work.faces, work.last_faces)
        goes_on = newton_gain > max(linear_gain, 0.0)
        if goes_on:
            last_motion, motion = motion, newton_motion
            radius = min(FIRST_RADIUS, max(radius, newton_size))
        elif linear_gain > max(0.1 * promised, 0.0):
            last_motion, motion = motion, linear_motion
        else:
            continue
        goes_on = not change_faces(geometry, motion, work) and goes_on


@entry
def find_play(geometry: BoxesAndPoints, goals: Rows[Goal], extremes: Rows[Extreme], work: PlayWorkspace) -> None:
    """Find the linear and the exact extreme for each goal.

    Parameters
    ----------
    geometry
        Boxes as they stand at the start, and points, in the frame of the motion, lengths of the scene. That length is
        what a turn by a radian is compared with.
    goals, extremes
        What is asked for, and what is found.
    work
        See there.
    """
    write_start(geometry, work)
    for i in range(len(goals)):
        goal, extreme = goals[i], extremes[i]
        copy_faces(work.start_faces, work.faces)
        write_rows(geometry, START_MOTION, work)
        write_trust_region(work, math.inf)
        find_linear(goal, work.rows, work.bounds, work.program, extreme)
        extreme.outcome, extreme.value = NOT_FOUND, -goal.sign * math.inf
        note_extreme(goal, START_MOTION, UNFINISHED, extreme)
        if extreme.linear_outcome == OPEN and travels_without_end(work):
            note_open(goal, extreme)
            continue
        climb(geometry, goal, START_MOTION, work, extreme)
        if extreme.outcome == REACHED and start_beyond_others(geometry, extreme, work):
            climb(geometry, goal, START_MOTION, work, extreme)


@entry
def find_play_from(
    geometry: BoxesAndPoints,
    goals: Rows[Goal],
    extremes: Rows[Extreme],
    positions: FloatArray,
    quaternions: FloatArray,
    work: PlayWorkspace,
) -> None:
    """Search once more for each goal whose extreme is not as far as one of other poses beyond all points, from there.

    Parameters
    ----------
    geometry, goals, extremes, work
        As `find_play` left them.
    positions, quaternions
        The poses, (n, 3) lengths of the scene and (n, 4).
    """
    for i in range(len(goals)):
        goal, extreme = goals[i], extremes[i]
        if extreme.outcome == OPEN:
            continue
        best, farthest = START_MOTION, goal.sign * extreme.value + GAP_OF_TOUCH
        for k in range(len(positions)):
            q = quaternions[k]
            motion = vector_from(positions[k]), (q[0], q[1], q[2], q[3])
            value = value_at(goal, motion)
            if value > farthest:
                best, farthest = motion, value
        if farthest > goal.sign * extreme.value + GAP_OF_TOUCH:
            write_farthest_faces(geometry, best, work)
            climb(geometry, goal, best, work, extreme)
