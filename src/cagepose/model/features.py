"""Shapes as the features that kernels take: vertices, rims, edges and faces with their fences."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from cagepose.kernels.algebra.record import dtype_of
from cagepose.kernels.shapes.features import (
    EDGE,
    FACE,
    HOLE,
    INSIDE,
    OUTSIDE,
    PIERCED,
    RIM,
    SOLID,
    VERTEX,
    Feature,
    Fence,
    ShapePart,
    Shapes,
    copied,
)
from cagepose.kernels.shapes.rims import ARCS
from cagepose.model.box import Box
from cagepose.model.checks import FloatArray, unit_rows
from cagepose.model.hole import Hole
from cagepose.model.hull import Hull, hull_of
from cagepose.model.pose import Pose
from cagepose.model.shapes import Convex, Disc, Rounded, Shape, Turned

NO_DIRECTION, UP = np.zeros(3), np.array((0.0, 0.0, 1.0))
NO_ARC = (True, -1)
AROUND = 50.0
"""A hole that stands alone is one in a square plate: so many times its own size to each side."""


def shapes_of(parts: Iterable[Shape | FloatArray]) -> Shapes:
    """Return the features of parts in the frame of their body; a single point (3,) is a part, too."""
    every = list(parts)
    holes = [part for part in every if isinstance(part, Hole)]
    solids = [part for part in every if isinstance(part, Shape) and not isinstance(part, Hole)]
    made = _Shapes()
    for part in every:
        if isinstance(part, np.ndarray):
            made.add(_hull_features(hull_of(part[None]), Pose(), 0.0))
        elif isinstance(part, Hole):
            made.add(_hole_features(part, [solid for solid in solids if solid.name in part.in_]))
        else:
            features = _solid_features(part)
            for hole in holes:
                if part.name in hole.in_:
                    features.pierce(hole)
            made.add(features)
    return made.shapes()


def shifted(shapes: Shapes, by: FloatArray) -> Shapes:
    """Return shapes moved by a travel, metres."""
    if len(shapes.parts) == 0:
        return shapes
    moved: Any = copied(shapes)
    moved.features["point"] += by
    moved.parts["middle"] += by
    return Shapes(*moved)


def placed_shapes(shapes: Shapes, pose: Pose) -> Shapes:
    """Return shapes as they are in the world with their body at a pose.

    The kernel `place_shapes` does so part by part: as plain Python 10 ms for a drawer, forty times as long.
    """
    placed: Any = copied(shapes)
    turn = pose.rotation.T
    for rows, name in ((placed.features, "direction"), (placed.features, "toward"), (placed.fences, "direction")):
        rows[name] = rows[name] @ turn
    for rows, name in ((placed.features, "point"), (placed.parts, "middle")):
        rows[name] = rows[name] @ turn + pose.position_m
    return Shapes(*placed)


class _Shapes:
    """Rows of records, as parts are added."""

    def __init__(self) -> None:
        self.parts: list[tuple[object, ...]] = []
        self.features: list[tuple[object, ...]] = []
        self.fences: list[tuple[FloatArray, float, float]] = []

    def add(self, part: _Features) -> None:
        first = len(self.features)
        first_other = first + len(part.ends)
        first_face = first_other + len(part.others)
        for row, fences in (*part.ends, *part.others, *part.faces):
            arcs = [(first if of_ends else first_other) + index if index >= 0 else -1 for of_ends, index in row.arcs]
            self.features.append((*row[:-1], *arcs, len(self.fences), len(self.fences) + len(fences)))
            self.fences.extend(fences)
        ball = (part.middle, part.reach_m, part.least_length_m)
        self.parts.append((part.kind, first, first_face, len(self.features), *ball))

    def shapes(self) -> Shapes:
        return Shapes(
            np.array(self.parts, dtype_of(ShapePart)),
            np.array(self.features, dtype_of(Feature)),
            np.array(self.fences, dtype_of(Fence)),
        )


class _Row(NamedTuple):
    """What a `Feature` begins with; and its arcs: before, after and twin, whether among the ends, and which there."""

    kind: int
    point: FloatArray
    direction: FloatArray
    toward: FloatArray
    length: float
    radius: float
    taper: float
    end_taper: float
    is_second: bool
    arcs: tuple[tuple[bool, int], ...]


class _Features:
    """Features of one part with their fences: what it ends in, faces that all of it is behind, and others."""

    def __init__(self, kind: int, middle: FloatArray, reach_m: float, least_length_m: float) -> None:
        self.kind, self.middle, self.reach_m, self.least_length_m = kind, middle, reach_m, least_length_m
        self.ends: list[tuple[_Row, list[tuple[FloatArray, float, float]]]] = []
        self.others: list[tuple[_Row, list[tuple[FloatArray, float, float]]]] = []
        self.faces: list[tuple[_Row, list[tuple[FloatArray, float, float]]]] = []

    def add(
        self,
        kind: int,
        pose: Pose,
        point: FloatArray,
        direction: FloatArray = NO_DIRECTION,
        length: float = 0.0,
        radius: float = 0.0,
        tapers: tuple[float, float] = (0.0, 1.0),
        is_second: bool = False,
        toward: FloatArray = NO_DIRECTION,
        fences: Iterable[tuple[FloatArray, float, float]] = (),
        arcs: tuple[tuple[bool, int], ...] = (NO_ARC, NO_ARC, NO_ARC),
    ) -> None:
        """Add a feature that is given in the frame of its shape."""
        turn = pose.rotation
        place, along, outward = pose.transform(point), turn @ direction, turn @ toward
        row = _Row(kind, place, along, outward, length, radius, *tapers, is_second, arcs)
        of_end = kind == VERTEX or (kind == RIM and length > 0.0 and not is_second)
        of_kind = self.ends if of_end else self.faces if kind == FACE and self.kind != HOLE else self.others
        of_kind.append((row, [(turn @ across, bound, circle) for across, bound, circle in fences]))

    def add_rim(
        self, pose: Pose, height: float, radius: float, out: FloatArray, taper: float, end_taper: float = 1.0
    ) -> None:
        """Add a rim about the shape's z axis: the ends of its arcs, and the arcs. A hole's radius is below 0."""
        angles = math.pi / ARCS * np.arange(2 * ARCS)
        outward = np.stack([np.cos(angles), np.sin(angles), np.zeros(2 * ARCS)], axis=1)
        of_ends = radius > 0.0
        first = len(self.ends) + ARCS if of_ends else len(self.others)
        second = len(self.others) + (0 if of_ends else ARCS)
        is_forward = out[2] > 0.0
        for index, away in enumerate(outward[1::2]):
            along = np.cross(out, away)
            beside = (index, (index + 1) % ARCS) if is_forward else ((index + 1) % ARCS, index)
            below = taper * away - math.sqrt(1.0 - taper * taper) * out
            above = math.sqrt(1.0 - end_taper * end_taper) * out - end_taper * away
            fences = [(direction, 0.0, 0.0) for direction in (along, -along, above, below)]
            arcs = (*((of_ends, first + arc) for arc in beside), NO_ARC)
            self.add(VERTEX, pose, height * UP + radius * away, out, radius, toward=away, fences=fences, arcs=arcs)
        for is_second in (False, True):
            ring, start = (False, second) if is_second else (of_ends, first)
            for index, away in enumerate(outward[::2]):
                before, after = ((ring, start + (index + step) % ARCS) for step in (-1, 1))
                twin = (of_ends, first + index) if is_second else (False, second + index)
                arcs = (before, after, twin)
                self.add(RIM, pose, height * UP, out, radius, 0.0, (taper, end_taper), is_second, away, arcs=arcs)

    def add_side(self, pose: Pose, low: tuple[float, float], high: tuple[float, float]) -> None:
        """Add the side between two heights with their radii, those of a hole below zero; a slanted one in sectors."""
        (start, radius), (end, other) = low, high
        angle = math.atan2(radius - other, end - start)
        sine, cosine = math.sin(angle), math.cos(angle)
        start, end = start - radius * sine / cosine, end - other * sine / cosine
        if abs(other) > abs(radius):  # from the wide end on, as the narrow one may be a tip
            start, end, radius, sine = end, start, other, -sine
        along, length = math.copysign(1.0, end - start) * UP, abs(end - start)
        if radius > 0.0 or sine == 0.0:
            self.add(EDGE, pose, start * UP, along, length, radius / cosine, tapers=(sine, 1.0))
            return
        turns = 2.0 * math.pi * np.arange(8) / 8.0
        ways = np.stack([np.cos(turns), np.sin(turns), np.zeros(8)], axis=1)
        for middle in range(0, 8, 2):  # sectors, as what goes along one side of the wall meets the other one
            fences = [(ways[(middle + beyond) % 8], 0.0, 0.0) for beyond in (3, 5)]
            edge = (EDGE, pose, start * UP, along, length, radius / cosine, (sine, 1.0))
            self.add(*edge, toward=ways[middle], fences=fences)

    def pierce(self, hole: Hole) -> None:
        """Cut a hole out of the faces that it runs through."""
        self.kind = PIERCED
        for face, fences in self.faces:
            circle = hole.circle_in(face.point + face.radius * face.direction, face.direction)
            if circle is not None:
                center, wide = circle
                from_point = center - face.point
                fences.append((from_point - (from_point @ face.direction) * face.direction, wide, OUTSIDE))


def _solid_features(part: Shape) -> _Features:
    if isinstance(part, Box):
        return _hull_features(hull_of(part.corners_object()), Pose(), 0.0)
    if isinstance(part, Rounded):
        hull = part.hull if isinstance(part, Convex) else hull_of(part.core())
        return _hull_features(hull, part.pose_body_shape, part.radius_m)
    if isinstance(part, Turned):
        return _turned_features(part)
    raise TypeError(f"no features are known of a {part.kind}")


def _hull_features(hull: Hull, pose: Pose, radius_m: float) -> _Features:
    """Return the features of a hull, blown up by a radius."""
    vertices, placed = pose.transform(hull.vertices_m), Pose()
    normals = hull.normals @ pose.rotation.T
    starts, ends = vertices[hull.edges[:, 0]], vertices[hull.edges[:, 1]]
    lengths = np.linalg.norm(ends - starts, axis=1)
    along = (ends - starts) / lengths[:, None]
    middle = vertices.mean(axis=0)
    reach = float(np.linalg.norm(vertices - middle, axis=1).max()) + radius_m
    made = _Features(SOLID, middle, reach, float(lengths.min(initial=np.inf)))
    outward = _outward_in_faces(hull, vertices, normals)
    away_from: list[list[FloatArray]] = [[] for _ in vertices]
    for end, ways in ((0, along), (1, -along)):
        for index, way in zip(hull.edges[:, end].tolist(), ways, strict=True):
            away_from[index].append(way)
    inward_of: dict[tuple[int, int], list[FloatArray]] = {}
    for sides in outward:
        for side, direction in sides:
            inward_of.setdefault(side, []).append(-direction)
    for vertex, away in zip(vertices, away_from, strict=True):
        made.add(VERTEX, placed, vertex, radius=radius_m, fences=[(direction, 0.0, 0.0) for direction in away])
    for index, (start, end) in enumerate(hull.edges.tolist()):
        inward = [(direction, 0.0, 0.0) for direction in inward_of.get((start, end), ())]
        made.add(EDGE, placed, starts[index], along[index], float(lengths[index]), radius_m, fences=inward)
    for face, normal, sides in zip(hull.faces, normals, outward, strict=True):
        center = vertices[list(face)].mean(axis=0)
        bounds = [(direction, float(direction @ (vertices[side[0]] - center)), 0.0) for side, direction in sides]
        made.add(FACE, placed, center, normal, radius=radius_m, fences=bounds)
    return made


def _turned_features(part: Turned) -> _Features:
    """Return the features of what is turned about an axis: flat ends, their rims, and the side between them."""
    pose, (low, wide), (high, narrow) = part.pose_body_shape, part.rims[0], part.rims[-1]
    middle, is_flat = pose.transform(0.5 * (low + high) * UP), isinstance(part, Disc)
    angle = math.atan2(wide - narrow, high - low)
    slant = [] if is_flat else [math.hypot(high - low, wide - narrow)]
    lengths = [radius for radius in (wide, narrow) if radius > 0.0] + slant
    made = _Features(SOLID, middle, part.farthest_m(middle), min(lengths))
    for height, radius, out in ((low, wide, -UP), (high, narrow, UP)):
        taper = -1.0 if is_flat else math.sin(angle) * out[2]
        if radius == 0.0:
            made.add(VERTEX, pose, height * UP, fences=[(-out, -taper, 0.0)])
            continue
        made.add(FACE, pose, height * UP, out, fences=[(NO_DIRECTION, radius, INSIDE)])
        if not is_flat or out[2] > 0.0:
            made.add_rim(pose, height, radius, out, taper)
    if not is_flat:
        made.add_side(pose, (low, wide), (high, narrow))
    return made


def _hole_features(hole: Hole, solids: Sequence[Shape]) -> _Features:
    """Return the features of a hole in parts, or in a plate of its own."""
    pose, wide = hole.pose_body_shape, max(radius for _, radius in hole.rims)
    depth, is_open = hole.run_through(solids)
    if solids:
        middle = pose.transform(-0.5 * depth * UP)
        made = _Features(HOLE, middle, math.hypot(wide, 0.5 * depth), min(hole.radius_m, depth))
    else:
        side = 2.0 * AROUND * (wide + depth)
        made = _solid_features(Box((side, side, depth), pose @ Pose((0.0, 0.0, -0.5 * depth))))
        made.pierce(hole)
        made.least_length_m = min(hole.radius_m, depth)
    heights = [(-depth, hole.radius_m), *hole.rims[1:]]
    for (low, radius), (high, other) in pairwise(heights):
        made.add_side(pose, (low, -radius), (high, -other))
    slants = [math.atan2(other - radius, high - low) for (low, radius), (high, other) in pairwise(heights)]
    for index, (height, radius) in enumerate(heights[1:]):
        end_taper = math.sin(slants[index + 1]) if index + 1 < len(slants) else 1.0
        made.add_rim(pose, height, -radius, UP, math.sin(slants[index]), end_taper)
    if is_open:
        made.add_rim(pose, -depth, -hole.radius_m, -UP, 0.0)
    else:
        made.add(FACE, pose, -depth * UP, UP, fences=[(NO_DIRECTION, hole.radius_m, INSIDE)])
    return made


def _outward_in_faces(
    hull: Hull, vertices: FloatArray, normals: FloatArray
) -> list[list[tuple[tuple[int, int], FloatArray]]]:
    """Return, of each face, its sides (lower index first), with the unit vectors out of the face across them."""
    found = []
    for face, normal in zip(hull.faces, normals, strict=True):
        loop = list(zip(face, (*face[1:], face[0]), strict=True))
        across = unit_rows(np.array([np.cross(vertices[end] - vertices[start], normal) for start, end in loop]))
        found.append([((min(pair), max(pair)), row) for pair, row in zip(loop, across, strict=True)])
    return found
