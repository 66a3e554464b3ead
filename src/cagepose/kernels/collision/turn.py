"""First contact of one cage point with one box while the object turns: equation (2.2).

Seen from the box the point runs backwards on a circle. With u = q0 - P, u_perp its part across the axis a and w = a x
u_perp,

    q(s) = q0 + u_perp (cos s - 1) - w sin s,    0 < s < 2 pi.

Angles are ordered by c = -cot(s/2), which grows from -inf (s = 0) to +inf (a full turn) and needs no trigonometry: with
cos s = (c^2 - 1)/(c^2 + 1) and sin s = -2 c/(c^2 + 1), "below the face b" becomes a quadratic inequality in c,

    (q0_k - b) c^2 + 2 w_k c + (q_pi_k - b) < 0,    q_pi = q0 - 2 u_perp.                        (2.6)

The leading coefficient is the gap at the start, so nothing is lost near s = 0, where re-contact is decided (ordering by
1 - cos s has no digits left there). Six such inequalities, one for each face, make the box. Contact is then decided by
equation (2.5), see `cagepose.kernels.collision.travel`.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, scaled
from cagepose.kernels.collision.boxes import box_gap
from cagepose.kernels.native.kernel import kernel

SAFE = 1e-12
"""Fraction of a key. It keeps rounding from passing over what comes first."""
Below = tuple[float, float, bool]
"""Solution set of one inequality in c: (first, second, between). Between the roots, or outside of them."""


@kernel
def below_face(gap: float, half_slope: float, gap_pi: float) -> Below:
    """Solve gap c^2 - 2 half_slope c + gap_pi < 0.

    ``gap`` and ``gap_pi`` are the signed distances beyond the face at s = 0 and s = pi. "Always" is written as outside
    (inf, inf), "never" as between (inf, inf).
    """
    discriminant = half_slope * half_slope - gap * gap_pi
    if discriminant <= 0.0:
        # No crossing. A point that touches the face's plane and never moves (gap, slope and gap_pi zero) is not below
        # it.
        return math.inf, math.inf, not (gap < 0.0 or gap_pi < 0.0)
    # The stable pair of roots: no cancellation in `pivot`.
    pivot = half_slope + math.copysign(math.sqrt(discriminant), half_slope)
    one = math.copysign(math.inf, pivot) if gap == 0.0 else pivot / gap
    other = gap_pi / pivot
    return min(one, other), max(one, other), gap >= 0.0


@kernel
def box_faces(
    point_box: Vector, w: Vector, point_pi_box: Vector, half_size: Vector, grow_m: float
) -> tuple[Below, ...]:
    """Return the six inequalities (2.6) of the box grown by ``grow_m``."""
    x, y, z = half_size[0] + grow_m, half_size[1] + grow_m, half_size[2] + grow_m
    return (
        below_face(point_box[0] - x, -w[0], point_pi_box[0] - x),
        below_face(-point_box[0] - x, w[0], -point_pi_box[0] - x),
        below_face(point_box[1] - y, -w[1], point_pi_box[1] - y),
        below_face(-point_box[1] - y, w[1], -point_pi_box[1] - y),
        below_face(point_box[2] - z, -w[2], point_pi_box[2] - z),
        below_face(-point_box[2] - z, w[2], -point_pi_box[2] - z),
    )


@kernel
def first_common(faces: tuple[Below, ...]) -> float:
    """Return the start of the first interval of positive length in which all inequalities hold; inf: there is none."""
    key = -math.inf
    moved = True
    while moved:  # each pass moves on to one of at most 12 roots
        moved = False
        for face in faces:
            first, second, between = face
            if between:
                if key < first:
                    key = first
                    moved = True
                elif key >= second:
                    return math.inf
            elif first <= key < second:
                key = second
                moved = True
        if key == math.inf:
            return math.inf
    return key


@kernel
def common_start(faces: tuple[Below, ...], key: float) -> float:
    """Return the start of the interval around ``key`` in which all inequalities hold."""
    start = -math.inf
    for face in faces:
        first, second, between = face
        if between:
            start = max(start, first)
        elif key > second or key - first > second - key:  # nearer to the far root: `key` may miss it by rounding
            start = max(start, second)
    return start


@kernel
def beyond_until(
    point_box: Vector, w: Vector, point_pi_box: Vector, half_size: Vector, allowed_depth_m: float, resolution_m: float
) -> float:
    """Return a key up to which the point stays beyond one face, that which it is farthest beyond; -inf: none is known.

    It answers for most pairs, at a ninth of the cost of the whole box.
    """
    k = 0
    for other in range(1, 3):
        if abs(point_box[other]) - half_size[other] > abs(point_box[k]) - half_size[k]:
            k = other
    sign = math.copysign(1.0, point_box[k])
    gap, gap_pi, half_slope = sign * point_box[k] - half_size[k], sign * point_pi_box[k] - half_size[k], -sign * w[k]
    first, second, between = below_face(gap - resolution_m, half_slope, gap_pi - resolution_m)
    if between:
        return first
    # It touches. Once beyond the grown face it has left, and does not go in before it comes back through that face.
    inner_first, _, inner_between = below_face(gap + allowed_depth_m, half_slope, gap_pi + allowed_depth_m)
    return second if inner_between and inner_first > second else -math.inf


@kernel
def entry_of_box(
    point_box: Vector, w: Vector, point_pi_box: Vector, half_size: Vector, allowed_depth_m: float, resolution_m: float
) -> float:
    """Return the key at which the point enters the box, from all its faces; see `turn_entry`."""
    inner_key = first_common(box_faces(point_box, w, point_pi_box, half_size, -allowed_depth_m))
    if inner_key == math.inf:
        return math.inf
    if box_gap(point_box, half_size) <= resolution_m:
        outer = box_faces(point_box, w, point_pi_box, half_size, resolution_m)
        if common_start(outer, inner_key) == -math.inf:
            return -math.inf
    return min(inner_key, common_start(box_faces(point_box, w, point_pi_box, half_size, 0.0), inner_key))


@kernel
def turn_entry(
    point_box: Vector,
    through_box: Vector,
    axis_box: Vector,
    half_size: Vector,
    allowed_depth_m: float,
    resolution_m: float,
    least: float,
) -> float:
    """Return the key c = -cot(s/2) of the angle at which the point enters the box; -inf: blocked at once; inf: never.

    Also inf where it is clear that the key is above ``least``: so -inf asks only whether the point blocks at once.

    Parameters
    ----------
    point_box
        The cage point at the start, in the box's frame, metres.
    through_box, axis_box
        A point on the axis, metres, and its unit vector, in the box's frame. The object turns right-handed.
    half_size
        Half edge lengths, metres.
    allowed_depth_m, resolution_m
        See equation (2.5) in `cagepose.kernels.collision.travel`; metres.
    least
        What the key is compared with.
    """
    u = minus(point_box, through_box)
    w = cross(axis_box, u)
    u_perp = minus(u, scaled(axis_box, dot(axis_box, u)))
    for k in range(3):  # the whole circle lies beyond one face: most pairs end here
        across = abs(point_box[k] - u_perp[k]) - half_size[k] + allowed_depth_m
        if across >= 0.0 and across * across >= u_perp[k] * u_perp[k] + w[k] * w[k]:
            return math.inf
    point_pi_box = minus(point_box, scaled(u_perp, 2.0))
    clear = beyond_until(point_box, w, point_pi_box, half_size, allowed_depth_m, resolution_m)
    if clear == math.inf or clear - SAFE * (1.0 + abs(clear)) > least:
        return math.inf
    return entry_of_box(point_box, w, point_pi_box, half_size, allowed_depth_m, resolution_m)


@kernel
def key_of_angle(angle_rad: float) -> float:
    """Return c = -cot(s/2) for 0 < s < 2 pi."""
    return -1.0 / math.tan(0.5 * angle_rad)


@kernel
def angle_of_key(key: float) -> float:
    """Return the angle s of the key c = -cot(s/2), from 0 (c = -inf) to 2 pi (c = inf)."""
    return 2.0 * math.atan2(1.0, -key)
