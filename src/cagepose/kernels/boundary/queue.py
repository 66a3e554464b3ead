"""Pairs of nodes of two trees that wait in the order in which they can first meet: a heap."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cagepose.kernels.algebra.record import IntArray, Rows, empty_rows
from cagepose.kernels.boundary.tree import Span
from cagepose.kernels.native.kernel import kernel

MOST_WAITING = 4096
"""Pairs of nodes at a time; of more, some are asked to the end at once."""


class Waiting:
    """Two nodes that may meet; a record.

    Attributes
    ----------
    node, cage_node
        Indices.
    begin, end
        The amounts of the motion between which their boxes may overlap.
    entry
        In row k: which row is entry k of the heap.
    """

    node: int
    cage_node: int
    begin: float
    end: float
    entry: int


class Queue(NamedTuple):
    """Pairs that wait: rows, those that are free again, and how many rows have been used, entries of the heap and free
    rows there are, (3,). In the heap none can meet earlier than entry (k - 1) // 2.
    """

    rows: Rows[Waiting]
    free: IntArray
    used: IntArray


def empty_queue(n_pairs: int = MOST_WAITING) -> Queue:
    """Return memory for so many pairs that wait (plain Python)."""
    return Queue(empty_rows(Waiting, n_pairs), np.zeros(n_pairs, np.int64), np.zeros(3, np.int64))


@kernel
def put(queue: Queue, node: int, cage_node: int, span: Span) -> bool:
    """Let a pair wait; False: there is no room."""
    if queue.used[2] > 0:
        queue.used[2] -= 1
        at = queue.free[queue.used[2]]
    elif queue.used[0] < len(queue.rows):
        at = queue.used[0]
        queue.used[0] = at + 1
    else:
        return False
    rows, entry = queue.rows, queue.used[1]
    row = rows[at]
    row.node, row.cage_node, row.begin, row.end = node, cage_node, span.begin, span.end
    queue.used[1] = entry + 1
    while entry > 0 and span.begin < rows[rows[(entry - 1) // 2].entry].begin:
        rows[entry].entry = rows[(entry - 1) // 2].entry
        entry = (entry - 1) // 2
    rows[entry].entry = at
    return True


@kernel
def take_first(queue: Queue) -> int:
    """Take the pair that can meet first out of the heap; return its row, which is free for others."""
    rows, first = queue.rows, queue.rows[0].entry
    n = queue.used[1] - 1
    queue.used[1] = n
    last, entry = rows[n].entry, 0
    while 2 * entry + 1 < n:
        child = 2 * entry + 1
        if child + 1 < n and rows[rows[child + 1].entry].begin < rows[rows[child].entry].begin:
            child += 1
        if rows[rows[child].entry].begin >= rows[last].begin:
            break
        rows[entry].entry = rows[child].entry
        entry = child
    rows[entry].entry = last
    queue.free[queue.used[2]] = first
    queue.used[2] += 1
    return int(first)
