"""The paper's planar theory of the rail (its section IV): play, moments and what lining up requires.

Equations (6.x): docs/theory/planar. Signs are right-handed throughout: a positive pitch or moment is about +y and
lowers what lies at +x, a positive yaw or moment is about +z and takes +x towards +y. The rail's front, where the pins
are, points along -x. O is the centre of rotation, the origin of the rail's frame.
"""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Requirement:
    """The answer to one of the paper's requirements.

    Attributes
    ----------
    holds
        Whether it is met.
    margin
        By how much: positive if it holds, negative by how much it fails. Each function says in what unit.
    """

    holds: bool
    margin: float


def play_angle_rad(points_apart_m: float, faces_apart_m: float, spacing_m: float) -> float:
    """Return how far two parallel faces can turn from level between two pairs of points, exactly (6.1).

    Parameters
    ----------
    points_apart_m
        Distance a between the two points of a pair, across the faces.
    faces_apart_m
        Distance b between the faces. Below a: a plate between the points. Above a: a channel around them.
    spacing_m
        Distance l between the two pairs, along the faces.

    Returns
    -------
    float
        The angle t above zero with (a/2) cos t - (l/2) sin t = b/2 for a plate, and a plus for a channel. The faces can
        turn by as much to either side, so the full range is twice this.
    """
    half_points, half_spacing = points_apart_m / 2.0, spacing_m / 2.0
    radius = math.hypot(half_points, half_spacing)
    # As atan2 - asin of two small angles: acos - atan2 of two near pi/2 would cancel digits when the play is small.
    return abs(math.atan2(half_points, half_spacing) - math.asin(faces_apart_m / 2.0 / radius))


def small_play_angle_rad(points_apart_m: float, faces_apart_m: float, spacing_m: float) -> float:
    """Return `play_angle_rad` for small angles: the play over the spacing, ``|a - b| / l`` (6.2)."""
    return abs(points_apart_m - faces_apart_m) / spacing_m


def gravity_moment_nm(weight_n: float, center_of_gravity_x_m: float) -> float:
    """Return the moment of the weight about O around +y, M_G = W x (6.3).

    ``center_of_gravity_x_m`` is horizontal, in the world, from O. Positive where the weight lies behind O: it lifts the
    pins.
    """
    return weight_n * center_of_gravity_x_m


def push_pitch_moment_nm(force_n: float, pitch_rad: float, pin_height_m: float, reach_m: float) -> float:
    """Return the moment of a push along +x at a pin's tip about O around +y, T = -F (H cos p - L sin p) (6.4).

    The paper prints it without the minus sign, and then says T < 0, as it is here: below `pitch_limit_rad` the push
    lowers the pins.
    """
    return -force_n * (pin_height_m * math.cos(pitch_rad) - reach_m * math.sin(pitch_rad))


def push_yaw_moment_nm(force_n: float, yaw_rad: float, pin_y_m: float, reach_m: float) -> float:
    """Return the moment of a push along +x at a pin's tip about O around +z, M_F = -F (y cos w - L sin w) (6.5).

    ``pin_y_m`` is the tip's sideways position in the rail's frame; half the pin spacing, with its sign. The paper
    prints ``|w|``, which is this at the pin that touches first (`first_pin_y_m`), again without the minus sign.
    """
    return -force_n * (pin_y_m * math.cos(yaw_rad) - reach_m * math.sin(yaw_rad))


def pitch_limit_rad(pin_height_m: float, reach_m: float) -> float:
    """Return the pitch at which T changes its sign, atan(H / L) (6.6)."""
    return math.atan2(pin_height_m, reach_m)


def yaw_limit_rad(pin_spacing_m: float, reach_m: float) -> float:
    """Return the yaw at which M_F at the pin that touches first changes its sign, atan(W / 2 L) (6.6)."""
    return math.atan2(pin_spacing_m / 2.0, reach_m)


def first_pin_y_m(yaw_rad: float, pin_spacing_m: float) -> float:
    """Return the sideways position of the pin whose tip lies farther ahead: the left one (+y) at a positive yaw."""
    return math.copysign(pin_spacing_m / 2.0, yaw_rad)


def push_opposes_weight(gravity_moment: float, push_moment: float) -> Requirement:
    """Say whether a push turns the rail against its weight: (Rq.1) in pitch (6.7).

    The moments, in N m, must have opposite signs. The margin is what the smaller of them may lose before that changes,
    in N m.
    """
    least = min(abs(gravity_moment), abs(push_moment))
    holds = gravity_moment * push_moment < 0.0
    return Requirement(holds, least if holds else -least)


def push_reduces_yaw(yaw_rad: float, pin_y_m: float, reach_m: float) -> Requirement:
    """Say whether a push at a pin turns the rail's yaw back towards zero: (Rq.1) in yaw (6.7).

    The margin is how far the yaw is from where the moment changes its sign, in radians. At the pin that touches second
    the push turns the rail away from zero at every yaw. A yaw of zero cannot be reduced either.
    """
    limit = yaw_limit_rad(2.0 * abs(pin_y_m), reach_m)
    margin = limit - abs(yaw_rad) if yaw_rad * pin_y_m > 0.0 else -limit - abs(yaw_rad)
    return Requirement(margin > 0.0, margin)


def zero_is_within_reach(misalignment_rad: float, play_angle_rad: float) -> Requirement:
    """Say whether the rail can lie at zero though its rollers do not: (Rq.2), ``|misalignment| <= play angle`` (6.8).

    The margin is how much more misalignment the play allows, in radians.
    """
    margin = play_angle_rad - abs(misalignment_rad)
    return Requirement(margin >= 0.0, margin)
