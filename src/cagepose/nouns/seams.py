"""Bridges over the seams of an object: boxes that belong to the object where two of its boxes meet flush.

The plane between two flush boxes lies inside the object but inside neither (open) box. A cage point that runs exactly
in it, such as one sliding over a plate towards the foot of a block that stands on the plate, would pass between them.
A bridge is a box from within the one to within the other over their common area: it closes the seam and adds nothing
to the object.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np

from cagepose.nouns.checks import FloatArray

PARALLEL_COSINE = 1.0 - 1e-12
"""Faces within about 1e-6 rad of parallel can be flush: over the face of a box that is the accuracy of a drawing."""


class PlacedBox(NamedTuple):
    """A box in the object's frame: half edge lengths, centre (metres), rotation matrix."""

    half_size: FloatArray
    position: FloatArray
    rotation: FloatArray


def seam_bridges(boxes: Sequence[PlacedBox], touch_m: float) -> list[PlacedBox]:
    """Return a bridge for each pair of boxes that meet flush within ``touch_m``, and for each pair of bridges that do.

    The latter close the lines in which three or four boxes meet. Boxes turned against each other about the seam's
    normal are bridged if the face of one lies within the face of the other.
    """
    bridges = _pair_bridges(boxes, touch_m)
    return bridges + _pair_bridges(bridges, touch_m)


def _pair_bridges(boxes: Sequence[PlacedBox], touch_m: float) -> list[PlacedBox]:
    bridges = []
    for one, other in combinations(boxes, 2):
        bridge = _bridge(one, other, touch_m) or _bridge(other, one, touch_m)
        if bridge is not None:
            bridges.append(bridge)
    return bridges


def _bridge(small: PlacedBox, large: PlacedBox, touch_m: float) -> PlacedBox | None:
    """Return the bridge over the part of a face of ``small`` that lies on ``large``, in the axes of ``small``."""
    relative = small.rotation.T @ large.rotation
    offset = small.rotation.T @ (large.position - small.position)
    parallel = np.argwhere(np.abs(relative) >= PARALLEL_COSINE)
    for axis, large_axis in parallel:
        apart = abs(offset[axis]) - small.half_size[axis] - large.half_size[large_axis]
        if abs(apart) > touch_m:
            continue
        low, high = -small.half_size.copy(), small.half_size.copy()
        across = [k for k in range(3) if k != axis]
        if len(parallel) == 3:  # aligned: the common area is a rectangle
            large_half = np.abs(relative) @ large.half_size
            low[across] = np.maximum(low, offset - large_half)[across]
            high[across] = np.minimum(high, offset + large_half)[across]
            if (high - low)[across].min() <= touch_m:
                continue
        elif not _lies_within(small, large, axis, large_axis, touch_m):
            continue
        seam = np.sign(offset[axis]) * (small.half_size[axis] + apart / 2.0)
        depth = min(small.half_size[axis], large.half_size[large_axis])
        low[axis], high[axis] = seam - depth, seam + depth
        center = small.position + small.rotation @ ((low + high) / 2.0)
        return PlacedBox((high - low) / 2.0, center, small.rotation)
    return None


def _lies_within(small: PlacedBox, large: PlacedBox, axis: int, large_axis: int, touch_m: float) -> bool:
    """Whether the outline of ``small`` across ``axis`` lies within that of ``large`` across ``large_axis``."""
    first, second = (k for k in range(3) if k != axis)
    for i in (-1.0, 1.0):
        for j in (-1.0, 1.0):
            corner = np.zeros(3)
            corner[first], corner[second] = i * small.half_size[first], j * small.half_size[second]
            seen = large.rotation.T @ (small.position + small.rotation @ corner - large.position)
            beyond = np.abs(seen) - large.half_size
            if np.delete(beyond, large_axis).max() > touch_m:
                return False
    return True
