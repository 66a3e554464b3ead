"""Play: how far the object can move inside the cage before a point would enter it, exactly.

The motion M = (t, R) is that of the object as it stands at the start, in a frame with the cage's axes and its origin
amid the cage's points. The greatest value of what is asked for is found by linear programs in a trust region, each seen
from where the last one led (7.5).
"""

from __future__ import annotations

import math
from typing import Annotated

from cagepose.kernels.algebra.linear_program import OPTIMAL, UNBOUNDED, ProgramRoom, come_near, solve_program
from cagepose.kernels.algebra.pose import Quaternion, euler_zyx_from_quaternion, quaternion_about, quaternion_product
from cagepose.kernels.algebra.record import FloatArray, IntArray, Rows
from cagepose.kernels.algebra.vector import Vector, norm, scaled
from cagepose.kernels.collision.geometry import Geometry, place_object
from cagepose.kernels.native.kernel import entry, kernel
from cagepose.kernels.play.goal import SHIFT, Goal, value_at, write_curvature, write_slope
from cagepose.kernels.play.newton import (
    find_prices,
    join_steps,
    newton_step,
    size_of_step,
    take_row,
    take_rows,
    write_onto,
)
from cagepose.kernels.play.rows import (
    HARDLY,
    NOT_BEYOND,
    START,
    PlayRoom,
    change_faces,
    gap_at,
    least_gap,
    write_rows,
    write_start,
    write_trust_region,
)

REACHED, OPEN, NOT_FOUND = range(3)
FIRST_RADIUS = 0.3
"""Radians, and lengths of the scene: the linear rows say little beyond."""
LAST_RADIUS = 1e-6
"""Of the motion: the value errs by the square of this."""
SHORTEST = 1e-9
"""Radians, and lengths of the scene: where no step of this size can be taken, none is left."""
LAST_STEP = 1e-7
"""Of the motion: a Newton step that is shorter has arrived; the value errs by the square of this."""
MOST_PROGRAMS = 200
"""A dozen are usual, forty where curvature alone limits the motion."""
GAIN = 1e-12
"""A program that promises less than this fraction of the value has nothing left to find."""
STEEPEST = 1.55
"""Radians. Pitch beyond is next to the pole of the angles; where it can go there, it has no extreme."""
FARTHEST = 20.0
"""Lengths of the scene. Whoever gets so far is out."""
RESTORING = 3
"""Newton steps at the end that bring the limiting points onto their faces."""


class Extreme:
    """One end of the play; a record.

    Attributes
    ----------
    linear_outcome, outcome
        REACHED, OPEN (no end), or NOT_FOUND.
    linear, value
        By the linear program at the start, and exactly; radians or metres.
    position, quaternion
        The motion that reaches the exact one.
    n_limits, limits, prices
        Which points with which boxes limit it, as ``point * n_boxes + box``, and how much the value gains for each
        metre that such a gap grows.
    n_programs
        How many were solved.
    """

    linear_outcome: int
    linear: float
    outcome: int
    value: float
    position: Annotated[FloatArray, 3]
    quaternion: Annotated[FloatArray, 4]
    prices: Annotated[FloatArray, 6]
    limits: Annotated[IntArray, 6]
    n_limits: int
    n_programs: int


@kernel
def moved(position: Vector, quaternion: Quaternion, step: FloatArray, length_m: float) -> tuple[Vector, Quaternion]:
    """Return the motion after a step (t / L, w): t is added, the turn by w comes after."""
    spin = (step[3], step[4], step[5])
    angle = norm(spin)
    new_position = (
        position[0] + length_m * step[0],
        position[1] + length_m * step[1],
        position[2] + length_m * step[2],
    )
    if angle == 0.0:
        return new_position, quaternion
    return new_position, quaternion_product(quaternion_about(scaled(spin, 1.0 / angle), angle), quaternion)


@kernel
def promised(program: ProgramRoom) -> float:
    """Return f . x of the program's solution."""
    gain = 0.0
    for k in range(6):
        gain += program.objective[k] * program.x_near[k]
    return gain


@kernel
def total_price(room: PlayRoom) -> float:
    """Return the sum of the multipliers of all gaps."""
    total = 0.0
    for k in range(6):
        if room.program.basis[k] < len(room.faces):
            total += max(room.program.multipliers[k], 0.0)
    return total


@kernel
def note_limits(room: PlayRoom, factor: float, extreme: Extreme) -> None:
    """Write which pairs limit the extreme, and the prices of their gaps."""
    extreme.n_limits = 0
    for i in range(room.newton.n_rows):
        pair = room.newton.pairs[i]
        if room.newton.prices[i] > HARDLY:
            extreme.limits[extreme.n_limits] = pair
            extreme.prices[extreme.n_limits] = factor * room.newton.prices[i]
            extreme.n_limits += 1


