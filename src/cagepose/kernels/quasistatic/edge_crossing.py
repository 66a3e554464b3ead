"""Where a sliding contact runs over the edge of its face: the point's other two coordinates on the screw (2.3)."""

from __future__ import annotations

import math

from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, plus, row, scaled
from cagepose.kernels.collision.geometry import Geometry, Placement, box_point, point_in_box, vector_in_box
from cagepose.kernels.collision.screw import next_below
from cagepose.kernels.contact.contact_set import ContactSet, stays_on_face
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.quasistatic.straying import STRAYED, strayed

CLEAR = 2.0
"""In touch tolerances: how far beyond the edge a contact is let go, so that it does not touch the next face too."""


@kernel
def travel_to_edge(coordinate: float, rate: float, limit: float) -> float:
    """Return when a coordinate that grows by ``rate`` leaves [-limit, limit]."""
    if rate == 0.0:
        return math.inf
    return max(0.0, (math.copysign(limit, rate) - coordinate) / rate)


@kernel
def first_edge_crossing(
    geometry: Geometry,
    placement: Placement,
    contacts: ContactSet,
    center: Vector,
    quaternion: Quaternion,
    velocity: Vector,
    spin: Vector,
    end: float,
    touch_m: float,
) -> float:
    """Return the amount of a twist, up to ``end``, after which a contact leaves the face that it stays on; inf: none.

    Where it would only because contacts stray, by the square of the way, it is passed over: they are put back.
    """
    first = math.inf
    rate = norm(spin)
    for i in range(contacts.used[0]):
        contact = contacts.rows[i]
        if not stays_on_face(contacts, i):
            continue
        box = contact.box
        half_size = row(geometry.half_sizes, box)
        point_box = box_point(placement, box, contact.point)
        spin_box = vector_in_box(placement, box, spin)
        arm = minus(point_box, point_in_box(placement, box, center))
        moves = plus(vector_in_box(placement, box, velocity), cross(spin_box, arm))
        for k in range(3):
            if k == contact.axis:
                continue
            limit = half_size[k] + CLEAR * touch_m
            if rate == 0.0:
                first = min(first, travel_to_edge(point_box[k], -moves[k], limit))
                continue
            axis = scaled(spin_box, 1.0 / rate)
            per_radian = scaled(moves, 1.0 / rate)
            rise = scaled(axis, dot(axis, per_radian))
            across = minus(per_radian, rise)
            lever = cross(across, axis)
            for side in (1.0, -1.0):
                wave = (limit - side * point_box[k], -side * lever[k], side * across[k], side * rise[k])
                crossing = next_below(wave, 0.0, end * rate) / rate
                if crossing < first and crossing <= end:
                    reach = STRAYED * strayed(geometry, contacts, center, quaternion, velocity, spin, crossing)
                    if wave[0] > reach:
                        first = crossing
    return first if first <= end else math.inf
