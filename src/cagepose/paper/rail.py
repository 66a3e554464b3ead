"""The paper's rail with any misalignment, play, roller distance and pin: the twin of ``scenes/rail-*.yaml``.

Which dimensions are the paper's and which are a reconstruction: docs/theory, "The rail".
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from cagepose.model.box import Box
from cagepose.model.cage import Cage
from cagepose.model.load import Force, Load
from cagepose.model.parts import Object
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.model.tolerances import Tolerances
from cagepose.runs.run import Run

Angle = Literal["yaw", "pitch", "roll"]
ANGLES: tuple[Angle, ...] = ("yaw", "pitch", "roll")
"""In the order of ZYX Euler angles."""

RAIL_LENGTH_M = 1.200
GUIDE_WIDTH_M = 0.004
WEB_THICKNESS_M = 0.0005
UPPER_ROLLER_OFFSET_M = 0.03155
"""Sideways, where a roller above or below touches its guide plate; ours, like the lengths above."""


@dataclass(frozen=True)
class RailDimensions:
    """The rail's dimensions, metres; left out: those of the paper, and of its reconstruction where it has none.

    Attributes
    ----------
    roller_spacing_m
        Distance of the rollers along the rail (the paper's L_roller).
    roller_gap_m, guide_thickness_m
        Between upper and lower rollers, and of the guide plates between them. Their difference is the vertical play.
    rail_gap_m, side_roller_gap_m, side_roller_radius_m
        Between the guide plates' inner faces (W_rail), between left and right side rollers (W_roller), and r.
    pin_height_m, reach_m
        How far the pins' tips lie below and ahead of the centre of rotation O (H_pin and L).
    pin_spacing_m
        Between the two pins (W_pin); inferred from the limit of 1.91 deg.
    center_of_gravity_m
        In the rail's frame; inferred.
    """

    roller_spacing_m: float = 0.183
    roller_gap_m: float = 0.002
    guide_thickness_m: float = 0.001
    rail_gap_m: float = 0.0601
    side_roller_gap_m: float = 0.0432
    side_roller_radius_m: float = 0.00792
    pin_height_m: float = 0.060747
    reach_m: float = 0.600
    pin_spacing_m: float = 0.040
    center_of_gravity_m: tuple[float, float, float] = (0.100, 0.0, -0.020)

    @property
    def side_points_apart_m(self) -> float:
        """Between the places where left and right side rollers touch, W_roller + 2 r."""
        return self.side_roller_gap_m + 2.0 * self.side_roller_radius_m


PAPER_RAIL = RailDimensions()


def rail_scene(
    rail: RailDimensions = PAPER_RAIL,
    *,
    misalignment_zyx: tuple[float, float, float] = (0.0, 0.0, 0.0),
    pin_y_m: float | None = None,
    tolerances: Tolerances | None = None,
    name: str = "rail",
) -> Scene:
    """Return the rail between its rollers: it settles under its weight, then a pin's tip is pushed along x.

    Parameters
    ----------
    rail
        Dimensions.
    misalignment_zyx
        Yaw, pitch and roll of the roller frame about O, radians. The rail starts at the same pose.
    pin_y_m
        Sideways position of the pin that is pushed; None: the left one, half the pin spacing.
    tolerances, name
        As in `Scene`.
    """
    pose = Pose(euler_zyx=misalignment_zyx)
    tip_m = (-rail.reach_m, rail.pin_spacing_m / 2.0 if pin_y_m is None else pin_y_m, -rail.pin_height_m)
    return Scene(
        Object(_boxes(rail), rail.center_of_gravity_m, pose=pose),
        Cage(_points(rail), pose=pose),
        [Load("weight", gravity=(0.0, 0.0, -1.0)), Load("push", force=Force((1.0, 0.0, 0.0), tip_m))],
        name=name,
        tolerances=tolerances,
    )


def misalignment(angle: Angle, value_rad: float) -> tuple[float, float, float]:
    """Return yaw, pitch and roll of rollers that are out of line in one angle alone."""
    yaw, pitch, roll = (value_rad if name == angle else 0.0 for name in ANGLES)
    return yaw, pitch, roll


def relative_tilt_rad(run: Run, phase_index: int) -> float:
    """Return the rail's pitch relative to its rollers at the end of a phase, radians.

    It is the angle of the rail's z axis n in the rollers' xz plane, atan2(n_x, n_z), which (4.3) speaks of. The ZYX
    pitch differs from it by the yaw, 1e-5 of it.
    """
    axis_world = run.phases[phase_index].pose.rotation[:, 2]
    n = run.scene.cage.pose_world_cage.rotation.T @ axis_world
    return math.atan2(n[0], n[2])


def _boxes(rail: RailDimensions) -> list[Box]:
    inner = rail.rail_gap_m / 2.0
    guide = (RAIL_LENGTH_M, GUIDE_WIDTH_M, rail.guide_thickness_m)
    web = (RAIL_LENGTH_M, WEB_THICKNESS_M, 0.006)
    boxes = (
        ("left guide", guide, (0.0, inner + GUIDE_WIDTH_M / 2.0, 0.0)),
        ("right guide", guide, (0.0, -inner - GUIDE_WIDTH_M / 2.0, 0.0)),
        ("body", (RAIL_LENGTH_M, 0.080, 0.040), (0.0, 0.0, -0.040)),
        ("rack", (0.020, 0.010, 0.030), (0.0, 0.0, -0.005)),
        ("left web", web, (0.0, inner + WEB_THICKNESS_M / 2.0, 0.0)),
        ("right web", web, (0.0, -inner - WEB_THICKNESS_M / 2.0, 0.0)),
    )
    return [Box(size, Pose(position), name) for name, size, position in boxes]


def _points(rail: RailDimensions) -> np.ndarray:
    """C1 to C8 above and below the guides, C9 to C12 beside the webs, C13 and C14 the stops."""
    x, z, side = rail.roller_spacing_m / 2.0, rail.roller_gap_m / 2.0, rail.side_points_apart_m / 2.0
    points = [(sx * x, sy * UPPER_ROLLER_OFFSET_M, sz * z) for sx in (-1, 1) for sy in (-1, 1) for sz in (-1, 1)]
    points += [(sx * x, sy * side, 0.0) for sx in (-1, 1) for sy in (-1, 1)]
    points += [(0.011, 0.0, 0.0), (-0.011, 0.0, 0.0)]
    return np.array(points)
