"""What is known of two features where they meet: their gap, its normal and its place."""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.vector import Vector, plus, scaled
from cagepose.kernels.native.kernel import kernel

PARALLEL = 1e-7
"""Sine: lines that make a smaller angle lie side by side, and meet at their ends."""
SHARP = 1e-6
"""Fraction of the length of lines. Those of a smaller radius, if any, are told by their bounds which way is out, as
cores may be into each other by the touch tolerance. Those of a greater one are told by where they are."""
CENTRED = 1e-10
"""Fraction of radii. Nearer to the axis of a slanted wall, a ball touches it all around."""


class Meeting(NamedTuple):
    """Two features, the first of the object.

    Attributes
    ----------
    is_one
        Whether features of these kinds can touch.
    gap
        Between the rounded features; below zero: how deep, metres; inf: there is no place that is nearest.
    normal, place
        Outward unit normal of the object; the object's point of contact, in the world.
    """

    is_one: bool
    gap: float
    normal: Vector
    place: Vector


@kernel
def apart() -> Meeting:
    """Return that two features do not meet."""
    return Meeting(False, math.inf, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


@kernel
def without_normal(gap: float) -> Meeting:
    """Return that two features do not meet where they are nearest to each other, so far apart."""
    return Meeting(False, gap, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


@kernel
def swapped(met: Meeting) -> Meeting:
    """Return a meeting as the other body has it."""
    return Meeting(met.is_one, met.gap, scaled(met.normal, -1.0), plus(met.place, scaled(met.normal, met.gap)))
