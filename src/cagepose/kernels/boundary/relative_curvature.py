"""How the gap of two features bends where they meet: K, L and P of equations (2.9) and (2.10); see `shapes.bend`."""

from __future__ import annotations

import math

from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, plus, scaled, vector_from
from cagepose.kernels.boundary.circle import outward_at
from cagepose.kernels.boundary.features import CIRCLE, FACE, LINE, Feature
from cagepose.kernels.boundary.meeting import Meeting
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.shapes.bend import (
    NOTHING,
    Curvatures,
    Side,
    across,
    added,
    finite,
    of_crossing_edges,
    of_finite,
)

ALONG_AXIS_SINE = 1e-9
"""Between the axis of a circle and a normal: less, the circle is as straight as a line along its tangent."""


@kernel
def side_at(feature: Feature, normal: Vector, core: Vector) -> Side:
    """Return the radii of curvature of a feature that is no face, with this outward normal at a place of its core."""
    none = (0.0, 0.0, 0.0)
    if feature.kind == LINE:
        u, taper = vector_from(feature.direction), feature.taper
        if taper == 0.0:
            return Side(feature.radius, 0.0, none, True, u)
        square = 1.0 - taper * taper
        radius = feature.radius - taper * dot(u, minus(core, vector_from(feature.point))) / square
        return Side(radius, 0.0, none, True, scaled(minus(u, scaled(normal, taper)), 1.0 / math.sqrt(square)))
    if feature.kind == CIRCLE:
        outward = outward_at(feature, core)
        tangent, sine = cross(vector_from(feature.direction), outward), dot(outward, normal)
        if abs(sine) <= ALONG_AXIS_SINE:
            return Side(feature.radius, 0.0, none, True, tangent)
        return Side(feature.radius, feature.length / sine, tangent, False, none)
    return Side(feature.radius, 0.0, none, False, none)


@kernel
def relative_curvature(one: Feature, other: Feature, met: Meeting) -> Curvatures:
    """Return K, L and P where a feature of the object and one of the cage meet, both placed."""
    normal, back = met.normal, scaled(met.normal, -1.0)
    there = plus(met.place, scaled(normal, met.gap + other.radius))
    core = minus(met.place, scaled(normal, one.radius))
    if other.kind == FACE:
        return Curvatures(NOTHING, NOTHING, finite(side_at(one, normal, core), normal))
    side = side_at(other, back, there)
    if one.kind == FACE:
        parallel = added(finite(side, normal), across(normal, met.gap))
        return Curvatures(NOTHING, across(normal, 1.0), parallel)
    own = side_at(one, normal, core)
    if own.is_edge and side.is_edge:
        return of_crossing_edges(own, side, normal, met.gap)
    return of_finite(own, side, normal, met.gap)
