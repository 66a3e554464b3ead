"""Features in the order of the leaves of their trees, as kernels take them: `packed`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.record import dtype_of
from cagepose.kernels.boundary.features import CIRCLE, FACE, NO_BOUNDARY, VERTEX, Bound, Boundary, Feature
from cagepose.kernels.boundary.tree import EDGES, FACES, VERTICES, Node
from cagepose.model.boundary.blocks import Block
from cagepose.model.boundary.body_parts import body_parts
from cagepose.model.boundary.covers import covers_of
from cagepose.model.checks import FloatArray
from cagepose.model.shapes import Shape

LEAF, FACES_IN_LEAF = 4, 32
"""Features in a leaf of a tree, at most; of faces more, as a vertex is asked about several of them at once."""

IntArray = NDArray[np.int64]


def packed(blocks: Sequence[Block], parts: Sequence[Shape | FloatArray], touch_m: float) -> Boundary:
    """Return features in the order of their trees' leaves, with their bounds, what covers them, and the trees."""
    rows: Any = np.concatenate([block.features for block in blocks])
    boxes, owner_of = _boxes(blocks)
    n_bounds = np.cumsum([0, *(len(block.bounds) for block in blocks)])[:-1]
    shifts = np.repeat(n_bounds, [len(block.features) for block in blocks])
    rows["first_bound"] += shifts
    rows["last_bound"] += shifts
    tree_of = np.where(rows["kind"] == VERTEX, VERTICES, np.where(rows["kind"] == FACE, FACES, EDGES))
    orders, trees, n_nodes = list[IntArray](), list[NDArray[np.void]](), 3
    first = 0
    for root in (VERTICES, EDGES, FACES):
        mine = np.flatnonzero(tree_of == root)
        order, nodes = _tree(boxes[mine], FACES_IN_LEAF if root == FACES else LEAF, first, n_nodes)
        nodes["is_rounded"][0] = (rows["radius"][mine] != 0.0).any()
        nodes["has_circles"][0] = (rows["kind"][mine] == CIRCLE).any()
        orders.append(mine[order])
        trees.append(nodes)
        first, n_nodes = first + len(mine), n_nodes + len(nodes) - 1
    order = np.concatenate(orders)
    made, every = rows[order], np.concatenate([block.bounds for block in blocks])
    bounds, made["first_bound"], made["last_bound"] = _in_order(every, made["first_bound"], made["last_bound"])
    covers: Any = covers_of(parts, boxes[order], [block.apart_from for block in blocks], owner_of[order], touch_m)
    made["first_cover"], made["last_cover"] = covers.first, covers.last
    covers.rows["first_bound"] += len(bounds)
    covers.rows["last_bound"] += len(bounds)
    heights = (made["point"] * made["direction"]).sum(axis=1) + made["radius"]
    columns = made["direction"], heights, made["least"], boxes[order].reshape(-1, 6)
    planes = np.ascontiguousarray(np.column_stack(columns).T)
    of_body = body_parts(parts)
    for index in np.nonzero(made["kind"] == VERTEX)[0].tolist():
        if isinstance(parts[made["part"][index]], np.ndarray):
            of_body["point"][made["part"][index]] = index
    every = np.concatenate([bounds, np.array(covers.bounds, dtype_of(Bound))])
    nodes = np.concatenate([*(nodes[:1] for nodes in trees), *(nodes[1:] for nodes in trees)])
    return Boundary(
        of_body,
        made.view(dtype_of(Feature)),  # arrays of records that were put together are no such any more
        every.view(dtype_of(Bound)),
        covers.rows,
        np.array(covers.indices, np.int64),
        nodes.view(dtype_of(Node)),
        planes,
    )


def nothing() -> Boundary:
    """Return the boundary of a body without parts: its trees are leaves without features."""
    _, leaf = _tree(np.zeros((0, 2, 3)), LEAF, 0, 3)
    return NO_BOUNDARY._replace(nodes=np.concatenate([leaf] * 3).view(dtype_of(Node)))


def _boxes(blocks: Sequence[Block]) -> tuple[FloatArray, IntArray]:
    """Return the boxes of all features, and in which block each is."""
    boxes = np.concatenate([block.boxes for block in blocks])
    return boxes, np.repeat(np.arange(len(blocks)), [len(block.features) for block in blocks])


def _in_order(bounds: NDArray[np.void], first: IntArray, last: IntArray) -> tuple[NDArray[np.void], IntArray, IntArray]:
    """Return bounds one range after the other, in the order of the ranges, and these anew."""
    counts = last - first
    ends = np.cumsum(counts)
    within = np.arange(int(counts.sum())) - np.repeat(ends - counts, counts)
    return bounds[np.repeat(first, counts) + within], ends - counts, ends


def _tree(boxes: FloatArray, leaf: int, first: int, n_before: int) -> tuple[IntArray, NDArray[np.void]]:
    """Return features in the order of the leaves of their tree, and its nodes, the root first: halves are made along
    the axis that the middles of boxes are most apart on, until there are at most ``leaf`` in each.

    Parameters
    ----------
    boxes
        (n, 2, 3).
    leaf
        Features in a leaf.
    first
        The number of the first feature of the tree.
    n_before
        The number of the first node below the root.
    """
    n = len(boxes)
    order, middles = np.arange(n), boxes.mean(axis=1)
    begin, end, levels = np.zeros(1, np.int64), np.full(1, n), list[NDArray[np.void]]()
    while len(begin) > 0:
        nodes: Any = np.zeros(len(begin), dtype_of(Node))
        nodes["first"], nodes["last"], nodes["left"], nodes["right"] = first + begin, first + end, -1, -1
        levels.append(nodes)
        if n == 0:
            break
        within = np.repeat(np.arange(len(begin)), end - begin)
        at = np.arange(int((end - begin).sum())) - np.repeat(np.cumsum(end - begin) - end, end - begin)
        mine = order[at]
        starts = np.flatnonzero(np.append(True, within[1:] != within[:-1]))
        low, high = np.minimum.reduceat(boxes[mine, 0], starts), np.maximum.reduceat(boxes[mine, 1], starts)
        nodes["middle"], nodes["half"] = 0.5 * (low + high), 0.5 * (high - low)
        here = middles[mine]
        apart = np.maximum.reduceat(here, starts) - np.minimum.reduceat(here, starts)
        keys = here[np.arange(len(mine)), np.argmax(apart, axis=1)[within]]
        divides = end - begin > leaf
        chosen = divides[within]
        sorted_rows = np.lexsort((keys[chosen], within[chosen]))
        order[at[chosen]] = mine[chosen][sorted_rows]
        half = (end[divides] - begin[divides]) // 2
        left = n_before + 2 * np.arange(len(half))
        nodes["left"][divides], nodes["right"][divides] = left, left + 1
        n_before += 2 * len(half)
        ends = np.stack([begin[divides], begin[divides] + half, end[divides]], axis=1)
        begin, end = ends[:, :2].ravel(), ends[:, 1:].ravel()
    return order, np.concatenate(levels)
