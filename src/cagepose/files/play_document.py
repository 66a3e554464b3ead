"""A `Play` as the document of ``--json``: lengths in the scene's unit, angles in degrees, null for no end."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from cagepose.files.document import FORMAT_VERSION
from cagepose.files.results import motion_data, plain_data, pose_data
from cagepose.files.units import LengthUnit, from_metres
from cagepose.model.pose import Pose
from cagepose.studies.cage_verdict import CageVerdict, PathStep
from cagepose.studies.play_rest import PlayRest, PressedPoint
from cagepose.studies.play_result import Play, PlayEnd, PlayRange, PointPlay

LENGTHS = ("x", "y", "z")


def play_document(play: Play, rests: Sequence[PlayRest], unit: LengthUnit) -> dict[str, Any]:
    """Return the document: only dict, list, str, int, finite float, bool and None."""
    cage = play.cage
    return {
        "version": FORMAT_VERSION,
        "scene": play.scene.name,
        "units": {"length": unit},
        "freedoms": {name: _ends(ends, name in LENGTHS, unit) for name, ends in play.freedoms.items()},
        "points": [
            {
                **plain_data(point, unit, without=("low", "high")),
                **_ends(point, True, unit),
            }
            for point in play.points
        ],
        "held": list(play.held),
        "seated": play.seated,
        "cage": None if cage is None else _cage(cage, unit),
        "rests": [_rest(rest, unit) for rest in rests],
        "timing_s": {"analysis": play.analysis_s, "certificate": play.certificate_s},
    }


def _cage(cage: CageVerdict, unit: LengthUnit) -> dict[str, Any]:
    path = None if cage.path is None else [_step(step, unit) for step in cage.path]
    return {**plain_data(cage, unit, without=("path",)), "path": path}


def _step(step: PathStep, unit: LengthUnit) -> dict[str, Any]:
    return {**motion_data(step.motion, unit), "pose": pose_data(step.pose_world_object, unit)}


def _ends(ends: PlayRange | PointPlay, is_length: bool, unit: LengthUnit) -> dict[str, Any]:
    linear, exact, certified = (
        [_shown(end, is_length, unit) for end in pair]
        for pair in (
            (ends.low.linear, ends.high.linear),
            (ends.low.exact, ends.high.exact),
            (ends.low.certified, ends.high.certified),
        )
    )
    return {
        "linear": linear,
        "exact": exact,
        "certified": None if None in certified else certified,
        "reached": [_shown(end.reached, is_length, unit) for end in (ends.low, ends.high)],
        "status": [ends.low.status, ends.high.status],
        "is_open": [ends.low.is_open, ends.high.is_open],
        "poses": [_pose_or_none(ends.low.pose_world_object, unit), _pose_or_none(ends.high.pose_world_object, unit)],
        "limits": [_limits(ends.low, is_length, unit), _limits(ends.high, is_length, unit)],
    }


def _limits(end: PlayEnd, is_length: bool, unit: LengthUnit) -> list[dict[str, Any]]:
    """What each unit of gap is worth when it is closed and when it is opened."""
    return [
        {
            "point": clearance.point,
            "box": clearance.box,
            "gap": None if clearance.gap_m is None else float(from_metres(clearance.gap_m, unit)),
            "closing": _gain(clearance.closing, is_length, unit),
            "opening": _gain(clearance.opening, is_length, unit),
        }
        for clearance in end.clearances
    ]


def _gain(gain: float, is_length: bool, unit: LengthUnit) -> float | None:
    """Lengths per length, or degrees per length; None: it is without end (the gap cannot be closed)."""
    if not math.isfinite(gain):
        return None
    return gain if is_length else math.degrees(gain) / float(from_metres(1.0, unit))


def _pose_or_none(pose: Pose | None, unit: LengthUnit) -> dict[str, Any] | None:
    return None if pose is None else pose_data(pose, unit)


def _rest(rest: PlayRest, unit: LengthUnit) -> dict[str, Any]:
    return {
        "phase": rest.phase,
        "force_unit": "N" if rest.in_newtons else "load",
        "linear_pose": _pose_or_none(rest.linear_pose_world_object, unit),
        "exact_pose": _pose_or_none(rest.pose_world_object, unit),
        "forces": _forces(rest.forces),
        "exact_forces": _forces(rest.exact_forces),
        "undetermined": {
            freedom.name: [_shown(end, freedom.name in LENGTHS, unit) for end in (freedom.low, freedom.high)]
            for freedom in rest.undetermined
        },
    }


def _forces(forces: tuple[PressedPoint, ...]) -> list[dict[str, Any]]:
    return [{"point": force.point, "box": force.box, "force_normal": force.force_n} for force in forces]


def _shown(value: float | None, is_length: bool, unit: LengthUnit) -> float | None:
    if value is None:
        return None
    return (float(from_metres(value, unit)) if is_length else math.degrees(value)) + 0.0
