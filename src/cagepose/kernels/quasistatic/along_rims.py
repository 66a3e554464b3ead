"""Where features that touched meet after a motion, if one of them is of a rim: the place may have moved along it."""

from __future__ import annotations

import math

from cagepose.kernels.algebra.vector import Matrix, Vector, cross, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.collision.geometry import Geometry
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.shapes.features import EDGE, RIM, VERTEX, Feature, Shapes, is_of_mouth, place_feature
from cagepose.kernels.shapes.flat_rims import SAME_WAY
from cagepose.kernels.shapes.meeting import PARALLEL, Meeting, apart, meeting, reaches
from cagepose.kernels.shapes.rims import ARCS, end_of_arc, is_near_arc, lie_flat, nearest_on_edge

DEEP = 2.0
"""In touch tolerances: a rim on the wall of a hole may be so deep, as its vertices may be in the contacts there."""


@kernel
def meeting_along_rim(geometry: Geometry, i: int, j: int, position: Vector, rotation: Matrix, moved: Shapes) -> Meeting:
    """Return how a vertex of a rim that lay along the wall of a hole meets it; or, where the rim has come off it, how
    the arc beside the vertex does that is nearer. Apart: it is nearest elsewhere, where other vertices keep it, or what
    comes in is pushed out.

    A rim in a conical seat turns about the place on the axis that the normals lead through as on a ball, and then
    touches at two points, between vertices.
    """
    held, cage, nearest, is_flat = moved.features[i], geometry.cage, apart(), True
    is_held = held.kind == VERTEX
    arcs = (held.arc_before, held.arc_after)
    if not is_held:
        arcs = (cage.features[j].arc_before, cage.features[j].arc_after)
    for arc in arcs:
        one, other = (arc, j) if is_held else (i, arc)
        if is_held:
            place_feature(geometry.held, arc, position, rotation, moved)
        if lie_flat(moved.features[one], cage.features[other], geometry.touch_m):
            continue
        is_flat, met = False, meeting(moved, one, cage, other)
        if met.is_one and (not nearest.is_one or met.gap < nearest.gap):
            nearest = met
    return meeting(moved, i, cage, j) if is_flat else nearest


@kernel
def goes_through_wall(geometry: Geometry, i: int, j: int, position: Vector, rotation: Matrix, moved: Shapes) -> bool:
    """Whether at a pose a rim, of which a vertex or an arc was on the wall of a hole, is somewhere deep in the wall.

    What comes in on the far side of a seat is on all of it at one moment, when no place of an arc is the nearest: no
    first contact is found there.
    """
    held, cage = moved.features[i], geometry.cage
    is_held = cage.features[j].kind == EDGE
    rim, at = (held, i) if is_held else (cage.features[j], j)
    arc = at if rim.kind == RIM else rim.arc_after
    place_feature(geometry.held, i, position, rotation, moved)
    for _ in range(ARCS):
        if is_held:
            place_feature(geometry.held, arc, position, rotation, moved)
            if is_deep_in_side(end_of_arc(moved.features[arc], 1.0), cage, j, geometry.touch_m):
                return True
            arc = moved.features[arc].arc_after
        else:
            if is_deep_in_side(end_of_arc(cage.features[arc], 1.0), moved, i, geometry.touch_m):
                return True
            arc = cage.features[arc].arc_after
    return False


@kernel
def is_deep_in_side(point: Vector, shapes: Shapes, i: int, touch_m: float) -> bool:
    """Whether a point is deep in a round side, where the side is."""
    side = shapes.features[i]
    nearest = nearest_on_edge(side, point)
    gap = nearest.away - nearest.radius
    if gap >= -DEEP * touch_m or nearest.away == 0.0:
        return False
    toward = scaled(minus(nearest.place, point), 1.0 / nearest.away)
    core = plus(point, scaled(toward, gap + side.radius))
    return reaches(shapes, i, scaled(toward, -1.0), core, math.inf, touch_m)


@kernel
def is_along_axis(held: Feature, cage: Feature, normal: Vector) -> bool:
    """Whether a normal leads along the axis of a rim, if one of two features is one: across it, a rim that lay flat has
    come out from under an edge.
    """
    leads = True
    if held.kind == RIM:
        leads = abs(dot(normal, vector_from(held.direction))) > SAME_WAY
    if cage.kind == RIM:
        leads = leads and abs(dot(normal, vector_from(cage.direction))) > SAME_WAY
    return leads


@kernel
def meeting_beside(geometry: Geometry, i: int, j: int, position: Vector, rotation: Matrix, moved: Shapes) -> Meeting:
    """Return how an arc of a rim next to one of two features meets the other one, in the half of it that is nearer: the
    place where they met may have moved there.
    """
    held, cage = moved.features[i], geometry.cage
    if held.kind == RIM:
        for beside in (held.arc_before, held.arc_after):
            place_feature(geometry.held, beside, position, rotation, moved)
            met = meeting(moved, beside, cage, j)
            if met.is_one and is_near_arc(held, met.place):
                return met
    if cage.features[j].kind == RIM:
        for beside in (cage.features[j].arc_before, cage.features[j].arc_after):
            met = meeting(moved, i, cage, beside)
            if met.is_one and is_near_arc(cage.features[j], plus(met.place, scaled(met.normal, met.gap))):
                return met
    return apart()


@kernel
def may_be_elsewhere(geometry: Geometry, i: int, j: int, moved: Shapes) -> bool:
    """Whether two features that meet nowhere are the second place on an arc of a rim where another feature is nearest,
    an arc that lies flat on what it touches, as one of a mouth may, or edges that have become parallel: without such a
    place, the others count.
    """
    held, cage = moved.features[i], geometry.cage.features[j]
    if held.kind == EDGE and cage.kind == EDGE:
        return norm(cross(vector_from(held.direction), vector_from(cage.direction))) < PARALLEL
    if held.is_second or cage.is_second or is_of_mouth(held) or is_of_mouth(cage):
        return True
    return lie_flat(held, cage, geometry.touch_m)
