"""Whether a search has come to an end: no point inside, and no way on which the value grows to first order (7.14)."""

from __future__ import annotations

import math

from cagepose.kernels.algebra.least_squares import inner
from cagepose.kernels.algebra.linear_program import OPTIMAL, solve_program
from cagepose.kernels.algebra.pose import quaternion_about, quaternion_product
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.vector import norm, plus, scaled
from cagepose.kernels.collision.boxes import BoxesAndPoints
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.play.extreme import OPEN, UNFINISHED, Extreme
from cagepose.kernels.play.goal import Goal, value_at, write_slope
from cagepose.kernels.play.polytope import (
    START_MOTION,
    Motion,
    PlayWorkspace,
    farthest_face,
    gap_at,
    gap_beyond,
    place,
    write_farthest_faces,
    write_rows,
    write_touching_rows,
    write_trust_region,
)
from cagepose.kernels.play.tolerances import (
    FIRST_RADIUS,
    GAP_OF_TOUCH,
    LEAST_PRICE,
    RESIDUAL_OF_SLOPE,
    ROUNDING_OF_TERMS,
)

RESTORING_STEPS = 3
"""So many Newton steps at the end bring the limiting points onto their faces."""


@kernel
def moved(motion: Motion, step: FloatArray) -> Motion:
    """Return the motion after a step (t, w): t is added, the turn by w comes after."""
    spin = (step[3], step[4], step[5])
    angle = norm(spin)
    position = plus(motion[0], (step[0], step[1], step[2]))
    if angle == 0.0:
        return position, motion[1]
    return position, quaternion_product(quaternion_about(scaled(spin, 1.0 / angle), angle), motion[1])


@kernel
def put_on_faces(geometry: BoxesAndPoints, motion: Motion, work: PlayWorkspace) -> Motion:
    """Take the last steps, which are of the size of rounding, so that no limiting point is left inside."""
    for _ in range(RESTORING_STEPS):
        inside = write_rows(geometry, motion, work)
        write_trust_region(work, 100.0 * inside)
        if inside == 0.0 or solve_program(work.rows, work.bounds, work.program) != OPTIMAL:
            break
        motion = moved(motion, work.program.x)
    return motion


@kernel
def find_prices(geometry: BoxesAndPoints, goal: Goal, motion: Motion, work: PlayWorkspace) -> tuple[float, float]:
    """Find the multipliers with which the rows that touch hold the value.

    Returns the factor taken out of its slope, and what the rows leave of it: the rate at which the value, as scaled,
    still grows along the best motion of size one (7.14). Zero: the pose is stationary.
    """
    write_touching_rows(geometry, motion, FIRST_RADIUS, work)
    factor = write_slope(goal, motion, work.program.objective)
    if solve_program(work.rows, work.bounds, work.program) != OPTIMAL:
        return factor, math.inf
    return factor, inner(work.program.objective, work.program.x, 6) / FIRST_RADIUS


@kernel
def change_faces(geometry: BoxesAndPoints, motion: Motion, work: PlayWorkspace) -> bool:
    """Let points stay beyond the faces that they are farther beyond than their own; True: some do.

    None changes that is inside: it may come out behind the box, or have cut its edge.
    """
    place(geometry, motion, work)
    changed = False
    for pair in range(len(work.faces)):
        best = farthest_face(geometry, pair, work)
        gap = gap_at(geometry, pair, work)
        if gap >= -ROUNDING_OF_TERMS and gap_beyond(geometry, pair, best, work) + work.spare[pair] > gap + GAP_OF_TOUCH:
            work.faces[pair] = best
            changed = True
    return changed


@kernel
def face_around_edge(geometry: BoxesAndPoints, pair: int, work: PlayWorkspace) -> int:
    """Return another face of the box at whose edge the point is; -1: it is at none, or has been turned already."""
    if work.is_turned[pair]:
        return -1
    for face in range(6):
        if face != work.faces[pair] and gap_beyond(geometry, pair, face, work) > -GAP_OF_TOUCH:
            return face
    return -1


@kernel
def turn_around_edges(geometry: BoxesAndPoints, goal: Goal, motion: Motion, work: PlayWorkspace) -> bool:
    """Let limiting points that are at edges stay beyond the other faces, one by one; True: now the value can grow.

    False: all are as they were, and so are the multipliers.
    """
    passive = work.program.passive
    for pair in range(len(work.faces)):
        work.is_turned[pair] = False
    for turn in range(len(work.faces)):
        face, turns = -1, -1
        for k in range(passive.used):
            if face < 0 and passive.labels[k] < len(work.faces) and passive.x[k] > LEAST_PRICE:
                turns = passive.labels[k]
                face = face_around_edge(geometry, turns, work)
        if face < 0:
            if turn > 0:
                write_farthest_faces(geometry, motion, work)
                find_prices(geometry, goal, motion, work)
            break
        work.faces[turns], work.is_turned[turns] = face, True
        _, rate = find_prices(geometry, goal, motion, work)
        if rate > RESIDUAL_OF_SLOPE:
            return True
    return False


@kernel
def note_extreme(goal: Goal, motion: Motion, outcome: int, extreme: Extreme) -> bool:
    """Write down a pose beyond all points and whether it is an end, REACHED or UNFINISHED; False: one is farther."""
    value, farthest = value_at(goal, motion), goal.sign * extreme.value
    if value < farthest - ROUNDING_OF_TERMS or (outcome == UNFINISHED and value <= farthest):
        return False
    extreme.outcome = outcome
    extreme.value = goal.sign * max(value, farthest)
    for k in range(3):
        extreme.position[k] = motion[0][k]
    for k in range(4):
        extreme.quaternion[k] = motion[1][k]
    return True


@kernel
def note_open(goal: Goal, extreme: Extreme) -> None:
    extreme.outcome, extreme.value = OPEN, goal.sign * math.inf


@kernel
def start_beyond_others(geometry: BoxesAndPoints, extreme: Extreme, work: PlayWorkspace) -> bool:
    """Let the points that limit an extreme start beyond other faces than there; False: each starts beyond one alone."""
    place(geometry, START_MOTION, work)
    limits, changed = extreme.limits, False
    for pair in range(len(work.faces)):
        last, work.faces[pair] = work.faces[pair], work.start_faces[pair]
        for i in range(limits.n_pairs):
            for face in range(6):
                if limits.pairs[i] == pair and face != last and gap_beyond(geometry, pair, face, work) > -GAP_OF_TOUCH:
                    work.faces[pair] = face
                    changed = True
    return changed
