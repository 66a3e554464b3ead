"""Whether the surface of a body ends near a place of a face, as it does not at a seam or a hollow edge."""

from __future__ import annotations

import math

from cagepose.kernels.algebra.record import IntArray
from cagepose.kernels.algebra.tolerances import PROBE
from cagepose.kernels.algebra.vector import Vector, cross, minus, norm, plus, scaled, vector_from
from cagepose.kernels.boundary.features import Boundary, PlacedBoundary, seen_from_feature
from cagepose.kernels.boundary.reach import beyond_borders
from cagepose.kernels.boundary.within import is_within
from cagepose.kernels.native.kernel import kernel

PROBES_AROUND, PROBE_SLACK = 8, 0.1
"""Places around one that are asked whether there is material below the face; and, in touch tolerances, how near to
borders that may be told."""
TURNED = 0.3
"""Radians. By so much the first of these is turned from an axis of the body, along which borders lead."""


@kernel
def ends_near(body: PlacedBoundary, i: int, place: Vector, touch_m: float, waiting: IntArray) -> bool:
    """Whether the surface ends within the touch tolerance of a place of face i, in the world: beside it and below the
    face there is no material then.
    """
    own, seen = body.own, seen_from_feature(body, i, place)
    if beyond_borders(own, i, seen, math.inf) <= -touch_m:
        return False
    at, normal = plus(vector_from(own.features[i].point), seen), vector_from(own.features[i].direction)
    one = across(normal)
    other, found = cross(normal, one), False
    for k in range(PROBES_AROUND):
        angle = TURNED + 2.0 * math.pi * k / PROBES_AROUND
        aside = plus(scaled(one, math.cos(angle)), scaled(other, math.sin(angle)))
        probe = plus(at, scaled(minus(aside, normal), PROBE * touch_m))
        found = found or not is_solid(own, probe, touch_m, waiting)
    return found


@kernel
def is_solid(own: Boundary, place: Vector, touch_m: float, waiting: IntArray) -> bool:
    """Whether a place near borders, in the frame of the body, is in it."""
    return is_within(own, place, PROBE_SLACK * touch_m, waiting)


@kernel
def across(normal: Vector) -> Vector:
    """Return a unit vector across a normal, towards the axis that is farthest from it."""
    x, y, z = abs(normal[0]), abs(normal[1]), abs(normal[2])
    axis = (1.0, 0.0, 0.0) if x <= min(y, z) else (0.0, 1.0, 0.0) if y <= z else (0.0, 0.0, 1.0)
    way = cross(normal, axis)
    return scaled(way, 1.0 / norm(way))
