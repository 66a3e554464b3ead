"""Boxes around vertices that are elsewhere now."""

from __future__ import annotations

import math

from cagepose.kernels.algebra.record import Rows
from cagepose.kernels.boundary.features import Feature
from cagepose.kernels.boundary.tree import VERTICES, Node
from cagepose.kernels.native.kernel import kernel


@kernel
def refit_vertices(nodes: Rows[Node], features: Rows[Feature]) -> None:
    """Fit the boxes of a body's tree of vertices to where these are: those of leaves first, as nodes come before the
    nodes that they are divided into.
    """
    last = nodes[VERTICES].last
    for at in range(len(nodes) - 1, -1, -1):
        node = nodes[at]
        if node.first == node.last or node.last > last or node.first >= last:
            continue
        for k in range(3):
            low, high = math.inf, -math.inf
            if node.left < 0:
                for i in range(node.first, node.last):
                    reach = abs(features[i].radius)
                    low = min(low, features[i].point[k] - reach)
                    high = max(high, features[i].point[k] + reach)
            else:
                for side in range(2):
                    below = nodes[node.left if side == 0 else node.right]
                    low = min(low, below.middle[k] - below.half[k])
                    high = max(high, below.middle[k] + below.half[k])
            node.middle[k], node.half[k] = 0.5 * (low + high), 0.5 * (high - low)
