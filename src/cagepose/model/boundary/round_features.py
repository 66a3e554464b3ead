"""The round features of a body whose triangles stand for surfaces: arcs, sides of cylinders and cones, balls."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from cagepose.kernels.boundary.features import CIRCLE, HALF_SPACE, SEGMENT, VERTEX
from cagepose.kernels.circles.places import within_turn
from cagepose.model.boundary.blocks import NOWHERE, Row
from cagepose.model.boundary.curves import ARC, Curve, width_of
from cagepose.model.boundary.turned_rows import side_row, tip_row
from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose, turn_from_z
from cagepose.model.surfaces import CONE, Surface

if TYPE_CHECKING:
    from cagepose.model.boundary.exact_surface import ExactSurface, Piece

TIP = 1e-9
"""Fraction of a cone's greatest radius: a narrower end is its tip."""
BEYOND_CAP = 1e-4
"""Cosine: corners of a ball's triangles are no farther beyond its circles."""
ALONG = np.array((0.0, 0.5, 1.0))
"""Shares of the way along an arc where normals beside it are asked: beside a part of a circle all are the same."""
NARROW = 1.0
"""Radians. Of an arc that is narrower, the box is that around its places, and not that of its circle."""
GENERATORS = 48
"""Angles at which a line along a side is looked for that is on it for long."""
FIRST_GENERATOR = 0.7548
"""Radians. The first of them, along which few borders of ordinary parts lead."""


def circle_of(surface: ExactSurface, index: int, number: int) -> Row:
    """Return a convex arc between two faces as a feature of part ``number``."""
    curve = surface.curves[index]
    width = width_of(curve, surface.vertices_m)
    places = curve.at(ALONG, surface.vertices_m)
    outward = (places - curve.center_m) / curve.radius_m
    angles = []
    for region in (curve.left, curve.right):
        normals = surface.regions.surfaces[region].normals(places)
        found = np.unwrap(np.arctan2(normals @ curve.axis, np.einsum("ij,ij->i", normals, outward)))
        at_ends = [
            found[0] + within_turn(math.atan2(float(normal @ curve.axis), float(normal @ outward[end])) - found[0])
            for end, normal in _facets_at_ends(surface, curve, region)
        ]
        angles.append(np.append(found, at_ends))
    first, last = sorted(angles, key=lambda found: float(found[0]))
    if last[0] - first[0] > math.pi:
        first, last = last, first + 2.0 * math.pi
    rise = _rise(surface, curve)
    reach = curve.radius_m * np.sqrt(np.maximum(0.0, 1.0 - curve.axis**2))
    box = np.stack([curve.center_m - reach, curve.center_m + reach])
    if width < NARROW:
        bulge = curve.radius_m * (1.0 - math.cos(0.5 * width))
        box = np.stack([np.maximum(box[0], places.min(axis=0) - bulge), np.minimum(box[1], places.max(axis=0) + bulge)])
    numbers = (curve.radius_m, 0.0, 0.0, float(first.min()) - rise, float(last.max()) + rise, 0.0, width)
    least = curve.radius_m * min(1.0, width)
    return Row(CIRCLE, number, curve.center_m, curve.axis, outward[0], *numbers, [], least, box)


