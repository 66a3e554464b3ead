"""From which misalignments does the push bring the rail towards zero? The paper's case, over a range of angles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cagepose.model.checks import FloatArray
from cagepose.paper.planar import play_angle_rad
from cagepose.paper.rail import ANGLES, PAPER_RAIL, Angle, RailDimensions, misalignment, rail_scene
from cagepose.runs.many import run_many
from cagepose.runs.variation import Variation

LEAST_CHANGE_RAD = float(np.radians(0.001))
"""A rail that only yaws changes its other ZYX angles by up to 0.0009 deg; what is less than this counts as none."""
ZERO_ANGLE_RAD = 1e-9
"""An angle below this is zero."""


@dataclass(frozen=True, eq=False)
class RangeStudy:
    """Where a rail comes to rest, for n misalignments of its rollers.

    Attributes
    ----------
    method, misaligned, pin_y_m
        How it was run, the angle that was varied, and the pin that was pushed.
    misalignments_rad
        (n,).
    after_weight_rad, after_push_rad
        Yaw, pitch and roll of the rail in the world at the end of each phase, (n, 3); NaN where a run did not come so
        far.
    verdicts
        Of each run, n.
    permitted_rad
        The planar theory's limit of ``|misalignment|`` for this angle, (6.8); None: the theory has none (roll).
    """

    method: str
    misaligned: Angle
    pin_y_m: float
    misalignments_rad: FloatArray
    after_weight_rad: FloatArray
    after_push_rad: FloatArray
    verdicts: tuple[str, ...]
    permitted_rad: float | None

    def improved(self) -> np.ndarray:
        """Whether the push left the angle that was varied nearer to zero than the weight had, (n,) of bool."""
        before, after = self._varied_angle()
        improved: np.ndarray = np.abs(after) < np.abs(before) - LEAST_CHANGE_RAD
        return improved

    def passes_zero(self) -> np.ndarray:
        """Whether the push takes the angle that was varied from one side of zero to the other, (n,) of bool."""
        before, after = self._varied_angle()
        passes: np.ndarray = (np.minimum(before, after) < -ZERO_ANGLE_RAD) & (
            np.maximum(before, after) > ZERO_ANGLE_RAD
        )
        return passes & (np.abs(after - before) > LEAST_CHANGE_RAD)

    def _varied_angle(self) -> tuple[FloatArray, FloatArray]:
        column = ANGLES.index(self.misaligned)
        return self.after_weight_rad[:, column], self.after_push_rad[:, column]


def range_study(
    misaligned: Angle,
    misalignments_rad: Sequence[float] | FloatArray,
    pin_y_m: float,
    method: str,
    rail: RailDimensions = PAPER_RAIL,
) -> RangeStudy:
    """Run the rail at each misalignment in one angle, pushed at the pin at ``pin_y_m``."""
    values = np.asarray(misalignments_rad, dtype=np.float64)
    angles = [misalignment(misaligned, value) for value in values.tolist()]
    variation = Variation(cage_euler_zyx=angles, object_euler_zyx=angles)
    runs = run_many(rail_scene(rail, pin_y_m=pin_y_m), variation, method=method)
    after_weight, after_push = runs.euler_zyx[:, 0], runs.euler_zyx[:, 1]
    verdicts = tuple(runs.verdict.tolist())
    limit = permitted(misaligned, rail)
    return RangeStudy(method, misaligned, pin_y_m, values, after_weight, after_push, verdicts, limit)


def permitted(misaligned: Angle, rail: RailDimensions = PAPER_RAIL) -> float | None:
    """Return the largest misalignment at which the play still lets the rail lie at zero, radians; None for roll."""
    if misaligned == "pitch":
        return play_angle_rad(rail.roller_gap_m, rail.guide_thickness_m, rail.roller_spacing_m)
    if misaligned == "yaw":
        return play_angle_rad(rail.side_points_apart_m, rail.rail_gap_m, rail.roller_spacing_m)
    return None
