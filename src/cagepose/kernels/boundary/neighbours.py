"""Which meetings are near a place: in chains of those that are in one layer across a direction, so that of ten thousand
meetings each has few to be compared with.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.vector import dot, vector_from
from cagepose.kernels.boundary.touching import SAME_PLACE, Meetings
from cagepose.kernels.native.kernel import kernel

ACROSS = (0.5291, 0.6373, 0.5603)
"""A unit vector along which few places of ordinary parts are in one layer."""
NONE = -1
"""Instead of a row: none."""


@kernel
def forget_layers(found: Meetings) -> None:
    """Begin with no meeting in any layer."""
    found.heads[:] = NONE


@kernel
def layer_of(found: Meetings, at: int, touch_m: float) -> int:
    """Return the layer that a meeting is in. What is at one place is in the same, or in one beside it."""
    return math.floor(dot(ACROSS, vector_from(found.rows[at].place)) / (SAME_PLACE * touch_m))


@kernel
def put_in_layer(found: Meetings, at: int, touch_m: float) -> None:
    """Put a meeting into its layer."""
    head = layer_of(found, at, touch_m) & (len(found.heads) - 1)
    found.behind[at] = found.heads[head]
    found.heads[head] = at


@kernel
def first_in_layer(found: Meetings, layer: int) -> int:
    """Return the first meeting of a layer, from which `Meetings.behind` leads to the next ones; -1: there is none. A
    few of other layers may be among them.
    """
    return int(found.heads[layer & (len(found.heads) - 1)])
