"""The convex corners of a body whose triangles stand for surfaces: `corners_of`.

The cone of outward normals at a corner is the polar of all directions in which the body goes on from there: along its
curves, and along what of its surfaces is between two of them, where that is more than a right angle.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from cagepose.model.boundary.curves import ARC, Curve
from cagepose.model.boundary.surface_union import Tangents, cones_at
from cagepose.model.boundary.trimmed import Vertices
from cagepose.model.checks import FloatArray
from cagepose.model.sides import starts_and_ends
from cagepose.model.surfaces import CONE, PLANE, SPHERE, TORUS, Surface

if TYPE_CHECKING:
    from cagepose.model.boundary.exact_surface import ExactSurface

HOLLOW = 1e-9
"""Sine of the angle between faces beside a curve: a hollow one has more."""
HALF_TURN = math.pi + 1e-9
"""Radians. A flat face that takes up more at a place leaves no corner there."""
WIDE = 0.5 * math.pi
"""Radians. Directions within a face are told that are no farther apart."""
LESS_THAN_HALF = 0.9999 * math.pi
"""Radians. Directions within a round side are told that are no farther apart, its generators among them."""
SAME_WAY = 1e-9
"""Radians between directions that are one."""
TIP = 1e-9
"""Fraction of a cone's size: what is nearer to its axis is its tip."""
GENERATORS_APART = math.radians(22.5)
"""Angle about the axis. At the tip of a cone, the generators that are told are no farther apart."""


Ways = dict[int, tuple[FloatArray, bool]]
"""Of sides of triangles, the unit vector along which their curve leads away from a place, and whether it is hollow."""


