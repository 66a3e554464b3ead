"""Curves on the surface of a body: its sharp edges, one generator of each round side, and one circle across each tube.

Where the surfaces of two solids cross in a curve, it crosses a strand of one of them, or lies within a smooth dent.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.vector import Matrix, Vector, cross, dot, minus, norm, plus, scaled, times, vector_from
from cagepose.kernels.boundary.chart import is_trimmed
from cagepose.kernels.boundary.circle import WHOLE_TURN, circle_of
from cagepose.kernels.boundary.features import CIRCLE, Boundary, Feature
from cagepose.kernels.boundary.surfaces import out_of_axis, slant_of_side
from cagepose.kernels.circles.places import Circle, on_circle
from cagepose.kernels.native.kernel import kernel

GENERATOR = 0.7548
"""Turn of a generator from the side's own direction across its axis, as cosine: little of ordinary parts lies there."""
ACROSS_TUBE = 0.3774
"""Of the way along a circle: there the one leads across the tube around it."""


class Frame(NamedTuple):
    """The frame of one body as another one has it: its origin, metres, and its axes as columns."""

    origin: Vector
    rotation: Matrix


class Strand(NamedTuple):
    """A straight line or an arc on the surface of a body, in the frame of another one.

    Attributes
    ----------
    is_arc, is_closed, is_generator
        Whether it is one; closed: a whole circle; a generator: of a round side, or what leads across a tube.
    point, way, toward
        Of a line its start and its direction; of an arc centre, axis, and what angles are measured from.
    radius
        Of an arc, metres.
    begin, end
        Metres along a line, radians along an arc.
    inward
        Of a line: unit vector into the material, midway between its faces.
    middle
        Of an arc: the middle of the angles of its normals, radians.
    sine
        Of half the angle of the material: what is one metre inward is so far from both faces.
    """

    is_arc: bool
    is_closed: bool
    is_generator: bool
    point: Vector
    way: Vector
    toward: Vector
    radius: float
    begin: float
    end: float
    inward: Vector
    middle: float
    sine: float


@kernel
def seen_in(frame: Frame, place: Vector) -> Vector:
    return plus(frame.origin, times(frame.rotation, place))


@kernel
def strand_of(own: Boundary, i: int, frame: Frame) -> Strand:
    """Return the strand of a line or a circle, in another frame."""
    feature = own.features[i]
    if feature.kind == CIRCLE and feature.radius > 0.0:
        return across_tube(feature, frame)
    if feature.kind == CIRCLE:
        half, middle = 0.5 * (feature.high - feature.low), 0.5 * (feature.high + feature.low)
        return Strand(
            True,
            feature.width >= WHOLE_TURN,
            False,
            seen_in(frame, vector_from(feature.point)),
            times(frame.rotation, vector_from(feature.direction)),
            times(frame.rotation, vector_from(feature.toward)),
            feature.length,
            feature.start,
            feature.start + feature.width,
            (0.0, 0.0, 0.0),
            middle,
            math.cos(half),
        )
    into, sine = into_line(own, i)
    point, way = vector_from(feature.point), vector_from(feature.direction)
    begin, end = 0.0, feature.length
    if feature.radius != 0.0:
        out, slant = scaled(into, -1.0), slant_of_side(feature)
        normal = plus(scaled(out, slant), scaled(way, feature.taper))
        point = plus(point, scaled(normal, feature.radius))
        way = minus(scaled(way, abs(slant)), scaled(out, math.copysign(feature.taper, slant)))
        if is_trimmed(own, i):
            begin, end = feature.start, feature.start + feature.width
        into, begin, end, sine = scaled(normal, -1.0), abs(slant) * begin, abs(slant) * end, 1.0
    return Strand(
        False,
        False,
        feature.radius != 0.0,
        seen_in(frame, point),
        times(frame.rotation, way),
        (0.0, 0.0, 0.0),
        0.0,
        begin,
        end,
        times(frame.rotation, into),
        0.0,
        sine,
    )


@kernel
def across_tube(feature: Feature, frame: Frame) -> Strand:
    """Return an arc across the tube around a circle, from its lowest to its highest normal, in another frame."""
    core = on_circle(circle_of(feature), feature.start + ACROSS_TUBE * feature.width)
    way = cross(core.outward, vector_from(feature.direction))
    return Strand(
        True,
        feature.high - feature.low >= WHOLE_TURN,
        True,
        seen_in(frame, core.point),
        times(frame.rotation, way),
        times(frame.rotation, core.outward),
        feature.radius,
        feature.low,
        feature.high,
        (0.0, 0.0, 0.0),
        0.0,
        1.0,
    )


@kernel
def into_line(own: Boundary, i: int) -> tuple[Vector, float]:
    """Return the direction into the material midway between the faces beside a line, in the frame of the body, and the
    sine of half the angle between them; of a round side without bounds, toward its axis from some place.
    """
    line, into, one = own.features[i], (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    if is_trimmed(own, i):
        toward = vector_from(line.toward)
        other = cross(vector_from(line.direction), toward)
        return plus(scaled(toward, -math.cos(line.low)), scaled(other, -math.sin(line.low))), 1.0
    for k in range(line.first_bound, line.last_bound):
        one = vector_from(own.bounds[k].direction)
        into = plus(into, one)
    size = norm(into)
    if size > 0.0:
        into = scaled(into, 1.0 / size)
        cosine = dot(into, one)
        return into, math.sqrt(max(0.0, 1.0 - cosine * cosine))
    axis = vector_from(line.direction)
    aside = out_of_axis(line, (0.0, 0.0, 0.0))
    other = cross(axis, aside)
    return plus(scaled(aside, GENERATOR), scaled(other, math.sqrt(1.0 - GENERATOR * GENERATOR))), 1.0


@kernel
def circle_under(strand: Strand) -> Circle:
    """Return the whole circle that an arc is on."""
    return Circle(strand.point, strand.way, strand.toward, strand.radius)


@kernel
def on_strand(strand: Strand, at: float) -> Vector:
    """Return a place of a strand."""
    if strand.is_arc:
        return on_circle(circle_under(strand), at).point
    return plus(strand.point, scaled(strand.way, at))


@kernel
def inward_at(strand: Strand, at: float) -> Vector:
    """Return the unit vector into the material at a place of a strand, midway between its faces."""
    if not strand.is_arc:
        return strand.inward
    outward = on_circle(circle_under(strand), at).outward
    return minus(scaled(outward, -math.cos(strand.middle)), scaled(strand.way, math.sin(strand.middle)))


@kernel
def length_of(strand: Strand, begin: float, end: float) -> float:
    """Return how long a strand is between two places, metres."""
    return (end - begin) * (strand.radius if strand.is_arc else 1.0)
