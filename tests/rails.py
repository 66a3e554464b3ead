"""The rail of `cagepose.paper.rail` for tests: millimetres and degrees, as in the scene files."""

from __future__ import annotations

import math

from cagepose import Run, Scene, Tolerances
from cagepose.paper.planar import play_angle_rad
from cagepose.paper.rail import PAPER_RAIL, RailDimensions, relative_tilt_rad
from cagepose.paper.rail import rail_scene as build

MM = 1e-3
SIDE_PLAY_MM = (PAPER_RAIL.rail_gap_m - PAPER_RAIL.side_points_apart_m) / MM


def rail_scene(
    *,
    yaw_deg: float = 0.0,
    pitch_deg: float = 0.0,
    roll_deg: float = 0.0,
    play_mm: float = 1.0,
    spacing_mm: float = 183.0,
    cog_y_mm: float = 0.0,
    pin_y_mm: float = 20.0,
    touch: float | None = None,
) -> Scene:
    """Build the scene; the object starts at the cage's pose."""
    rail = RailDimensions(
        roller_spacing_m=spacing_mm * MM,
        roller_gap_m=(1.0 + play_mm) * MM,
        center_of_gravity_m=(0.100, cog_y_mm * MM, -0.020),
    )
    return build(
        rail,
        misalignment_zyx=(math.radians(yaw_deg), math.radians(pitch_deg), math.radians(roll_deg)),
        pin_y_m=pin_y_mm * MM,
        tolerances=None if touch is None else Tolerances(touch=touch),
    )


def exact_tilt_deg(play_mm: float, spacing_mm: float) -> float:
    """Tilt at which a plate 1 mm thick touches above and below at rollers ``spacing`` apart, (4.4)."""
    return math.degrees(play_angle_rad(1.0 + play_mm, 1.0, spacing_mm))


def tilt_deg(run: Run, phase: int) -> float:
    """Angle of the object's z axis in the cage's xz plane, atan2(n_x, n_z), at the end of a phase."""
    return math.degrees(relative_tilt_rad(run, phase))