def corners_of(surface: ExactSurface, number: int) -> Vertices:
    """Return the convex corners; ``number`` is that of the part."""
    starts, _ = starts_and_ends(surface.triangles)
    leaving, arriving, lengths = _ways(surface)
    places, directions, is_hollow = list[int](), list[FloatArray](), list[bool]()
    shortest, is_none = np.full(len(surface.vertices_m), np.inf), np.zeros(len(surface.vertices_m), np.bool_)
    for side, (direction, hollow) in leaving.items():
        node = int(starts[side])
        other = _arriving_in_fan(side, surface)
        region = int(surface.regions.of_triangles[side // 3])
        face, place = surface.regions.surfaces[region], surface.vertices_m[node]
        if other not in arriving:  # a curve leads through
            continue
        back, _ = arriving[other]
        places.append(node)
        directions.append(direction)
        is_hollow.append(hollow)
        shortest[node] = min(shortest[node], lengths[side])
        between, turn = _between(face, place, direction, back)
        is_none[node] |= face.kind == PLANE and turn > HALF_TURN
        for way in between:
            places.append(node)
            directions.append(way)
            is_hollow.append(False)
    tangents = Tangents(
        np.array(places, np.int64),
        np.array(directions).reshape(-1, 3),
        np.array(is_hollow, np.bool_),
        np.full(len(places), number),
    )
    return cones_at(tangents, surface.vertices_m, shortest, is_none)


def _ways(surface: ExactSurface) -> tuple[Ways, Ways, dict[int, float]]:
    """Return of each side of a triangle that leads away from a place where curves may turn in which direction its curve
    does, and whether that is hollow; the same of sides that lead to one, seen from there; and how long the curves are.
    """
    leaving, arriving, lengths = Ways(), Ways(), dict[int, float]()
    n_corners = int(surface.triangles.max()) + 1  # behind them are places between two arcs, where none turns
    for curve in surface.curves:
        if curve.kind == ARC and curve.is_closed:
            continue
        first, last = surface.vertices_m[curve.nodes[[0, -1]]]
        length = curve.radius_m if curve.kind == ARC else float(np.linalg.norm(last - first))
        # A side is told with the way that leads out of its own start.
        for node, side, sign in ((curve.nodes[0], curve.sides[0], 1.0), (curve.nodes[-1], curve.sides[-1], -1.0)):
            if node >= n_corners:
                continue
            place = surface.vertices_m[node]
            way = curve.tangent(place) if curve.kind == ARC else (last - first) / length
            found = sign * way, _is_hollow(surface, curve, place if curve.kind == ARC else 0.5 * (first + last), way)
            out, back = int(side), int(surface.twins[side])
            if sign < 0.0:
                out, back = back, out
            leaving[out], arriving[back], lengths[out] = found, found, length
    return leaving, arriving, lengths


def _is_hollow(surface: ExactSurface, curve: Curve, place: FloatArray, way: FloatArray) -> bool:
    """Whether a curve is hollow at a place of it; one that is straight is asked in its middle, as the tip of a cone has
    no normal.
    """
    one, other = (surface.regions.surfaces[region].normals(place[None])[0] for region in (curve.left, curve.right))
    return bool(_cross(one, other) @ way < -HOLLOW)


def _cross(one: FloatArray, other: FloatArray) -> FloatArray:
    """As `numpy.cross` of two vectors, which takes ten times as long."""
    a, b, c = one.tolist()
    x, y, z = other.tolist()
    return np.array([b * z - c * y, c * x - a * z, a * y - b * x])


def _arriving_in_fan(side: int, surface: ExactSurface) -> int:
    """Return the side that leads to where another one starts, with the triangles of one region between them."""
    of_triangles, twins = surface.regions.of_triangles, surface.twins
    at, region = side, of_triangles[side // 3]
    for _ in range(len(twins)):
        before = at - at % 3 + (at + 2) % 3
        if of_triangles[twins[before] // 3] != region:
            return before
        at = int(twins[before])
        if at == side:
            break
    return -1


def _between(face: Surface, place: FloatArray, first: FloatArray, last: FloatArray) -> tuple[list[FloatArray], float]:
    """Return directions in which a face goes on from a place, between the two curves that bound it there, and the angle
    between these, radians: from the first counter-clockwise to the last.
    """
    if face.kind == CONE and face.radius_at(place) <= TIP * abs(face.radius_m):
        return _between_at_tip(face, first, last), 0.0
    normal = face.normals(place[None])[0]
    aside = _cross(normal, first)
    aside = aside / np.linalg.norm(aside)
    ahead = _cross(aside, normal)  # a chord of a round face is not quite within it
    turn = math.atan2(float(aside @ last), float(ahead @ last)) % (2.0 * math.pi)
    ways = dict[float, FloatArray]()
    for way in _generators(face, place):
        angle = math.atan2(float(aside @ way), float(ahead @ way)) % (2.0 * math.pi)
        if SAME_WAY < angle < turn - SAME_WAY:
            ways[angle] = way
    widest = WIDE if face.kind in (PLANE, SPHERE, TORUS) else LESS_THAN_HALF
    for one, other in pairwise([0.0, *sorted(ways), turn]):
        n_parts = max(1, math.ceil((other - one) / widest - 1e-9))
        for k in range(1, n_parts):
            angle = one + (other - one) * k / n_parts
            ways[angle] = math.cos(angle) * ahead + math.sin(angle) * aside
    return list(ways.values()), turn


def _generators(face: Surface, place: FloatArray) -> list[FloatArray]:
    """Return the directions in which straight lines lead along a cylinder or a cone from a place of it: beside a chain
    of short edges nothing else of it is straight.
    """
    if face.kind in (PLANE, SPHERE, TORUS):
        return []
    axis, seen = np.array(face.axis), place - np.array(face.point_m)
    across = seen - (seen @ axis) * axis
    way = axis + face.slope * across / np.linalg.norm(across)
    unit = way / np.linalg.norm(way)
    return [unit, -unit]


def _between_at_tip(cone: Surface, first: FloatArray, last: FloatArray) -> list[FloatArray]:
    """As `_between`, of a cone at its tip: its generators between two."""
    out = math.copysign(1.0, -cone.slope * cone.radius_m) * np.array(cone.axis)
    up = float(first @ out) * out
    across = first - up
    aside = np.cross(out, across)
    turn = math.atan2(float(aside @ last), float(across @ last)) % (2.0 * math.pi)
    n_parts = max(1, math.ceil(turn / GENERATORS_APART - 1e-9))
    angles = [turn * k / n_parts for k in range(1, n_parts)]
    return [up + math.cos(angle) * across + math.sin(angle) * aside for angle in angles]