@kernel
def solve_linear(length_m: float, goal: Goal, room: PlayRoom, extreme: Extreme) -> None:
    """Find the greatest value over the polytope (7.1) of the start."""
    unit = length_m if goal.kind == SHIFT else 1.0
    write_trust_region(room, math.inf)
    factor = write_slope(goal, (1.0, 0.0, 0.0, 0.0), length_m, room)
    room.program.basis[0] = -1
    outcome = solve_program(room.rows, room.bounds, room.program)
    extreme.linear = goal.sign * math.inf
    extreme.linear_outcome = OPEN
    if outcome == OPTIMAL:
        come_near(room.rows, room.bounds, room.program)
        extreme.linear = goal.sign * unit * factor * promised(room.program)
        extreme.linear_outcome = REACHED
    elif outcome != UNBOUNDED:
        extreme.linear_outcome = NOT_FOUND


@kernel
def travels_without_end(program: ProgramRoom) -> bool:
    """Whether an unbounded program grows by a translation alone: then no point is in the way, exactly."""
    turning, travelling = 0.0, 0.0
    for k in range(3):
        travelling += program.objective[k] * program.x_far[k]
        turning = max(turning, abs(program.x_far[3 + k]))
    return travelling > NOT_BEYOND and turning <= NOT_BEYOND


@kernel
def is_out(goal: Goal, value: float, quaternion: Quaternion, length_m: float) -> bool:
    """Whether a search has left the range in which there is an extreme to find."""
    if goal.kind == SHIFT:
        return abs(value) > FARTHEST * length_m
    pitch = euler_zyx_from_quaternion(quaternion)[1]
    return abs(pitch) > STEEPEST or abs(value) > 0.9 * math.pi


@kernel
def note_extreme(
    goal: Goal, length_m: float, position: Vector, quaternion: Quaternion, room: PlayRoom, extreme: Extreme
) -> None:
    """Write down where a search has come to, unless it has been farther."""
    value = value_at(goal, position, quaternion)
    if extreme.outcome == REACHED and goal.sign * extreme.value >= value:
        return
    extreme.outcome = REACHED
    extreme.value = goal.sign * value
    for k in range(3):
        extreme.position[k] = position[k]
    for k in range(4):
        extreme.quaternion[k] = quaternion[k]
    factor = write_slope(goal, quaternion, length_m, room)
    note_limits(room, factor if goal.kind == SHIFT else factor / length_m, extreme)


@kernel
def write_newton_step(goal: Goal, quaternion: Quaternion, length_m: float, factor: float, room: PlayRoom) -> bool:
    """Write Newton's step on the rows that the program leans on, and those that block it; False: it leads to no top."""
    newton = room.newton
    take_rows(room.rows, room.bounds, len(room.faces), room.program, newton)
    is_top = False
    for _ in range(6):
        find_prices(room.program, newton)
        write_curvature(goal, quaternion, length_m, factor, room)
        is_top = newton_step(room.program, newton)
        blocks = join_steps(room.rows, room.bounds, len(room.faces), is_top, FIRST_RADIUS, newton)
        if blocks < 0 or newton.n_rows == 6:
            break
        take_row(room.rows, room.bounds, blocks, newton)
    return is_top


@kernel
def moved_along_faces(
    geometry: Geometry, length_m: float, position: Vector, quaternion: Quaternion, room: PlayRoom
) -> tuple[Vector, Quaternion]:
    """Return the motion after Newton's step, put back on the faces that the step's curvature has left.

    Without this the penalty would refuse good steps along curved limits.
    """
    newton = room.newton
    position, quaternion = moved(position, quaternion, newton.step, length_m)
    place_object(geometry, position, quaternion, room.placement)
    for i in range(newton.n_rows):
        point, box = newton.pairs[i] // geometry.n_own_boxes, newton.pairs[i] % geometry.n_own_boxes
        newton.bounds[i] = gap_at(geometry, length_m, point, box, room)
    write_onto(newton)
    return moved(position, quaternion, newton.onto, length_m)


@kernel
def merit_at(
    geometry: Geometry,
    length_m: float,
    goal: Goal,
    position: Vector,
    quaternion: Quaternion,
    penalty: float,
    room: PlayRoom,
) -> float:
    """Return the value less the penalty on the deepest point; lengths of the scene, or radians."""
    place_object(geometry, position, quaternion, room.placement)
    inside = max(0.0, -least_gap(geometry, length_m, room))
    unit = length_m if goal.kind == SHIFT else 1.0
    return value_at(goal, position, quaternion) / unit - penalty * inside


