"""First contact of one cage point with one box while the object travels: equation (2.1).

Seen from the box the point moves along q(s) = q0 - s v. Each slab |q_k| <= h_k gives one interval of s; the point is
inside where all three meet.

Both kernels of this family (travel, turn) decide contact the same way, equation (2.5):

1. *Does it go in?* Find the first interval of the box shrunken by ``allowed_depth_m``. None: no contact. So sliding
in a
   face's plane, grazing an edge, or leaving after touching is never taken for a contact, whatever the rounding.
2. *Where does it go in?* Follow that interval back to the surface of the box itself: the gap is exactly zero there.
3. *Was it there from the start?* A point that begins within ``resolution_m`` of the box and never leaves the box
grown by
   ``resolution_m`` before going in is blocked at once: s = 0. This is the sign of the first gap rate that does not
   vanish.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.vector import Vector
from cagepose.kernels.collision.boxes import box_gap
from cagepose.kernels.native.kernel import kernel


@kernel
def slabs_interval(point_box: Vector, velocity_box: Vector, half_size: Vector, grow_m: float) -> tuple[float, float]:
    """Return the interval of s in which q0 - s v lies within the box grown by ``grow_m``; empty: (inf, -inf)."""
    start, end = -math.inf, math.inf
    for k in range(3):
        bound = half_size[k] + grow_m
        speed = velocity_box[k]
        if speed == 0.0:
            if abs(point_box[k]) >= bound:
                return math.inf, -math.inf
        else:
            one = (point_box[k] - bound) / speed
            other = (point_box[k] + bound) / speed
            start = max(start, min(one, other))
            end = min(end, max(one, other))
    if start >= end:
        return math.inf, -math.inf
    return start, end


@kernel
def travel_entry(
    point_box: Vector, velocity_box: Vector, half_size: Vector, allowed_depth_m: float, resolution_m: float
) -> float:
    """Return the distance at which the point enters the box; 0: blocked at once; inf: never.

    Parameters
    ----------
    point_box
        The cage point at the start, in the box's frame, metres.
    velocity_box
        Direction in which the object travels, in the box's frame, unit vector.
    half_size
        Half edge lengths, metres.
    allowed_depth_m, resolution_m
        See equation (2.5) above; metres.
    """
    inner_start, inner_end = slabs_interval(point_box, velocity_box, half_size, -allowed_depth_m)
    if inner_end <= 0.0:
        return math.inf
    if box_gap(point_box, half_size) <= resolution_m:
        outer_start, _ = slabs_interval(point_box, velocity_box, half_size, resolution_m)
        if outer_start <= 0.0:
            return 0.0
    start, _ = slabs_interval(point_box, velocity_box, half_size, 0.0)
    return max(0.0, min(start, inner_start))
