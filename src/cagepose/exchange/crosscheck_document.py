"""A `Crosscheck` as the document of ``--json``: lengths in the scene's unit, angles in degrees."""

from __future__ import annotations

import math
from typing import Any

from cagepose.exchange.crosscheck import Crosscheck, PhaseCheck
from cagepose.files.document import pose_document
from cagepose.files.units import LengthUnit, from_metres

DOCUMENT_VERSION = 1
"""Version of the document. It counts up when a reader of the old form would misread the new one."""


def crosscheck_document(found: Crosscheck, length_unit: LengthUnit) -> dict[str, Any]:
    """Return the document: only dict, list, str, int, finite float, bool and None."""

    def length(metres: float | None) -> float | None:
        return None if metres is None or not math.isfinite(metres) else float(from_metres(metres, length_unit))

    def phase_document(phase: PhaseCheck) -> dict[str, Any]:
        there = phase.mujoco
        return {
            "name": phase.phase.name,
            "agrees": phase.agrees,
            "verdict": phase.phase.verdict,
            "pose": pose_document(found.run.scene, phase.phase.pose, length_unit),
            "mujoco": {
                "at_rest": there.settled.is_quiet,
                "pose": pose_document(found.run.scene, there.pose, length_unit),
                "penetration": length(there.penetration_m),
                "windows": there.settled.windows,
            },
            "distance": length(phase.distance_m),
            "angle_deg": math.degrees(phase.angle_rad),
            "allowed": length(phase.allowed_m),
            "cagepose_leaves_theirs_by": length(phase.leaves_theirs_m),
            "mujoco_leaves_ours_by": length(phase.leaves_ours_m),
            "reasons": list(phase.reasons),
        }

    return {
        "version": DOCUMENT_VERSION,
        "scene": found.run.scene.name,
        "engine": "mujoco",
        "units": {"length": length_unit},
        "agrees": found.agrees,
        "phases": [phase_document(phase) for phase in found.phases],
        "notes": list(found.notes),
    }