@kernel
def climb(geometry: Geometry, length_m: float, goal: Goal, room: PlayRoom, extreme: Extreme) -> None:
    """Follow linear programs in a trust region to a greatest value (7.5), from the start.

    Where their limiting rows leave something free, Newton's step on these rows is tried too, and the better one taken.
    Where the points that limit an extreme have run off their faces, the search goes on beyond the others.
    """
    unit = length_m if goal.kind == SHIFT else 1.0
    position, quaternion = START, (1.0, 0.0, 0.0, 0.0)
    last_position, last_quaternion = position, quaternion
    radius, longest, penalty = FIRST_RADIUS, FIRST_RADIUS, 0.0
    extreme.outcome = NOT_FOUND
    has_arrived = False
    for n_programs in range(MOST_PROGRAMS):
        extreme.n_programs = n_programs + 1
        size = size_of(position, quaternion, length_m)
        if has_arrived or radius < max(LAST_RADIUS * size, SHORTEST):
            position, quaternion = put_on_faces(geometry, length_m, position, quaternion, room)
            note_extreme(goal, length_m, position, quaternion, room, extreme)
            if not change_faces(geometry, length_m, room):
                break
            radius, longest, penalty, has_arrived = FIRST_RADIUS, FIRST_RADIUS, 0.0, False
        place_object(geometry, position, quaternion, room.placement)
        inside = max(0.0, -write_rows(geometry, position, length_m, room))
        value = value_at(goal, position, quaternion)
        factor = write_slope(goal, quaternion, length_m, room)
        write_trust_region(room, radius)
        if solve_program(room.rows, room.bounds, room.program) != OPTIMAL:
            # The last step led to where no small motion brings all points out: take a shorter one.
            room.program.basis[0] = -1
            position, quaternion = last_position, last_quaternion
            radius *= 0.25
            longest = radius
            continue
        penalty = max(penalty, 2.0 * factor * total_price(room))
        is_top = write_newton_step(goal, quaternion, length_m, factor, room)
        gain = factor * promised(room.program) + penalty * inside
        merit = value / unit - penalty * inside
        noise = GAIN * abs(value) / unit + 1e-15
        by_newton = moved_along_faces(geometry, length_m, position, quaternion, room)
        more = merit_at(geometry, length_m, goal, by_newton[0], by_newton[1], penalty, room) - merit
        has_arrived = (is_top and size_of_step(room.newton.step) < LAST_STEP * size) or max(gain, more) <= noise
        if has_arrived:
            continue
        to_position, to_quaternion = moved(position, quaternion, room.program.x_near, length_m)
        gained = merit_at(geometry, length_m, goal, to_position, to_quaternion, penalty, room) - merit
        if gained < 0.5 * gain:  # a parabola's top lies nearer than the step is long
            radius = 0.5 * min(radius, size_of_step(room.program.x_near))
        elif gained > 0.75 * gain:
            radius = min(FIRST_RADIUS, 2.0 * radius)
        takes = gained > max(0.1 * gain, 0.0)
        if more > max(gained, 0.0) and size_of_step(room.newton.step) <= longest:
            to_position, to_quaternion = by_newton
            takes = True
            radius = min(FIRST_RADIUS, max(radius, size_of_step(room.newton.step)))
        if takes:
            last_position, last_quaternion = position, quaternion
            position, quaternion = to_position, to_quaternion
            if is_out(goal, value_at(goal, position, quaternion), quaternion, length_m):
                extreme.outcome = OPEN
                break


@kernel
def size_of(position: Vector, quaternion: Quaternion, length_m: float) -> float:
    """Return the size of a motion: of its travel in lengths of the scene and its turn in radians."""
    return norm(position) / length_m + 2.0 * norm((quaternion[1], quaternion[2], quaternion[3]))


@kernel
def put_on_faces(
    geometry: Geometry, length_m: float, position: Vector, quaternion: Quaternion, room: PlayRoom
) -> tuple[Vector, Quaternion]:
    """Take the last steps, which are of the size of rounding, so that no limiting point is left inside."""
    for _ in range(RESTORING):
        place_object(geometry, position, quaternion, room.placement)
        inside = max(0.0, -write_rows(geometry, position, length_m, room))
        write_trust_region(room, 100.0 * inside)
        if inside == 0.0 or solve_program(room.rows, room.bounds, room.program) != OPTIMAL:
            break
        position, quaternion = moved(position, quaternion, room.program.x_near, length_m)
    return position, quaternion


@entry
def find_play(geometry: Geometry, length_m: float, goals: Rows[Goal], extremes: Rows[Extreme], room: PlayRoom) -> None:
    """Find the linear and the exact extreme for each goal.

    Parameters
    ----------
    geometry
        Boxes as they stand at the start, points and boxes in the frame of the motion.
    length_m
        The scene's length: what a turn by a radian is compared with.
    goals, extremes
        What is asked for, and what is found.
    room
        See there.
    """
    write_start(geometry, length_m, room)
    for i in range(len(goals)):
        goal, extreme = goals[i], extremes[i]
        for pair in range(len(room.faces)):
            room.faces[pair] = room.start_faces[pair]
        place_object(geometry, START, (1.0, 0.0, 0.0, 0.0), room.placement)
        write_rows(geometry, START, length_m, room)
        solve_linear(length_m, goal, room, extreme)
        if extreme.linear_outcome == OPEN and travels_without_end(room.program):
            extreme.outcome, extreme.value = OPEN, extreme.linear
        else:
            climb(geometry, length_m, goal, room, extreme)
        if extreme.outcome == OPEN:
            extreme.value = goal.sign * math.inf
