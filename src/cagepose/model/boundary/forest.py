"""Trees of boxes around features: `forest`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.record import dtype_of
from cagepose.kernels.boundary.tree import Node
from cagepose.model.boundary.record_rows import chosen, one_behind_the_other
from cagepose.model.checks import FloatArray

IntArray = NDArray[np.int64]


def forest(boxes: FloatArray, tree_of: IntArray, most_in_leaf: Sequence[int]) -> tuple[IntArray, NDArray[np.void]]:
    """Return features in the order of the leaves of their trees, one tree after the other, and the nodes of these: the
    roots first, then what is below each of them. Halves are made along the axis that the middles of boxes are
    most apart on, until there are few enough in each.

    Parameters
    ----------
    boxes
        Around the features, (n, 2, 3).
    tree_of
        In which tree each is, (n,).
    most_in_leaf
        Features in a leaf of each tree, at most.
    """
    n_trees, leaf = len(most_in_leaf), np.array(most_in_leaf)
    order, middles = np.argsort(tree_of, kind="stable"), boxes.mean(axis=1)
    end = np.cumsum(np.bincount(tree_of, minlength=n_trees))
    begin, tree = np.append(0, end[:-1]), np.arange(n_trees)
    levels, trees, n_nodes = list[NDArray[np.void]](), list[IntArray](), 0
    while True:
        nodes: Any = np.zeros(len(begin), dtype_of(Node))
        nodes["first"], nodes["last"], nodes["left"], nodes["right"] = begin, end, -1, -1
        levels.append(nodes)
        trees.append(tree)
        n_nodes += len(nodes)
        counts = end - begin
        starts = np.cumsum(counts) - counts
        at = np.repeat(begin - starts, counts) + np.arange(int(counts.sum()))
        mine, filled = order[at], np.flatnonzero(counts)
        if len(filled) == 0:
            break
        low, high = (
            reduce.reduceat(boxes[mine, k], starts[filled]) for k, reduce in enumerate((np.minimum, np.maximum))
        )
        nodes["middle"][filled], nodes["half"][filled] = 0.5 * (low + high), 0.5 * (high - low)
        divided = np.flatnonzero(counts > leaf[tree])
        if len(divided) == 0:
            break
        within = np.repeat(np.arange(len(begin)), counts)
        is_divided = (counts > leaf[tree])[within]
        at, within = at[is_divided], within[is_divided]
        here = middles[order[at]]
        firsts = np.cumsum(counts[divided]) - counts[divided]
        apart = np.maximum.reduceat(here, firsts) - np.minimum.reduceat(here, firsts)
        axes = np.repeat(np.argmax(apart, axis=1), counts[divided])
        order[at] = order[at][np.lexsort((here[np.arange(len(at)), axes], within))]
        left = n_nodes + 2 * np.arange(len(divided))
        nodes["left"][divided], nodes["right"][divided] = left, left + 1
        halves = np.stack([begin[divided], begin[divided] + counts[divided] // 2, end[divided]], axis=1)
        begin, end, tree = halves[:, :2].ravel(), halves[:, 1:].ravel(), np.repeat(tree[divided], 2)
    found, below = one_behind_the_other(levels), np.concatenate(trees)[n_trees:]
    by_tree = np.append(np.arange(n_trees), n_trees + np.argsort(below, kind="stable"))
    places = np.empty(len(found) + 1, np.int64)
    places[by_tree], places[-1] = np.arange(len(found)), -1
    found["left"], found["right"] = places[found["left"]], places[found["right"]]
    return order, chosen(found, by_tree)
