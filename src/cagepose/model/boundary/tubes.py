"""Parts of tori: circles with the tube around them, which end at circles about the axis and at circles of the tube."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from cagepose.kernels.boundary.features import CIRCLE
from cagepose.kernels.circles.places import within_turn
from cagepose.model.boundary.blocks import Row
from cagepose.model.boundary.curves import ARC, Curve
from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose, turn_from_z
from cagepose.model.surfaces import TORUS, Surface

if TYPE_CHECKING:
    from cagepose.model.boundary.exact_surface import ExactSurface

SAME_ANGLE = 1e-6
"""Radians between ends of a part of a torus that are one, and between normals of a face that goes over into another."""
BEYOND_END = 1e-4
"""Radians: middles of the triangles of a part are no farther beyond its ends."""
ALONG_AXIS = 0.5
"""Cosine between the axis of a curve and that of its torus: a curve about the axis has more, one of the tube less."""


class TubePart(NamedTuple):
    """What of a torus a region is: the angles of its normals from the plane of its circle, of which it has those from
    ``low`` to ``high``, and the arc of its circle, ``width`` wide from ``start`` on, radians.
    """

    low: float
    high: float
    start: float
    width: float


def tube_part(surface: ExactSurface, region: int) -> TubePart | None:
    """Return what of its torus a region is; None: it is no part that four circles end, or fewer."""
    torus = surface.regions.surfaces[region]
    curves = [curve for curve in surface.curves if region in (curve.left, curve.right)]
    if torus.radius_m < 0.0 or any(curve.kind != ARC for curve in curves):
        return None
    around = [curve for curve in curves if abs(float(curve.axis @ np.array(torus.axis))) > ALONG_AXIS]
    across = [curve for curve in curves if abs(float(curve.axis @ np.array(torus.axis))) <= ALONG_AXIS]
    of_region = surface.triangles[surface.regions.of_triangles == region]
    frame = _frame_of(torus)
    middles = _middles(torus, frame, surface.vertices_m[of_region])
    psi = _between([_end_psi(surface, region, curve, frame) for curve in around], middles[:, 0])
    turn = _between([_end_turn(torus, curve, frame) for curve in across], middles[:, 1])
    if psi is None or turn is None:
        return None
    farthest = max(abs(psi[0]), abs(psi[0] + psi[1]))
    if torus.core_m < torus.radius_m and farthest > math.acos(-torus.core_m / torus.radius_m) + SAME_ANGLE:
        return None
    return TubePart(psi[0], psi[0] + psi[1], *turn)


def torus_of(surface: ExactSurface, region: int, number: int) -> Row:
    """Return a part of a torus as a feature of part ``number``: a circle with a radius."""
    torus, part = surface.regions.surfaces[region], tube_part(surface, region)
    assert part is not None, "of others nothing is exact"
    center, axis, frame = np.array(torus.point_m), np.array(torus.axis), _frame_of(torus)
    reach = torus.core_m * np.sqrt(np.maximum(0.0, 1.0 - axis**2)) + torus.radius_m
    numbers = (torus.core_m, torus.radius_m, 0.0, *part)
    box = np.stack([center - reach, center + reach])
    return Row(CIRCLE, number, center, axis, frame[:, 0], *numbers, [], torus.radius_m, box)


def ends_inner_tube(surface: ExactSurface, curve: Curve) -> bool:
    """Whether a curve is a circle of the tube at which a part of a torus ends whose normals lead toward the axis: a
    flat face that lies on what goes on there straight lies on this circle.
    """
    found = False
    for region in (curve.left, curve.right):
        torus = surface.regions.surfaces[region]
        if torus.kind == TORUS and curve.kind == ARC and abs(float(curve.axis @ np.array(torus.axis))) <= ALONG_AXIS:
            part = tube_part(surface, region)
            found = found or (part is not None and max(-part.low, part.high) > 0.5 * math.pi + SAME_ANGLE)
    return found


def _frame_of(torus: Surface) -> FloatArray:
    """Return unit vectors across the axis of a torus and along it as columns, (3, 3)."""
    return Pose(np.array(torus.point_m), turn_from_z(np.array(torus.axis))).rotation


def _middles(torus: Surface, frame: FloatArray, corners_m: FloatArray) -> FloatArray:
    """Return angles of normals from the plane of the circle, and angles around the axis, in the middle of triangles,
    (n, 2): the mean of those at their corners, (n, 3, 3), which are on the torus, as no other place of them is.
    """
    seen = (corners_m - np.array(torus.point_m)) @ frame
    off = np.hypot(seen[..., 0], seen[..., 1]) - torus.core_m
    angles = np.stack([np.arctan2(seen[..., 2], off), np.arctan2(seen[..., 1], seen[..., 0])], axis=-1)
    found: FloatArray = np.unwrap(angles, axis=1).mean(axis=1)
    return found


def _end_psi(surface: ExactSurface, region: int, curve: Curve, frame: FloatArray) -> float:
    """Return the angle of the normals at a circle about the axis; if another face goes on there evenly, that of its
    normals, as the place of the circle does not tell it well.
    """
    torus, other = surface.regions.surfaces[region], curve.left + curve.right - region
    place = surface.vertices_m[curve.nodes[:1]]
    rise = float((curve.center_m - np.array(torus.point_m)) @ np.array(torus.axis))
    psi = math.atan2(rise, curve.radius_m - torus.core_m)
    x, y, z = (surface.regions.surfaces[other].normals(place)[0] @ frame).tolist()
    across = (place[0] - np.array(torus.point_m)) @ frame[:, :2]
    beside = math.atan2(z, float(across @ (x, y)) / float(np.linalg.norm(across)))
    if surface.regions.is_exact[other] and abs(within_turn(beside - psi)) < SAME_ANGLE:
        return beside
    return psi


def _end_turn(torus: Surface, curve: Curve, frame: FloatArray) -> float:
    """Return the angle around the axis of a circle of the tube."""
    x, y, _ = ((curve.center_m - np.array(torus.point_m)) @ frame).tolist()
    return math.atan2(y, x)


def _between(ends: Sequence[float], middles: FloatArray) -> tuple[float, float] | None:
    """Return where a range of angles between two ends begins that holds all middles, and how wide it is: without ends
    a whole turn; None: there is none.
    """
    different = list[float]()
    for end in ends:
        if all(abs(within_turn(end - other)) > SAME_ANGLE for other in different):
            different.append(end)
    if not different:
        return -math.pi, 2.0 * math.pi
    if len(different) != 2:
        return None
    for low, high in (different, different[::-1]):
        width = (high - low) % (2.0 * math.pi)
        beyond = max(abs(within_turn(float(middle) - low - 0.5 * width)) for middle in middles) - 0.5 * width
        if beyond <= BEYOND_END:
            return within_turn(low), width
    return None
