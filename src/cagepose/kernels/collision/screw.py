"""First contact of one cage point with one box while the object moves on a screw: equation (2.3).

Seen from the box, coordinate k of the point runs along

    q_k(s) = q0_k + A_k (cos s - 1) + B_k sin s + D_k s,    A = u_perp, B = -a x u_perp, D = -pitch a.

All three come from the velocity V of the object at the point, for each radian: D = -a (a.V), B = -(V - a (a.V)),
A = a x B. The place of the axis itself is not used: it may lie a million sizes away, where the object hardly turns.

Between two zeros of its derivative q_k is monotone, so each piece holds at most one crossing of a face, which is
bracketed. cos s - 1 is taken as -2 sin^2(s/2): near s = 0, where re-contact is decided, nothing cancels. Contact is
decided by equation (2.5), see `cagepose.kernels.collision.travel`.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, scaled
from cagepose.kernels.collision.geometry import box_gap
from cagepose.kernels.native.kernel import kernel

Wave = tuple[float, float, float, float]
"""(gap, A, B, D): signed distance beyond a face, f(s) = gap - 2 A sin^2(s/2) + B sin s + D s."""

CROSSING_ITERATIONS = 256  # halving every fourth step, a bracket of 2 pi shrinks to one rounding in about 220
ROUNDING = 2.220446049250313e-16
SAFE = 1.0 + 1e-12
"""So that rounding rules out no crossing."""


@kernel
def wave_at(wave: Wave, s: float) -> float:
    half_sine = math.sin(0.5 * s)
    return wave[0] - 2.0 * wave[1] * half_sine * half_sine + wave[2] * math.sin(s) + wave[3] * s


@kernel
def steepest_slope(wave: Wave) -> float:
    """Return a bound on |f'|."""
    return math.sqrt(wave[1] * wave[1] + wave[2] * wave[2]) + abs(wave[3])


@kernel
def first_turning_points(wave: Wave) -> tuple[float, float]:
    """Return the two zeros of f' in [0, 2 pi), ascending (the others lie whole turns later); (inf, inf): f is monotone.

    f'(s) = -A sin s + B cos s + D = rho cos(s + phase) + D.
    """
    rho = math.sqrt(wave[1] * wave[1] + wave[2] * wave[2])
    if rho <= abs(wave[3]):
        return math.inf, math.inf
    phase = math.atan2(wave[1], wave[2])
    spread = math.acos(-wave[3] / rho)
    one = (spread - phase) % (2.0 * math.pi)
    other = (-spread - phase) % (2.0 * math.pi)
    return min(one, other), max(one, other)