def _facets_at_ends(surface: ExactSurface, curve: Curve, region: int) -> Iterator[tuple[int, FloatArray]]:
    """Yield the normals of flat facets that meet an end of an arc on the side of one of its regions, a facet itself,
    each after the place of its end in `ALONG`: a part rolls over the end onto those, too.
    """
    if surface.regions.is_exact[region]:
        return
    of_triangles, twins = surface.regions.of_triangles, surface.twins
    first, last = curve.sides[[0, -1]] if region == curve.left else twins[curve.sides[[0, -1]]]
    # Around the start of a side it goes on at the side before, two sides on; around its end at that after it.
    to_start, to_end = (2, 1) if region == curve.left else (1, 2)
    for end, side, step in ((0, int(first), to_start), (-1, int(last), to_end)):
        seen, at = {region}, side
        while True:
            at = int(twins[at - at % 3 + (at + step) % 3])
            other = int(of_triangles[at // 3])
            if at == side or surface.regions.is_exact[other]:
                break
            if other not in seen:
                seen.add(other)
                yield end, np.array(surface.regions.surfaces[other].axis)


def _rise(surface: ExactSurface, curve: Curve) -> float:
    """Return the greatest angle under which an arc is seen above flat facets beside it, radians: over these a part tips
    onto it before they lie flat. All around a circle it is not told.
    """
    if curve.is_closed:
        return 0.0
    start, end = surface.vertices_m[curve.nodes[0]], surface.vertices_m[curve.nodes[-1]]
    found = 0.0
    for side in (int(curve.sides[0]), int(surface.twins[curve.sides[0]])):
        region = int(surface.regions.of_triangles[side // 3])
        if not surface.regions.is_exact[region]:
            face, chord = surface.regions.surfaces[region], (end - start) / np.linalg.norm(end - start)
            opposite = surface.vertices_m[surface.triangles[side // 3, (side + 2) % 3]] - start
            depth = float(np.linalg.norm(opposite - (opposite @ chord) * chord))
            found = max(found, math.atan2(float(face.heights(curve.at(ALONG, surface.vertices_m)).max()), depth))
    return found


def _caps(surface: ExactSurface, region: int) -> list[tuple[FloatArray, float]]:
    """Return the half-spaces of normals of a ball that circles leave: unit vectors, and cosines that are not passed."""
    ball = surface.regions.surfaces[region]
    center, radius = np.array(ball.point_m), ball.radius_m
    found = []
    for curve in surface.curves:
        if region in (curve.left, curve.right):
            place = surface.vertices_m[curve.nodes[0]]
            inward = np.cross(ball.normals(place[None])[0], curve.tangent(place))
            way = math.copysign(1.0, float(inward @ curve.axis)) * (-1.0 if region == curve.left else 1.0) * curve.axis
            found.append((way, float(way @ (curve.center_m - center)) / radius))
    return found


def is_within_caps(surface: ExactSurface, region: int) -> bool:
    """Whether a region of a ball is what all of its circles leave, and not more, as where a notch is cut out."""
    ball = surface.regions.surfaces[region]
    normals = ball.normals(_places_of(surface, region))
    return all(float((normals @ way).max()) <= limit + BEYOND_CAP for way, limit in _caps(surface, region))


def ball_of(surface: ExactSurface, region: int, number: int) -> Row:
    """Return what circles leave of a ball as a feature: they bound its normals."""
    ball = surface.regions.surfaces[region]
    center, radius = np.array(ball.point_m), ball.radius_m
    bounds = [(HALF_SPACE, way, NOWHERE, limit) for way, limit in _caps(surface, region)]
    of_region = surface.triangles[surface.regions.of_triangles == region]
    toward = NOWHERE
    if bounds:
        middle = surface.vertices_m[of_region[0]].mean(axis=0) - center
        toward = middle / np.linalg.norm(middle)
    box = np.stack([center - radius, center + radius])
    numbers = (0.0, radius, 0.0, 0.0, 0.0, 0.0, 0.0)
    return Row(VERTEX, number, center, NOWHERE, toward, *numbers, bounds, radius if bounds else np.inf, box)


def side_of(surface: ExactSurface, region: int, pieces: Sequence[Piece], number: int) -> Row:
    """Return the side of a cylinder or a cone as a feature, trimmed by ``pieces`` of its borders."""
    side = surface.regions.surfaces[region]
    places = _places_of(surface, region)
    along = (places - np.array(side.point_m)) @ np.array(side.axis)
    ends = [(height, _radius(side, height)) for height in (float(along.min()), float(along.max()))]
    sense = math.copysign(1.0, side.radius_m)
    (low, wide), (high, other) = ends
    row = side_row(_frame_of(side), (low, sense * wide), (high, sense * other), number)
    curves = [surface.curves[k] for k in {piece.curve for piece in pieces}]
    row = row._replace(box=_box_of(side, places, row.box))
    if all(_is_end(curve, side) for curve in curves):
        return row
    borders = [_in_chart(row, surface, piece, sense) for piece in pieces]
    angle, begin, length = _generator(borders)
    bounds = [(SEGMENT, np.array((*start, 0.0)), np.array((*end, 0.0)), 0.0) for start, end in borders]
    return row._replace(bounds=bounds, low=angle, start=begin, width=length)


def tip_of(surface: ExactSurface, region: int, number: int) -> list[Row]:
    """Return the tip of a cone that is no end of any curve as a feature, if there is one."""
    side = surface.regions.surfaces[region]
    if side.kind != CONE or side.radius_m < 0.0:
        return []
    places = _places_of(surface, region)
    along = (places - np.array(side.point_m)) @ np.array(side.axis)
    wide = max(_radius(side, float(along.min())), _radius(side, float(along.max())))
    out = -math.copysign(1.0, side.slope)
    tip = float((out * along).max()) * out
    if _radius(side, tip) > TIP * wide or any(
        side.radius_at(surface.vertices_m[node]) <= TIP * wide
        for curve in surface.curves
        if region in (curve.left, curve.right)
        for node in curve.nodes.tolist()
    ):
        return []
    return [tip_row(_frame_of(side), tip, out, out * math.atan(abs(side.slope)), wide, number)]


def _places_of(surface: ExactSurface, region: int) -> FloatArray:
    places: FloatArray = surface.vertices_m[np.unique(surface.triangles[surface.regions.of_triangles == region])]
    return places


def _frame_of(side: Surface) -> Pose:
    return Pose(np.array(side.point_m), turn_from_z(np.array(side.axis)))


def _radius(side: Surface, along: float) -> float:
    """Return the radius of a side at a height above its point; none below zero, as rounding may be at a tip."""
    return max(0.0, abs(side.radius_m) + side.slope * along)


def _is_end(curve: Curve, side: Surface) -> bool:
    """Whether a curve is a whole circle around a side."""
    return curve.kind == ARC and curve.is_closed and abs(float(curve.axis @ np.array(side.axis))) > 0.5


def _box_of(side: Surface, places: FloatArray, whole: FloatArray) -> FloatArray:
    """Return a box around places of a side, as far as it may bulge between them, and within that around all of it."""
    widest = max(side.radius_at(place) for place in places[:: max(1, len(places) // 100)])
    spread = float(np.linalg.norm(np.ptp(places, axis=0)))
    bulge = widest if spread > widest else spread
    return np.stack(
        [np.maximum(whole[0], places.min(axis=0) - bulge), np.minimum(whole[1], places.max(axis=0) + bulge)]
    )


def _in_chart(
    row: Row, surface: ExactSurface, piece: Piece, sense: float
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the start and the end of a border in the chart of a side: angle and height, with the side to its left."""
    start, end = (_chart_place(row, surface.vertices_m[node]) for node in (piece.start, piece.end))
    if start[2] or end[2]:  # the tip has no angle
        start, end = (end[0] if start[2] else start[0], *start[1:]), (start[0] if end[2] else end[0], *end[1:])
    return (start[:2], end[:2]) if sense > 0.0 else (end[:2], start[:2])


def _chart_place(row: Row, place: FloatArray) -> tuple[float, float, bool]:
    """Return angle and height of a place of a side as kernels have them, and whether it is on the axis."""
    seen = place - row.point
    level = float(seen @ row.direction)
    across = seen - level * row.direction
    is_tip = float(np.linalg.norm(across)) <= TIP * abs(row.radius)
    angle = math.atan2(float(across @ np.cross(row.direction, row.toward)), float(across @ row.toward))
    square = 1.0 - row.taper * row.taper
    return angle, (level - row.taper * row.radius) / square, is_tip


def _generator(
    borders: Sequence[tuple[tuple[float, float], tuple[float, float]]],
) -> tuple[float, float, float]:
    """Return the angle of a line along a side that is on it for long, where it begins there, and its length."""
    best = (0.0, 0.0, 0.0)
    for k in range(GENERATORS):
        angle = FIRST_GENERATOR + 2.0 * math.pi * k / GENERATORS
        levels = []
        for (start, low), (end, high) in borders:
            first, last = within_turn(start - angle), within_turn(end - angle)
            if (first < 0.0) != (last < 0.0) and abs(last - first) < math.pi:
                levels.append(low - (high - low) * first / (last - first))
        levels.sort()
        for begin, until in zip(levels[::2], levels[1::2], strict=False):
            if until - begin > best[2]:
                best = (angle, begin, until - begin)
    return best
