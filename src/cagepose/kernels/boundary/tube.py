"""The tube around a circle, which is a part of a torus: where places are beside it, and where straight lines cross it.

All is in the frame of the body. The radius of the circle is R, that of the tube r. On the tube the distance from the
circle, sqrt((rho - R)^2 + h^2), is r, with the distance rho from the circle's axis and the height h along that.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.boundary.circle import WHOLE_TURN, outward_at
from cagepose.kernels.boundary.features import Feature
from cagepose.kernels.circles.places import within_turn
from cagepose.kernels.native.kernel import kernel

MOST_CROSSINGS = 4
"""Of a straight line and a tube."""
HALVINGS, LAST_STEP = 80, 4e-16
"""Of the search for one crossing, at most; and in sizes of the tube: a shorter step is none."""


class TubePlace(NamedTuple):
    """A place beside a tube.

    Attributes
    ----------
    gap
        How far it is above the tube, metres.
    normal
        Outward unit normal of the tube where that is nearest.
    psi
        Angle of that normal from the plane of the circle, radians.
    rho
        How far the place is from the circle's axis, metres.
    beyond, beyond_arc
        Radians by which it is beyond the normals across, and beyond the arc; below zero: within; -inf: all is there.
    """

    gap: float
    normal: Vector
    psi: float
    rho: float
    beyond: float
    beyond_arc: float


@kernel
def beside_tube(circle: Feature, place: Vector) -> TubePlace:
    """Return how a place is beside the tube around a circle."""
    axis, seen = vector_from(circle.direction), minus(place, vector_from(circle.point))
    out, height = outward_at(circle, place), dot(axis, seen)
    rho = dot(out, seen)
    off = rho - circle.length
    away = math.hypot(off, height)
    normal = out
    if away > 0.0:
        normal = plus(scaled(out, off / away), scaled(axis, height / away))
    psi, half = math.atan2(height, off), 0.5 * (circle.high - circle.low)
    beyond, beyond_arc = -math.inf, -math.inf
    if 2.0 * half < WHOLE_TURN:
        beyond = abs(within_turn(psi - circle.low - half)) - half
    if circle.width < WHOLE_TURN:
        toward = vector_from(circle.toward)
        angle = math.atan2(dot(out, cross(axis, toward)), dot(out, toward))
        beyond_arc = abs(within_turn(angle - circle.start - 0.5 * circle.width)) - 0.5 * circle.width
    return TubePlace(away - circle.radius, normal, psi, rho, beyond, beyond_arc)


@kernel
def beyond_tube(circle: Feature, at: TubePlace) -> float:
    """Return how far a place on a tube is beyond where that ends, metres; below zero: within."""
    return max(circle.radius * at.beyond, at.rho * at.beyond_arc)


@kernel
def distance_from_tube(circle: Feature, place: Vector) -> float:
    """Return how far a place is at least from a tube, as far as that reaches, metres; exactly so if its foot is on it.

    Beyond the normals it is the way to the end of the tube in the plane through the axis.
    """
    at = beside_tube(circle, place)
    distance = abs(at.gap)
    if at.beyond > 0.0:
        chord = 2.0 * math.sin(0.5 * min(at.beyond, math.pi))
        distance = math.sqrt(at.gap * at.gap + circle.radius * (circle.radius + at.gap) * chord * chord)
    if at.beyond_arc > 0.0:
        distance = max(distance, at.rho * math.sin(min(at.beyond_arc, 0.5 * math.pi)))
    return distance


class Line(NamedTuple):
    """A straight line as seen from a circle: the place of it that is nearest to the centre, how far that is along the
    line, and its direction; and f' = 4 u^3 + 2 b u + c, u from that place on, of

        f = (|p|^2 + R^2 - r^2)^2 - 4 R^2 (|p|^2 - h^2),

    which has the sign of the gap.
    """

    nearest: Vector
    along: float
    way: Vector
    b: float
    c: float


@kernel
def line_by(circle: Feature, start: Vector, way: Vector) -> Line:
    """Return a line from a place along a unit vector as seen from a circle."""
    seen, axis = minus(start, vector_from(circle.point)), vector_from(circle.direction)
    along = -dot(seen, way)
    nearest = plus(seen, scaled(way, along))
    square, height, rise = circle.length * circle.length, dot(axis, nearest), dot(axis, way)
    inner = dot(nearest, nearest) + square - circle.radius * circle.radius
    b = 2.0 * inner - 4.0 * square * (1.0 - rise * rise)
    return Line(nearest, along, way, b, 8.0 * square * height * rise)


@kernel
def gap_along(circle: Feature, line: Line, at: float) -> tuple[float, float]:
    """Return how far a place of a line is above a tube, and how this grows along the line."""
    place, axis = plus(line.nearest, scaled(line.way, at)), vector_from(circle.direction)
    height = dot(axis, place)
    across = minus(place, scaled(axis, height))
    rho, rise = norm(across), dot(axis, line.way)
    off = rho - circle.length
    away = math.hypot(off, height)
    if away == 0.0 or rho == 0.0:
        return away - circle.radius, 0.0
    aside = dot(across, line.way) / rho
    return away - circle.radius, (off * aside + height * rise) / away


@kernel
def slope_along(line: Line, at: float) -> tuple[float, float]:
    """Return f' and f'' at a place of a line."""
    return (4.0 * at * at + 2.0 * line.b) * at + line.c, 12.0 * at * at + 2.0 * line.b


@kernel
def zero_between(circle: Feature, line: Line, low: float, high: float, of_slope: bool) -> float:
    """Return where the gap, or f', is zero between two places of a line at which it has different signs: by Newton's
    steps, or halves where those lead out.
    """
    size, at = circle.length + circle.radius, 0.5 * (low + high)
    starts_below = (slope_along(line, low)[0] if of_slope else gap_along(circle, line, low)[0]) < 0.0
    for _ in range(HALVINGS):
        value, slope = slope_along(line, at) if of_slope else gap_along(circle, line, at)
        if (value < 0.0) == starts_below:
            low = at
        else:
            high = at
        before = at
        at = at - value / slope if slope != 0.0 else math.inf
        if not low < at < high:
            at = 0.5 * (low + high)
        if abs(at - before) <= LAST_STEP * size:
            break
    return at


@kernel
def tube_crossing(circle: Feature, start: Vector, way: Vector, which: int) -> tuple[bool, float]:
    """Return where, from a place on, a straight line crosses the tube around a circle for the first to fourth time, in
    their order; False: not so often.

    Between places where f' is zero f has one zero at most, and so has f' between those where f'' is.
    """
    line = line_by(circle, start, way)
    square = (circle.length + circle.radius) ** 2 - dot(line.nearest, line.nearest)
    if square <= 0.0:
        return False, 0.0
    end, turn = math.sqrt(square), math.sqrt(max(0.0, -line.b / 6.0))
    turn = min(turn, end)
    n_found, low, was_below = 0, -end, False  # the ends are outside
    begin = -end
    for piece in range(4):
        stop = -turn if piece == 0 else turn if piece == 1 else end
        at = end
        if piece < 3:
            first, last = slope_along(line, begin)[0], slope_along(line, stop)[0]
            if (first < 0.0) == (last < 0.0):
                begin = stop
                continue
            at = zero_between(circle, line, begin, stop, True)
            begin = stop
        is_below = piece < 3 and gap_along(circle, line, at)[0] < 0.0
        if is_below != was_below:
            if n_found == which:
                return True, line.along + zero_between(circle, line, low, at, False)
            n_found += 1
        low, was_below = at, is_below
    return False, 0.0
