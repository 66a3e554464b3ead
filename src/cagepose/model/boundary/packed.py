"""Features in the order of the leaves of their trees, as kernels take them: `packed`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.record import dtype_of
from cagepose.kernels.boundary.features import CIRCLE, FACE, NO_BOUNDARY, VERTEX, Boundary
from cagepose.kernels.boundary.tree import EDGES, FACES, VERTICES, Node
from cagepose.model.boundary.blocks import Block
from cagepose.model.boundary.body_parts import body_parts
from cagepose.model.boundary.covers import covers_of
from cagepose.model.boundary.forest import forest
from cagepose.model.boundary.record_rows import chosen, one_behind_the_other
from cagepose.model.checks import FloatArray
from cagepose.model.shapes import Shape

LEAF, FACES_IN_LEAF = 4, 32
"""Features in a leaf of a tree, at most; of faces more, as a vertex is asked about several of them at once."""

IntArray = NDArray[np.int64]


def packed(blocks: Sequence[Block], parts: Sequence[Shape | FloatArray], touch_m: float) -> Boundary:
    """Return features in the order of their trees' leaves, with their bounds, what covers them, and the trees."""
    rows = one_behind_the_other([block.features for block in blocks])
    boxes, owner_of = _boxes(blocks)
    n_bounds = np.cumsum([0, *(len(block.bounds) for block in blocks)])[:-1]
    shifts = np.repeat(n_bounds, [len(block.features) for block in blocks])
    rows["first_bound"] += shifts
    rows["last_bound"] += shifts
    kinds = rows["kind"]
    tree_of = np.where(kinds == VERTEX, VERTICES, np.where(kinds == FACE, FACES, EDGES))
    order, nodes = forest(boxes, tree_of, (LEAF, LEAF, FACES_IN_LEAF))
    nodes["is_rounded"][:3] = np.bincount(tree_of, rows["radius"] != 0.0, 3) > 0.0
    nodes["has_circles"][:3] = np.bincount(tree_of, kinds == CIRCLE, 3) > 0.0
    made, every = chosen(rows, order), one_behind_the_other([block.bounds for block in blocks])
    bounds, made["first_bound"], made["last_bound"] = _in_order(every, made["first_bound"], made["last_bound"])
    covers: Any = covers_of(parts, boxes[order], [block.apart_from for block in blocks], owner_of[order], touch_m)
    made["first_cover"], made["last_cover"] = covers.first, covers.last
    covers.rows["first_bound"] += len(bounds)
    covers.rows["last_bound"] += len(bounds)
    heights = (made["point"] * made["direction"]).sum(axis=1) + made["radius"]
    columns = made["direction"], heights, made["least"], boxes[order].reshape(-1, 6)
    planes = np.ascontiguousarray(np.column_stack(columns).T)
    of_body = body_parts(parts)
    is_point = np.array([isinstance(part, np.ndarray) for part in parts])
    points = np.flatnonzero((made["kind"] == VERTEX) & is_point[made["part"]])
    of_body["point"][made["part"][points]] = points
    return Boundary(
        of_body,
        made,
        one_behind_the_other([bounds, *covers.bounds]),
        covers.rows,
        np.array(covers.indices, np.int64),
        nodes.view(dtype_of(Node)),
        planes,
    )


def nothing() -> Boundary:
    """Return the boundary of a body without parts: its trees are leaves without features."""
    _, leaves = forest(np.zeros((0, 2, 3)), np.zeros(0, np.int64), (LEAF, LEAF, FACES_IN_LEAF))
    return NO_BOUNDARY._replace(nodes=leaves.view(dtype_of(Node)))


def _boxes(blocks: Sequence[Block]) -> tuple[FloatArray, IntArray]:
    """Return the boxes of all features, and in which block each is."""
    boxes = np.concatenate([block.boxes for block in blocks])
    return boxes, np.repeat(np.arange(len(blocks)), [len(block.features) for block in blocks])


def _in_order(bounds: NDArray[np.void], first: IntArray, last: IntArray) -> tuple[NDArray[np.void], IntArray, IntArray]:
    """Return bounds one range after the other, in the order of the ranges, and these anew."""
    counts = last - first
    ends = np.cumsum(counts)
    within = np.arange(int(counts.sum())) - np.repeat(ends - counts, counts)
    return chosen(bounds, np.repeat(first, counts) + within), ends - counts, ends
