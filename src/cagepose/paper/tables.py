"""Tables of the report beside the comparison: how the cases end, and what the planar theory says; texts, row by row."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from cagepose.paper import planar
from cagepose.paper.cases import MISALIGNMENT_RAD, CaseRuns
from cagepose.paper.comparison import NOTHING
from cagepose.paper.numbers import SIDE_RAD, TILT_RAD
from cagepose.paper.rail import PAPER_RAIL as RAIL
from cagepose.paper.rail import relative_tilt_rad
from cagepose.runs.run import Run


def end_rows(runs: Mapping[str, CaseRuns]) -> list[list[str]]:
    """Return case, method, verdict and proof; yaw, pitch and roll; relative pitch after weight and push, and swing."""
    return [
        [run.scene.name, method, *_end(run), *(_swing(run) if len(run.phases) > 1 else 3 * [NOTHING])]
        for case in ("sample", "pitch", "yaw", "roll")
        for method, run in ((method, getattr(cases, case)) for method, cases in runs.items())
    ]


def _end(run: Run) -> list[str]:
    proof = run.phases[-1].proof
    judged = proof.verdict if proof.stability is None else f"{proof.verdict}, {proof.stability}"
    return [run.verdict, judged, *(f"{math.degrees(angle) + 0.0:.4f}" for angle in run.pose.euler_zyx)]


def _swing(run: Run) -> list[str]:
    """The rail's pitch relative to its rollers after the weight, after the push, and how far it swings between."""
    before, after = (math.degrees(relative_tilt_rad(run, phase)) for phase in range(2))
    return [f"{before:+.6f}", f"{after:+.6f}", f"{before - after:.6f}"]


def planar_rows() -> list[list[str]]:
    """Return play, moments and requirements in pitch and in yaw, of the rail out of line as the weight leaves it."""
    pitch, yaw = MISALIGNMENT_RAD + TILT_RAD, MISALIGNMENT_RAD
    x, _, z = RAIL.center_of_gravity_m
    weight = planar.gravity_moment_nm(1.0, x * math.cos(pitch) + z * math.sin(pitch))
    push = planar.push_pitch_moment_nm(1.0, pitch, RAIL.pin_height_m, RAIL.reach_m)
    pin_y_m = planar.first_pin_y_m(yaw, RAIL.pin_spacing_m)
    yaw_push = planar.push_yaw_moment_nm(1.0, yaw, pin_y_m, RAIL.reach_m)
    plate = planar.small_play_angle_rad(RAIL.roller_gap_m, RAIL.guide_thickness_m, RAIL.roller_spacing_m)
    channel = planar.small_play_angle_rad(RAIL.side_points_apart_m, RAIL.rail_gap_m, RAIL.roller_spacing_m)
    pitch_limit = planar.pitch_limit_rad(RAIL.pin_height_m, RAIL.reach_m)
    yaw_limit = planar.yaw_limit_rad(RAIL.pin_spacing_m, RAIL.reach_m)
    return [
        ["angle of the play, exactly", _deg(TILT_RAD), _deg(SIDE_RAD)],
        ["angle of the play, for small angles", _deg(plate), _deg(channel)],
        ["range of the relative angle", _deg(2.0 * TILT_RAD), _deg(2.0 * SIDE_RAD)],
        ["moment of the weight, per newton", _lever(weight), "none about z"],
        ["moment of the push, per newton", _lever(push), _lever(yaw_push)],
        ["angle at which the push changes sides", _deg(pitch_limit), _deg(yaw_limit)],
        ["(Rq.1) the push turns the rail the right way",
         _answer(planar.push_opposes_weight(weight, push), _lever),
         _answer(planar.push_reduces_yaw(yaw, pin_y_m, RAIL.reach_m), _deg)],
        ["(Rq.2) zero is within reach of the play",
         _answer(planar.zero_is_within_reach(MISALIGNMENT_RAD, TILT_RAD), _deg),
         _answer(planar.zero_is_within_reach(MISALIGNMENT_RAD, SIDE_RAD), _deg)],
    ]  # fmt: skip


def _deg(angle_rad: float) -> str:
    return f"{math.degrees(angle_rad):.4f} deg"


def _lever(moment_nm: float) -> str:
    return f"{moment_nm * 1000.0:+.3f} N mm"


def _answer(requirement: planar.Requirement, unit: Callable[[float], str]) -> str:
    return f"{'yes' if requirement.holds else 'no'}, margin {unit(requirement.margin)}"
