"""The planar theory's answers for the paper's two cases, as a table."""

from __future__ import annotations

import math
from collections.abc import Callable

from cagepose.paper import planar
from cagepose.paper.blocks import Table
from cagepose.paper.paper_rows import MISALIGNMENT_RAD, SIDE_RAD, TILT_RAD
from cagepose.paper.planar import Requirement
from cagepose.paper.rail import PAPER_RAIL as RAIL


def planar_table() -> Table:
    """Return play, moments and requirements of the rail 0.1 deg out of line, at the pose that the weight leaves."""
    pitch = MISALIGNMENT_RAD + TILT_RAD
    x, _, z = RAIL.center_of_gravity_m
    weight = planar.gravity_moment_nm(1.0, x * math.cos(pitch) + z * math.sin(pitch))
    push = planar.push_pitch_moment_nm(1.0, pitch, RAIL.pin_height_m, RAIL.reach_m)
    pin_y_m = planar.first_pin_y_m(MISALIGNMENT_RAD, RAIL.pin_spacing_m)
    yaw_push = planar.push_yaw_moment_nm(1.0, MISALIGNMENT_RAD, pin_y_m, RAIL.reach_m)
    plate = (RAIL.roller_gap_m, RAIL.guide_thickness_m, RAIL.roller_spacing_m)
    channel = (RAIL.side_points_apart_m, RAIL.rail_gap_m, RAIL.roller_spacing_m)
    yaw_limit = planar.yaw_limit_rad(RAIL.pin_spacing_m, RAIL.reach_m)
    return Table(
        "The rail 0.1 deg out of line, as the weight leaves it",
        ["quantity", "pitch", "yaw"],
        [
            ["angle of the play, exactly", _deg(TILT_RAD), _deg(SIDE_RAD)],
            [
                "angle of the play, for small angles",
                _deg(planar.small_play_angle_rad(*plate)),
                _deg(planar.small_play_angle_rad(*channel)),
            ],
            ["range of the relative angle", _deg(2.0 * TILT_RAD), _deg(2.0 * SIDE_RAD)],
            ["moment of the weight, per newton", _lever(weight), "none about z"],
            ["moment of the push, per newton", _lever(push), _lever(yaw_push)],
            [
                "angle at which the push changes sides",
                _deg(planar.pitch_limit_rad(RAIL.pin_height_m, RAIL.reach_m)),
                _deg(yaw_limit),
            ],
            [
                "(Rq.1) the push turns the rail the right way",
                _answer(planar.push_opposes_weight(weight, push), _lever),
                _answer(planar.push_reduces_yaw(MISALIGNMENT_RAD, pin_y_m, RAIL.reach_m), _deg),
            ],
            [
                "(Rq.2) zero is within reach of the play",
                _answer(planar.zero_is_within_reach(MISALIGNMENT_RAD, TILT_RAD), _deg),
                _answer(planar.zero_is_within_reach(MISALIGNMENT_RAD, SIDE_RAD), _deg),
            ],
        ],
    )  # fmt: skip


def _deg(angle_rad: float) -> str:
    return f"{math.degrees(angle_rad):.4f} deg"


def _lever(moment_nm: float) -> str:
    return f"{moment_nm * 1000.0:+.3f} N mm"


def _answer(requirement: Requirement, unit: Callable[[float], str]) -> str:
    return f"{'yes' if requirement.holds else 'no'}, margin {unit(requirement.margin)}"
