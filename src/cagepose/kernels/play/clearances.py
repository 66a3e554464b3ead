"""Which gaps limit an end of the play, and what it is worth to close or to open each of them (7.11).

At the pose that reaches the end, the limiting rows hold the slope of the value. Where more rows touch than are needed,
several sets of them could hold it: closing a gap moves the end by the most that any set lets it carry, opening it by
the least. Both are linear programs over the rows that touch, with one bound moved by one.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.least_squares import inner
from cagepose.kernels.algebra.linear_program import OPTIMAL, solve_program
from cagepose.kernels.algebra.record import Rows
from cagepose.kernels.algebra.vector import vector_from
from cagepose.kernels.collision.boxes import BoxesAndPoints
from cagepose.kernels.native.kernel import entry, kernel
from cagepose.kernels.play.extreme import Extreme
from cagepose.kernels.play.goal import Goal, write_slope
from cagepose.kernels.play.polytope import (
    START_MOTION,
    PlayWorkspace,
    gap_beyond,
    place,
    write_farthest_faces,
    write_touching_rows,
)
from cagepose.kernels.play.tolerances import LEAST_PRICE, SAME_ROW

REACH_OF_PROGRAM = 1e3
"""The programs may go so far for a bound of one. What the slope lacks of the rows, a price of 1e-9, errs so much more.
"""


class LimitingGap:
    """A gap that limits an end; a record.

    Attributes
    ----------
    pair
        Point and box; of two boxes that are flush there, the first.
    gap
        At the start, to the face that limits, lengths of the scene.
    closing, opening
        How much nearer the end comes for each length that the gap is closed, and how much farther it goes for each
        that it is opened: radians or lengths of the scene; inf: the gap cannot be closed.
    """

    pair: int
    gap: float
    closing: float
    opening: float


@kernel
def is_same_gap(one: int, other: int, work: PlayWorkspace) -> bool:
    """Whether two pairs are of one point, and faces that are flush there."""
    apart = 0.0
    for k in range(6):
        apart = max(apart, abs(work.rows[one, k] - work.rows[other, k]))
    return work.points[one] == work.points[other] and apart < SAME_ROW


@kernel
def stands_for_gap(pair: int, work: PlayWorkspace) -> bool:
    """Whether a pair touches, and no pair before it has the same gap."""
    for other in range(pair):
        if work.bounds[other] < math.inf and is_same_gap(pair, other, work):
            return False
    return bool(work.bounds[pair] < math.inf)


@kernel
def move_gap(pair: int, bound: float, work: PlayWorkspace) -> None:
    for other in range(len(work.faces)):
        if work.bounds[other] < math.inf and is_same_gap(pair, other, work):
            work.bounds[other] = bound


@kernel
def gain_of(pair: int, bound: float, work: PlayWorkspace) -> float:
    """Return how far the end moves, along the slope, when a gap is moved by one; inf: it cannot be."""
    move_gap(pair, bound, work)
    work.program.passive.used = 0
    outcome = solve_program(work.rows, work.bounds, work.program)
    move_gap(pair, 0.0, work)
    return bound * inner(work.program.objective, work.program.x, 6) if outcome == OPTIMAL else math.inf


@entry
def find_limiting_gaps(
    geometry: BoxesAndPoints, goal: Goal, extreme: Extreme, found: Rows[LimitingGap], work: PlayWorkspace
) -> int:
    """Find what limits a goal at the motion that reaches its end; return how many gaps.

    Parameters
    ----------
    geometry, goal, extreme
        As in `cagepose.kernels.play.search.find_play`; the extreme is reached.
    found
        The gaps; there is room for all pairs.
    work
        See there.
    """
    q = extreme.quaternion
    motion = (vector_from(extreme.position), (q[0], q[1], q[2], q[3]))
    write_farthest_faces(geometry, motion, work)
    write_touching_rows(geometry, motion, REACH_OF_PROGRAM, work)
    factor = write_slope(goal, motion, work.program.objective)
    n_found = 0
    for pair in range(len(work.faces)):
        if not stands_for_gap(pair, work):
            continue
        closing = gain_of(pair, -1.0, work)
        if closing > REACH_OF_PROGRAM * LEAST_PRICE:
            gap = found[n_found]
            gap.pair, gap.closing = pair, factor * closing
            gap.opening = factor * max(gain_of(pair, 1.0, work), 0.0)
            n_found += 1
    place(geometry, START_MOTION, work)
    for i in range(n_found):
        found[i].gap = gap_beyond(geometry, found[i].pair, work.faces[found[i].pair], work)
    return n_found
