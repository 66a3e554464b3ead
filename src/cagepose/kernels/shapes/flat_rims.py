"""Rims that lie flat: of each contact of one, how far along the rim the other part touches as it does there.

A face lies on a rim from vertex to vertex, or from where the rim comes out from under it, at a sharp edge or at a rim
of its own, to where it does so again, with no vertex between. All points between are contacts, too.
"""

from __future__ import annotations

import math
from typing import Annotated

from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.shapes.features import EDGE, FACE, RIM, VERTEX, Feature, Shapes
from cagepose.kernels.shapes.meeting import Meeting, is_centred
from cagepose.kernels.shapes.rims import HALF_ARC, lie_flat, nearest_on_edge, outward_at

HALF_SECTOR = math.pi / 4.0
"""Radians, of a hole's slanted wall."""
SAME_WAY = 0.5
"""Cosine: a face with such a part of a normal, at the same place and flat on the same rim, has this normal."""


class OnRim:
    """The rim that a place which touches is of: a vertex of it, or one where it comes out from under a face; a record.

    Attributes
    ----------
    length, axis, outward
        Its radius, zero: it is of none; its axis, and the direction from its centre to the place, or of a hole the
        opposite one.
    is_of_cage, arc_before, arc_after
        Whose it is, and the features on both sides of the place.
    face
        What the rim lies on, where that is not what touches, but a face beside this edge; else -1.
    before, after
        How far along the rim to either side it touches as the place does, radians: from a vertex up to the half of an
        arc, else up to the ends of the arc.
    is_on_ball, ball
        Whether the rim lies on a ball, and its centre as seen from the centre of gravity; else, on a face. The side of
        a cone that all of it lies on is there like a ball about the place on its axis that the normals lead through;
        and a ball in a hole's slanted wall touches it along a circle that is there like a rim.
    """

    length: float
    axis: Annotated[FloatArray, 3]
    outward: Annotated[FloatArray, 3]
    is_of_cage: bool
    arc_before: int
    arc_after: int
    face: int
    before: float
    after: float
    is_on_ball: bool
    ball: Annotated[FloatArray, 3]


@kernel
def write_on_rim(
    a: Shapes, i: int, b: Shapes, j: int, met: Meeting, center: Vector, touch_m: float, out: OnRim
) -> None:
    """Write of which rim feature i of the object or feature j of the cage is a vertex, if one of them is and the other
    may lie on all of the rim; or which rim comes out there from under a face.
    """
    out.length, out.face = 0.0, -1
    one, other = a.features[i], b.features[j]
    if one.kind == FACE and other.kind == RIM and lie_flat(other, one, touch_m):
        out.is_of_cage, out.arc_before, out.arc_after = True, j, j
        write_along_face(other, plus(met.place, scaled(met.normal, met.gap)), a, i, touch_m, out)
    elif one.kind == RIM and other.kind == FACE and lie_flat(one, other, touch_m):
        out.is_of_cage, out.arc_before, out.arc_after = False, i, i
        write_along_face(one, met.place, b, j, touch_m, out)
    elif one.kind == EDGE and other.kind == RIM:
        out.is_of_cage, out.arc_before, out.arc_after = True, j, j
        write_under_face(other, plus(met.place, scaled(met.normal, met.gap)), a, i, met.normal, touch_m, out)
    elif one.kind == RIM and other.kind == EDGE:
        out.is_of_cage, out.arc_before, out.arc_after = False, i, i
        write_under_face(one, met.place, b, j, scaled(met.normal, -1.0), touch_m, out)
    elif other.kind == VERTEX and other.length != 0.0:
        out.is_of_cage, out.arc_before, out.arc_after = True, other.arc_before, other.arc_after
        write_at_vertex(other, b, a, i, center, touch_m, out)
    elif one.kind == VERTEX and one.length != 0.0:
        out.is_of_cage, out.arc_before, out.arc_after = False, one.arc_before, one.arc_after
        write_at_vertex(one, a, b, j, center, touch_m, out)
    elif one.kind == VERTEX and other.kind == EDGE and is_centred(one, other):
        out.is_of_cage, out.arc_before, out.arc_after = True, j, j
        write_around_ball(one, other, plus(met.place, scaled(met.normal, met.gap)), center, out)
    elif one.kind == EDGE and other.kind == VERTEX and is_centred(other, one):
        out.is_of_cage, out.arc_before, out.arc_after = False, i, i
        write_around_ball(other, one, met.place, center, out)


