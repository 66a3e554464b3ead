"""Which places are in the material of a body: what another of its parts covers touches nothing, and what is deep in
a wall of a hole is so only if there is material.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.tolerances import PROBE, PROBE_MARGIN
from cagepose.kernels.algebra.vector import Vector, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.shapes.along_motion import distance_from
from cagepose.kernels.shapes.body import PlacedBody, place_asked
from cagepose.kernels.shapes.features import (
    EDGE,
    FACE,
    HOLE,
    PIERCED,
    SOLID,
    Feature,
    Shapes,
    beyond_fence,
    out_of_fence,
)
from cagepose.kernels.shapes.meeting import reaches
from cagepose.kernels.shapes.rims import nearest_on_edge

BESIDE = 4.0 * PROBE
"""In touch tolerances: how near to a place a part must be to cover it."""


@kernel
def depth_in_part(shapes: Shapes, which: int, point: Vector) -> float:
    """Return how deep a point is in a part, metres; below zero: how far from it."""
    beyond, nearest, has_faces = -math.inf, math.inf, shapes.parts[which].first_face < shapes.parts[which].last
    for i in range(shapes.parts[which].first, shapes.parts[which].last):
        feature = shapes.features[i]
        if feature.kind == EDGE and feature.radius < 0.0:
            continue
        if feature.kind == EDGE and feature.first_fence == feature.last_fence and has_faces:  # a round side
            on_axis = nearest_on_edge(feature, point)
            beyond = max(beyond, on_axis.away - on_axis.radius)
            continue
        if feature.kind != FACE:
            nearest = min(nearest, distance_from(shapes, i, point))
            continue
        height = dot(vector_from(feature.direction), minus(point, vector_from(feature.point)))
        beyond = max(beyond, height)
        if height > 0.0 and reaches(shapes, i, vector_from(feature.direction), point, 0.0, 0.0):
            nearest = min(nearest, height)
    radius = shapes.features[shapes.parts[which].first].radius
    return radius - beyond if -math.inf < beyond <= 0.0 else radius - nearest


@kernel
def heights_of_wall(wall: Feature) -> tuple[float, float]:
    """Return the heights of the rims of a hole's wall, along its axis."""
    far = wall.radius - wall.taper * wall.length
    return wall.radius * wall.taper, wall.length + far * wall.taper


@kernel
def is_within_wall(wall: Feature, point: Vector) -> bool:
    """Whether a point lies within a wall of a hole, at the heights of its rims or between them."""
    along, seen = vector_from(wall.direction), minus(point, vector_from(wall.point))
    height, far = dot(along, seen), wall.radius - wall.taper * wall.length
    first, last = heights_of_wall(wall)
    if height < first or height > last:
        return False
    radius = wall.radius + (far - wall.radius) * (height - first) / (last - first)
    side = norm(minus(seen, scaled(along, height)))
    return side < -radius * math.sqrt(1.0 - wall.taper * wall.taper)


@kernel
def is_in_hole(shapes: Shapes, which: int, point: Vector) -> bool:
    """Whether a point lies within the walls of a hole."""
    for i in range(shapes.parts[which].first, shapes.parts[which].last):
        wall = shapes.features[i]
        if wall.kind == EDGE and wall.radius < 0.0 and is_within_wall(wall, point):
            return True
    return False


@kernel
def covers(shapes: Shapes, which: int, i: int, place: Vector, normal: Vector, touch_m: float) -> bool:
    """Whether another part of a body covers a place of a part's feature, with this outward normal."""
    feature = shapes.features[i]
    probe = plus(place, scaled(normal, PROBE * touch_m))
    if feature.kind == FACE:
        direction, seen = vector_from(feature.direction), minus(place, vector_from(feature.point))
        seen = minus(seen, scaled(direction, dot(direction, seen)))
        for f in range(feature.first_fence, feature.last_fence):
            beyond = beyond_fence(shapes.fences[f], seen)
            if beyond > -touch_m:
                probe = minus(probe, scaled(out_of_fence(shapes.fences[f], seen), beyond + PROBE * touch_m))
    if feature.kind == EDGE and feature.radius < 0.0:  # of a wall, not at its rims, where it may end in a floor
        along = vector_from(feature.direction)
        height, (first, last) = dot(along, minus(probe, vector_from(feature.point))), heights_of_wall(feature)
        within = min(max(height, first + PROBE * touch_m), last - PROBE * touch_m)
        rise = dot(along, normal)
        down_wall = minus(along, scaled(normal, rise))
        probe = plus(probe, scaled(down_wall, (within - height) / (1.0 - rise * rise)))
    return is_in_parts(shapes, which, probe, PROBE_MARGIN * touch_m)


@kernel
def is_in_parts(shapes: Shapes, but: int, point: Vector, least_m: float) -> bool:
    """Whether a point is deeper than ``least_m`` in a part of a body, of which holes count as open; ``but`` is not
    asked.
    """
    in_hole = False
    for which in range(len(shapes.parts)):
        in_hole = in_hole or (shapes.parts[which].kind != SOLID and is_in_hole(shapes, which, point))
    for which in range(len(shapes.parts)):
        part = shapes.parts[which]
        if which == but or part.kind == HOLE or (in_hole and part.kind == PIERCED):
            continue
        if norm(minus(point, vector_from(part.middle))) > part.reach:
            continue
        if depth_in_part(shapes, which, point) > least_m:
            return True
    return False


@kernel
def place_around(own: Shapes, body: PlacedBody, place: Vector, touch_m: float) -> None:
    """Place all parts of the object that may hold a place."""
    for which in range(len(own.parts)):
        part = body.world.parts[which]
        if norm(minus(place, vector_from(part.middle))) <= part.reach + BESIDE * touch_m:
            place_asked(own, which, body)
