"""Where features that touched meet after their body has moved: a place that moves along a circle is followed."""

from __future__ import annotations

import math

from cagepose.kernels.algebra.record import Rows
from cagepose.kernels.algebra.vector import cross, norm, vector_from
from cagepose.kernels.boundary.circle_ahead import SAME_ANGLE
from cagepose.kernels.boundary.circle_first import place_near
from cagepose.kernels.boundary.circle_meeting import crosses_edge, write_place_on
from cagepose.kernels.boundary.features import CIRCLE, LINE, VERTEX, Feature, PlacedBoundary
from cagepose.kernels.boundary.meeting import meeting, seated
from cagepose.kernels.boundary.meetings import meeting_at
from cagepose.kernels.boundary.met import PARALLEL, Meeting, apart, swapped
from cagepose.kernels.circles.places import Place
from cagepose.kernels.native.kernel import kernel


@kernel
def meeting_kept(
    held: PlacedBoundary,
    i: int,
    cage: PlacedBoundary,
    j: int,
    angle: float,
    is_fixed: bool,
    touch_m: float,
    places: Rows[Place],
) -> Meeting:
    """Return how two placed features meet that touched at an angle of a circle, if one of them is one.

    ``is_fixed``: at this place of it, be it the nearest or not, as what lies all around does; else at the nearest place
    to it; of edges that cross, which may cross elsewhere, too, no farther along it than a place goes in a step. Memory:
    ``places``.
    """
    one, other = held.features[i], cage.features[j]
    if one.kind != CIRCLE and other.kind != CIRCLE:
        if is_fixed and one.kind == VERTEX and other.kind == LINE:
            return seated(one, other, angle)
        if is_fixed and one.kind == LINE and other.kind == VERTEX:
            return swapped(seated(other, one, angle))
        return meeting(held, i, cage, j)
    if is_fixed:
        write_place_on(one, other, angle, places[0])
        return meeting_at(held, i, cage, j, places[0])
    is_crossing = crosses_edge(one, other) if one.kind == CIRCLE else crosses_edge(other, one)
    at = place_near(one, other, angle, SAME_ANGLE if is_crossing else math.pi, touch_m, places)
    return meeting_at(held, i, cage, j, places[at]) if at >= 0 else apart()


@kernel
def crossed(one: Feature, other: Feature) -> bool:
    """Whether features that do not meet any more are edges that crossed: straight ones that have become parallel, or a
    circle and an edge, the two places of which have come together.
    """
    if one.kind == LINE and other.kind == LINE:
        return norm(cross(vector_from(one.direction), vector_from(other.direction))) < PARALLEL
    return (one.kind == CIRCLE and crosses_edge(one, other)) or (other.kind == CIRCLE and crosses_edge(other, one))
