"""Rims and edges that touch with one tangent, as at the same height: they pass each other, and other features tell
whether something is in the way.
"""

from __future__ import annotations

from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, scaled, vector_from
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.shapes.features import EDGE, FACE, RIM, Feature, Shapes
from cagepose.kernels.shapes.meeting import Meeting, apart, reaches
from cagepose.kernels.shapes.rims import beyond_normals, outward_at

SIDE_BY_SIDE = 1e-6
"""Sine between tangents: a lesser one is none."""
AT_END = 1.5
"""In touch tolerances: farther from its end a side touches an edge by itself. The rim there reaches two beyond the end
of a face, so that one of them always counts.
"""
DISC = -1.0
"""Taper below the rim of a disc: it has no side."""


@kernel
def lie_side_by_side(one: Feature, other: Feature, met: Meeting) -> bool:
    """Whether two rims, or a rim and a sharp edge, touch with one tangent, as at the same height: the sides and walls
    that end there tell the normal to all digits, which circles that nearly coincide would leave to rounding; and where
    none does, they pass each other as parallel edges do. Rims of discs have no sides.
    """
    rim, beside = (other, one) if other.kind == RIM and (one.kind != RIM or other.length < 0.0) else (one, other)
    if rim.kind != RIM:
        return False
    along = vector_from(beside.direction)
    if beside.kind == RIM:
        if rim.length > 0.0 and (rim.taper == DISC or beside.taper == DISC):
            return False
        along = cross(along, outward_at(beside, met.place))
    elif beside.kind != EDGE or beside.radius != 0.0 or beside.taper != 0.0:
        return False
    return norm(cross(cross(vector_from(rim.direction), outward_at(rim, met.place)), along)) < SIDE_BY_SIDE


@kernel
def ends_at_edge(one: Feature, other: Feature, met: Meeting, touch_m: float) -> bool:
    """Whether a round side touches a sharp edge across it where it ends: its rim does, side by side."""
    side, edge = (one, other) if one.radius > 0.0 else (other, one)
    if side.kind != EDGE or edge.kind != EDGE or edge.radius != 0.0 or side.radius <= 0.0:
        return False
    along = vector_from(side.direction)
    height = dot(along, minus(met.place, vector_from(side.point)))
    if min(abs(height), abs(height - side.length)) > AT_END * touch_m:
        return False
    return abs(dot(along, vector_from(edge.direction))) < SIDE_BY_SIDE and side.taper == 0.0


@kernel
def has_flat_ends(a: Shapes, one: int, b: Shapes, other: int) -> bool:
    """Whether one of two parts begins with a vertex of a rim, as a cylinder does."""
    return a.features[a.parts[one].first].length > 0.0 or b.features[b.parts[other].first].length > 0.0


@kernel
def flush(rim: Feature, place: Vector, shapes: Shapes, i: int, slack: float, touch_m: float) -> Meeting:
    """Return how a place of a sharp rim, that of the object, lies on a sharp face, whose opposite normal is one of the
    rim; or that it does not.
    """
    face = shapes.features[i]
    out = scaled(vector_from(face.direction), -1.0)
    gap = dot(out, minus(vector_from(face.point), place))
    if face.kind != FACE or face.radius != 0.0 or abs(gap) > touch_m:
        return apart()
    if not reaches(shapes, i, scaled(out, -1.0), place, slack, 2.0 * touch_m):
        return apart()
    tangent = cross(vector_from(rim.direction), outward_at(rim, place))
    if abs(dot(tangent, out)) >= SIDE_BY_SIDE or beyond_normals(rim, place, out) > slack:
        return apart()
    return Meeting(True, gap, out, place)
