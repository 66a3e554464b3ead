"""Whether two features meet that reach farther than they end: what slides in a hollow edge strays beyond it on a screw.

Beyond a hollow edge a face goes on inside its body, and there a contact counts. Beyond a sharp one it does not.
"""

from __future__ import annotations

from cagepose.kernels.algebra.record import IntArray
from cagepose.kernels.algebra.vector import Vector, minus, plus, scaled
from cagepose.kernels.boundary.covered import is_covered
from cagepose.kernels.boundary.features import PlacedBoundary, in_body, position_of
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
    if not met.is_one:
        return False
    one = minus(met.place, scaled(met.normal, a.features[i].radius))
    other = plus(met.place, scaled(met.normal, met.gap + b.features[j].radius))
    if not reaches_in_hollow(a, i, met.normal, one, met.place, slack, touch_m, reach_m, waiting):
        return False
    place = plus(met.place, scaled(met.normal, met.gap))
    return reaches_in_hollow(b, j, scaled(met.normal, -1.0), other, place, slack, touch_m, reach_m, waiting)


@kernel
def reaches_in_hollow(
    body: PlacedBoundary,
    i: int,
    normal: Vector,
    core: Vector,
    place: Vector,
    slack: float,
    touch_m: float,
    reach_m: float,
    waiting: IntArray,
) -> bool:
    """Whether a feature has this outward normal at a place of its surface and is not covered there, or ends at most so
    far from there where there is material below: what slides along the other face may have strayed out of it.
    """
    if reaches(body, i, normal, core, slack, touch_m):
        return not is_covered(body, i, normal, core)
    if not reaches(body, i, normal, core, slack, reach_m):
        return False
    return is_in(body, minus(place, scaled(normal, reach_m)), touch_m, waiting)


@kernel
def is_in(body: PlacedBoundary, place: Vector, touch_m: float, waiting: IntArray) -> bool:
    """Whether a place of the world is in a body."""
    return is_solid(body.own, in_body(body, minus(place, position_of(body))), touch_m, waiting)