@kernel
def monotone_end(turning_points: tuple[float, float], piece: int) -> float:
    """Return where monotone piece number ``piece`` ends (piece 0 starts at s = 0)."""
    turning_point = turning_points[piece % 2]
    return turning_point + (piece // 2) * 2.0 * math.pi


@kernel
def crossing(wave: Wave, start: float, end: float) -> float:
    """Return the first s with f < 0, to one rounding, where f falls monotonically from f(start) >= 0 to f(end) < 0.

    Newton steps inside a bracket. Each aims a rounding beyond the root, so that the bracket closes from both sides
    and its upper end, which is returned, is truly below the face; every fourth step halves the bracket, whatever the
    curve.
    """
    low, high = start, end
    s = 0.5 * (low + high)
    for iteration in range(CROSSING_ITERATIONS):
        value = wave_at(wave, s)
        if value < 0.0:
            high = s
        else:
            low = s
        rounding = ROUNDING * high
        if high - low <= 2.0 * rounding:
            break
        slope = -wave[1] * math.sin(s) + wave[2] * math.cos(s) + wave[3]
        newton = low
        if slope != 0.0:
            newton = s - value / slope + (-rounding if value < 0.0 else rounding)
        s = newton if low < newton < high and iteration % 4 != 3 else 0.5 * (low + high)
    return high


@kernel
def next_below(wave: Wave, s_from: float, s_end: float) -> float:
    """Return the first s in [s_from, s_end) from which on f < 0; inf: none."""
    if s_from >= s_end:
        return math.inf
    at_start = wave_at(wave, s_from) if s_from > 0.0 else wave[0]
    if at_start < 0.0:
        return s_from
    if at_start > SAFE * steepest_slope(wave) * (s_end - s_from):
        return math.inf
    turning_points = first_turning_points(wave)
    piece = 2 * int(s_from // (2.0 * math.pi))  # two pieces to a turn; those that ended before are passed over below
    start = s_from
    while start < s_end:
        end = min(monotone_end(turning_points, piece), s_end)
        piece += 1
        if end <= start:
            continue
        at_end = wave_at(wave, end)
        if at_end < 0.0:
            return start if at_start == 0.0 else crossing(wave, start, end)
        start, at_start = end, at_end
    return math.inf


@kernel
def last_not_below(wave: Wave, s_until: float) -> float:
    """Return the last s in [0, s_until] with f >= 0, given that f < 0 at ``s_until``; -inf: f < 0 all along."""
    if wave_at(wave, s_until) < -SAFE * steepest_slope(wave) * s_until:
        return -math.inf
    turning_points = first_turning_points(wave)
    found = -math.inf
    piece = 0
    start, at_start = 0.0, wave[0]
    while start < s_until:
        end = min(monotone_end(turning_points, piece), s_until)
        piece += 1
        if end <= start:
            continue
        at_end = wave_at(wave, end)
        if at_end >= 0.0:
            found = end
        elif at_start >= 0.0:
            found = start if at_start == 0.0 else crossing(wave, start, end)
        start, at_start = end, at_end
    return found


@kernel
def face_waves(
    point_box: Vector, u_perp: Vector, w: Vector, rise: Vector, half_size: Vector, grow_m: float
) -> tuple[Wave, ...]:
    """Return f for the six faces of the box grown by ``grow_m``."""
    x, y, z = half_size[0] + grow_m, half_size[1] + grow_m, half_size[2] + grow_m
    return (
        (point_box[0] - x, u_perp[0], -w[0], -rise[0]),
        (-point_box[0] - x, -u_perp[0], w[0], rise[0]),
        (point_box[1] - y, u_perp[1], -w[1], -rise[1]),
        (-point_box[1] - y, -u_perp[1], w[1], rise[1]),
        (point_box[2] - z, u_perp[2], -w[2], -rise[2]),
        (-point_box[2] - z, -u_perp[2], w[2], rise[2]),
    )


@kernel
def entry_start(waves: tuple[Wave, ...], s_inside: float) -> float:
    """Return the start of the interval around ``s_inside`` in which all f < 0; -inf: it holds from the start."""
    start = -math.inf
    for wave in waves:
        start = max(start, last_not_below(wave, s_inside))
    return start


@kernel
def screw_entry(
    point_box: Vector,
    velocity_box: Vector,
    axis_box: Vector,
    angle_end_rad: float,
    half_size: Vector,
    allowed_depth_m: float,
    resolution_m: float,
) -> float:
    """Return the angle at which the point enters the box; 0: blocked at once; inf: not before ``angle_end_rad``.

    Parameters
    ----------
    point_box
        The cage point at the start, in the box's frame, metres.
    velocity_box
        How far the object moves where the point is, for each radian of turning, at the start, metres, in the box's
        frame: a x u + pitch a.
    axis_box
        Unit vector of the axis in the box's frame. The object turns right-handed.
    angle_end_rad
        Where to stop looking, finite and above 0; more than one turn is fine.
    half_size
        Half edge lengths, metres.
    allowed_depth_m, resolution_m
        See equation (2.5) in `cagepose.kernels.collision.travel`; metres.
    """
    rise = scaled(axis_box, dot(axis_box, velocity_box))
    w = minus(velocity_box, rise)
    u_perp = cross(w, axis_box)

    inner_waves = face_waves(point_box, u_perp, w, rise, half_size, -allowed_depth_m)
    for wave in inner_waves:  # too far beyond one face to cross it: nothing need be asked of the others
        if wave[0] > SAFE * steepest_slope(wave) * angle_end_rad:
            return math.inf
    inner = 0.0
    moved = True
    while moved:  # each pass moves on to another crossing, of which there are finitely many before the end
        moved = False
        for wave in inner_waves:
            following = next_below(wave, inner, angle_end_rad)
            if following == math.inf:
                return math.inf
            if following > inner:
                inner = following
                moved = True
    if box_gap(point_box, half_size) <= resolution_m:
        outer_waves = face_waves(point_box, u_perp, w, rise, half_size, resolution_m)
        if entry_start(outer_waves, inner) == -math.inf:
            return 0.0
    return max(0.0, min(inner, entry_start(face_waves(point_box, u_perp, w, rise, half_size, 0.0), inner)))