@kernel
def write_at_vertex(
    vertex: Feature, arcs: Shapes, bodies: Shapes, i: int, center: Vector, touch_m: float, out: OnRim
) -> None:
    """Write of a vertex of a rim how far to either side feature i of the other body touches as it does."""
    other = bodies.features[i]
    if other.kind == RIM:
        return
    out.length, out.is_on_ball, out.before, out.after = vertex.length, other.kind != FACE, HALF_ARC, HALF_ARC
    ball, outward, axis = vector_from(other.point), vector_from(vertex.toward), vector_from(vertex.direction)
    if other.kind == EDGE:
        ball = nearest_on_edge(other, vector_from(vertex.point)).place
        out.before = HALF_ARC if lie_flat(arcs.features[vertex.arc_before], other, touch_m) else 0.0
        out.after = HALF_ARC if lie_flat(arcs.features[vertex.arc_after], other, touch_m) else 0.0
    elif other.kind == FACE:
        middle, along = minus(vector_from(vertex.point), scaled(outward, vertex.length)), cross(axis, outward)
        back = scaled(along, -1.0)
        out.before = covered_angle(bodies, i, middle, outward, back, vertex.length, HALF_ARC, touch_m)
        out.after = covered_angle(bodies, i, middle, outward, along, vertex.length, HALF_ARC, touch_m)
    for k in range(3):
        out.axis[k], out.outward[k], out.ball[k] = axis[k], outward[k], ball[k] - center[k]


@kernel
def write_around_ball(ball: Feature, wall: Feature, place: Vector, center: Vector, out: OnRim) -> None:
    """Write the circle along which a ball touches a sector of a hole's slanted wall all around, from its middle."""
    middle, axis = vector_from(ball.point), vector_from(wall.direction)
    away = minus(place, middle)
    outward = minus(away, scaled(axis, dot(axis, away)))
    out.length, out.is_on_ball, out.before, out.after = norm(outward), True, HALF_SECTOR, HALF_SECTOR
    for k in range(3):
        out.axis[k], out.outward[k], out.ball[k] = axis[k], outward[k] / out.length, middle[k] - center[k]


@kernel
def write_under_face(
    arc: Feature, place: Vector, shapes: Shapes, edge: int, normal: Vector, touch_m: float, out: OnRim
) -> None:
    """Write how far an arc goes on under a face with this outward normal from where it crosses a sharp edge of it."""
    if shapes.features[edge].radius != 0.0:
        return
    for which in range(len(shapes.parts)):
        part = shapes.parts[which]
        for face in range(part.first_face, part.last if part.first <= edge < part.last else part.first_face):
            flat = shapes.features[face]
            height = dot(vector_from(flat.direction), minus(place, vector_from(flat.point)))
            is_flush = abs(height) <= touch_m and dot(vector_from(flat.direction), normal) > SAME_WAY
            if not is_flush or not lie_flat(arc, flat, touch_m):
                continue
            write_along_face(arc, place, shapes, face, touch_m, out)
            out.face = face


@kernel
def write_along_face(arc: Feature, place: Vector, shapes: Shapes, face: int, touch_m: float, out: OnRim) -> None:
    """Write how far an arc that lies flat on a face goes on there from a place of it."""
    if arc.length < 0.0 or arc.is_second:
        return
    outward, axis, toward = outward_at(arc, place), vector_from(arc.direction), vector_from(arc.toward)
    along = cross(axis, outward)
    angle = math.atan2(dot(cross(toward, outward), axis), dot(toward, outward))
    center, back, radius = vector_from(arc.point), scaled(along, -1.0), arc.length
    out.length, out.is_on_ball = radius, False
    out.after = covered_angle(shapes, face, center, outward, along, radius, HALF_ARC - angle, touch_m)
    out.before = covered_angle(shapes, face, center, outward, back, radius, HALF_ARC + angle, touch_m)
    for k in range(3):
        out.axis[k], out.outward[k], out.ball[k] = axis[k], outward[k], 0.0


@kernel
def covered_angle(
    shapes: Shapes, i: int, center: Vector, outward: Vector, along: Vector, radius: float, most: float, touch_m: float
) -> float:
    """Return how far, up to an angle, a face goes on over a rim from one of its points, in direction ``along``.

    The radius of a hole is below zero. The rim is beyond a fence where ahead cos + aside sin > -base: a circle's one is
    at (x - m)^2 = r^2, which is no less a line through the places where they cross.
    """
    face, reach = shapes.features[i], most
    seen = minus(center, vector_from(face.point))
    for f in range(face.first_fence, face.last_fence):
        fence, slack = shapes.fences[f], touch_m
        way = vector_from(fence.direction)
        base = dot(way, seen) - fence.bound
        if fence.circle != 0.0:
            way = scaled(minus(seen, way), fence.circle)
            base = 0.5 * fence.circle * (dot(way, way) + radius * radius - fence.bound * fence.bound)
            slack = touch_m * fence.bound
        ahead, aside = radius * dot(way, outward), radius * dot(way, along)
        widest = math.hypot(ahead, aside)
        if base + widest <= slack:
            continue
        if base >= widest or (base + ahead > -slack and aside > 0.0):
            return 0.0
        enters = math.atan2(aside, ahead) - math.acos(max(-base / widest, -1.0))
        reach = min(reach, enters if enters > 0.0 else enters + 2.0 * math.pi)
    return max(reach, 0.0)
