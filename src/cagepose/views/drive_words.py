"""What pictures and pages tell of a drive: how far it got, why it stopped, and its force over the way."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from cagepose.files.units import LengthUnit, from_metres
from cagepose.runs.load_scaling import scaled_load
from cagepose.runs.run import STOPPED, PhaseRun, Run, Verdict

STOPS: Mapping[Verdict, str] = {
    "blocked": "no motion of the object makes way for the drive, with any friction",
    "jams": "friction alone stops the drive",
    "stops": "the drive has reached the force or moment of stop_at",
}
"""What verdicts of a drive that does not go on mean."""


def share_words(share: float) -> str:
    """Return how much of a drive is done, as a percentage."""
    return f"{100.0 * share:.4g} %"


def how_far(phase: PhaseRun, length_unit: LengthUnit) -> str:
    """Return how far a phase's drive got, or what presses, to be put behind the verdict; empty: nothing did."""
    if phase.press is not None and phase.drive is None:
        told = (f"{name} after {_length(body.travel_m, length_unit)}" for name, body in phase.press.bodies.items())
        return f" with what presses ({'; '.join(told)})"
    if phase.drive is None:
        return " at the start of the drive" if phase.verdict in STOPPED else ""
    ways = []
    for name, body in phase.drive.bodies.items():
        amounts = []
        if body.travel_m:
            amounts.append(_length(body.travel_m, length_unit))
        if body.angle_rad:
            amounts.append(f"{math.degrees(body.angle_rad):.4g} deg")
        ways.append(f"{name} by {', '.join(amounts) or 'nothing'}")
    return f" at {share_words(phase.drive.share)} of the drive ({'; '.join(ways)})"


def _length(length_m: float, length_unit: LengthUnit) -> str:
    return f"{float(from_metres(length_m, length_unit)):.4g} {length_unit}"


def drive_data(run: Run, phase_index: int, length_unit: LengthUnit) -> dict[str, Any] | None:
    """Return the curve of a phase's drive as plain data, its forces in the unit that it names; None: none was driven.

    A force that is not finite has no place in it.
    """
    drive = run.phases[phase_index].drive
    if drive is None:
        return None
    rows = [
        [share, along_drawn(run, phase_index, along, length_unit)]
        for share, along in zip(drive.curve.share.tolist(), drive.curve.along.tolist(), strict=True)
        if math.isfinite(along)
    ]
    return {"reached": drive.share, "curve": rows, "unit": _unit(run, phase_index, length_unit)}


def along_drawn(run: Run, phase_index: int, along: float | None, length_unit: LengthUnit) -> float | None:
    """Return the sum of the drivers' forces in the unit of `drive_data`; None: there is none, or it is not finite."""
    if along is None or not math.isfinite(along):
        return None
    return float(from_metres(along, length_unit)) if _turns_alone(run, phase_index) else along


def _unit(run: Run, phase_index: int, length_unit: LengthUnit) -> str:
    force = "N" if scaled_load(run.scene, run.scene.loads[phase_index]).in_newtons else "parts of the load"
    if not _turns_alone(run, phase_index):
        return force
    return f"N {length_unit}" if force == "N" else f"{force} times {length_unit}"


def _turns_alone(run: Run, phase_index: int) -> bool:
    """Whether bodies turn and none travels, so that moments drive them."""
    return all(leg.is_turn for legs in run.scene.loads[phase_index].drive.values() for leg in legs)
