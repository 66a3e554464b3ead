"""An `Insertion` as the document of ``--json``: lengths in the scene's unit, angles in degrees, null for none."""

from __future__ import annotations

import math
from typing import Any

from cagepose.files.document import FORMAT_VERSION, drive_document
from cagepose.files.units import LengthUnit, from_metres
from cagepose.runs.load_scaling import force_unit
from cagepose.studies.insertion_result import Insertion
from cagepose.studies.misalignment import LENGTHS, Misalignment, MisalignmentEnd


def insertion_document(insertion: Insertion, unit: LengthUnit) -> dict[str, Any]:
    """Return the document: only dict, list, str, int, finite float, bool and None."""
    scene, drive = insertion.run.scene, insertion.drive
    load = scene.loads[insertion.phase]
    return {
        "version": FORMAT_VERSION,
        "scene": scene.name,
        "units": {"length": unit, "force": force_unit(scene, load)},
        "phase": load.name,
        "verdict": insertion.verdict,
        "drive": None if drive is None else drive_document(scene, drive, load, unit),
        "friction": insertion.friction,
        "cannot_jam": insertion.cannot_jam,
        "least_jam_friction": insertion.least_jam_friction,
        "least_jam_share": insertion.least_jam_share,
        "jam_friction": {
            "depth": (from_metres(insertion.depth_m, unit) + 0.0).tolist(),
            "least": [least if math.isfinite(least) else None for least in insertion.jam_friction.tolist()],
        },
        "out_of_place": {"bodies": list(insertion.bodies), "object": insertion.takes_object},
        "misalignment": {name: _sides(found, name in LENGTHS, unit) for name, found in insertion.misalignment.items()},
        "timing_s": {"solve": insertion.run.solve_s},
    }


def _sides(found: Misalignment, is_length: bool, unit: LengthUnit) -> dict[str, Any]:
    return {side: _end(end, is_length, unit) for side, end in (("low", found.low), ("high", found.high))}


def _end(end: MisalignmentEnd, is_length: bool, unit: LengthUnit) -> dict[str, Any]:
    def shown(value: float | None) -> float | None:
        if value is None:
            return None
        return (float(from_metres(value, unit)) if is_length else math.degrees(value)) + 0.0

    return {"permitted": shown(end.permitted), "fails_at": shown(end.fails_at), "verdict": end.verdict}
