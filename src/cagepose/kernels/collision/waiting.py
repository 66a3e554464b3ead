"""Pairs of parts and of features that may touch on the way, in the order in which they first can: a heap."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cagepose.kernels.algebra.record import IntArray, Rows, empty_rows
from cagepose.kernels.native.kernel import kernel

MOST_WAITING = 4096
"""Pairs of features; of more, some are asked to the end at once."""


class Waiting:
    """Two features that may touch, or two parts whose features have not been looked at; a record.

    Attributes
    ----------
    part, cage_part, feature, cage_feature
        Indices; features -1: two parts.
    earliest, until
        The amounts of the motion before which they do not touch, and after which their parts are past each other.
    is_seen
        Whether it is known how far apart they are now.
    is_near
        Whether they are so near to each other now that they may touch, or leave each other.
    of_arc
        Whether all of an arc is followed: they and their `second_pair`.
    n_advances, behind
        How many steps have been made, and how far behind the next root the search goes on.
    heap, near
        In row k: index of entry k of the heap, and of those that are near.
    """

    part: int
    cage_part: int
    feature: int
    cage_feature: int
    earliest: float
    until: float
    is_seen: bool
    is_near: bool
    of_arc: bool
    n_advances: int
    behind: float
    heap: int
    near: int


class Queue(NamedTuple):
    """Pairs that wait.

    Attributes
    ----------
    rows
        The pairs, and in `Waiting.heap` those that are apart: none can touch earlier than that of entry (k - 1) // 2.
    used
        How many rows, entries of the heap and near ones there are, (3,).
    """

    rows: Rows[Waiting]
    used: IntArray


def empty_queue(n_pairs: int) -> Queue:
    """Return memory for pairs that wait, of so many pairs of parts (plain Python)."""
    return Queue(empty_rows(Waiting, n_pairs + MOST_WAITING), np.zeros(3, np.int64))


@kernel
def write_waiting(
    one: int, other: int, i: int, j: int, earliest: float, until: float, is_seen: bool, is_near: bool, row: Waiting
) -> None:
    """Write a pair that waits."""
    row.part, row.cage_part, row.feature, row.cage_feature = one, other, i, j
    row.earliest, row.until, row.is_seen = earliest, until, is_seen
    row.is_near, row.of_arc, row.n_advances, row.behind = is_near, False, 0, 0.0


@kernel
def keep_last(queue: Queue) -> None:
    """Let the row behind those in use wait."""
    rows, at = queue.rows, queue.used[0]
    queue.used[0] += 1
    if rows[at].is_near:
        note_near(queue, at)
        return
    entry = queue.used[1]
    queue.used[1] += 1
    while entry > 0 and rows[at].earliest < rows[rows[(entry - 1) // 2].heap].earliest:
        rows[entry].heap = rows[(entry - 1) // 2].heap
        entry = (entry - 1) // 2
    rows[entry].heap = at


@kernel
def note_near(queue: Queue, at: int) -> None:
    """Let a pair that is near wait."""
    queue.rows[queue.used[2]].near = at
    queue.used[2] += 1


@kernel
def drop_first(queue: Queue) -> None:
    """Take the pair that can touch first out of the heap."""
    queue.used[1] -= 1
    queue.rows[0].heap = queue.rows[queue.used[1]].heap
    settle_first(queue)


@kernel
def settle_first(queue: Queue) -> None:
    """Bring the first pair of the heap, which can touch later than it could, to its place."""
    rows, n, entry = queue.rows, queue.used[1], 0
    at = rows[0].heap
    while 2 * entry + 1 < n:
        child = 2 * entry + 1
        if child + 1 < n and rows[rows[child + 1].heap].earliest < rows[rows[child].heap].earliest:
            child += 1
        if rows[rows[child].heap].earliest >= rows[at].earliest:
            break
        rows[entry].heap = rows[child].heap
        entry = child
    rows[entry].heap = at
