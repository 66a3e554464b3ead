"""Whether two features meet that reach farther than they end: what slides in a hollow edge strays beyond it on a screw.

Beyond a hollow edge a face goes on inside its body, and there a contact counts. Beyond a sharp one it does not.
"""

from __future__ import annotations

from cagepose.kernels.algebra.record import IntArray
from cagepose.kernels.algebra.vector import Vector, minus, plus, scaled
from cagepose.kernels.boundary.features import PlacedBoundary, in_body, position_of
from cagepose.kernels.boundary.meeting import both_reach
from cagepose.kernels.boundary.met import Meeting
from cagepose.kernels.boundary.reach import reaches
from cagepose.kernels.boundary.surface_end import is_solid
from cagepose.kernels.native.kernel import kernel


@kernel
def reach_in_hollow(
    a: PlacedBoundary,
    i: int,
    b: PlacedBoundary,
    j: int,
    met: Meeting,
    slack: float,
    touch_m: float,
    reach_m: float,
    waiting: IntArray,
) -> bool:
    """Whether two features can touch where they meet: to ``touch_m`` beyond their ends, or to ``reach_m`` beyond ends
    that lie in hollow edges of their bodies. ``waiting`` is memory.
    """
    if not both_reach(a, i, b, j, met, slack, reach_m):
        return False
    one = minus(met.place, scaled(met.normal, a.features[i].radius))
    other = plus(met.place, scaled(met.normal, met.gap + b.features[j].radius))
    back = scaled(met.normal, -1.0)
    if not (reaches(a, i, met.normal, one, slack, touch_m) or is_in(a, met.place, touch_m, waiting)):
        return False
    place = plus(met.place, scaled(met.normal, met.gap))
    return reaches(b, j, back, other, slack, touch_m) or is_in(b, place, touch_m, waiting)


@kernel
def is_in(body: PlacedBoundary, place: Vector, touch_m: float, waiting: IntArray) -> bool:
    """Whether a place of the world is in a body."""
    return is_solid(body.own, in_body(body, minus(place, position_of(body))), touch_m, waiting)
