"""A `Run` as the document of ``--json``: lengths in the scene's unit, angles in degrees, null for what is unknown."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Literal

from cagepose.files.margin_document import margin_document
from cagepose.files.results import angle_data, length_data, motion_data, plain_data, pose_data
from cagepose.files.units import LengthUnit
from cagepose.model.load import Load
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.driven import DriveRun
from cagepose.runs.drives import turns_alone
from cagepose.runs.load_scaling import force_unit
from cagepose.runs.run import Event, PhaseRun, Run
from cagepose.studies.margin import Margin
from cagepose.studies.press_limits import press_limits

FORMAT_VERSION = 2
"""Version of the document and of saved runs. It counts up when a reader of the old form would misread the new one."""


def run_document(
    run: Run, length_unit: LengthUnit = "mm", margins: Sequence[Margin | None] | None = None
) -> dict[str, Any]:
    """Return the document: only dict, list, str, int, finite float, bool and None.

    ``margins``, one for each phase, stand in the proofs, and between which forces bodies may press beside these; None:
    there are no such keys.
    """
    writer = _Writer(run.scene, length_unit)
    phases = [writer.phase(phase, load) for phase, load in zip(run.phases, run.scene.loads, strict=False)]
    for number, (phase, margin) in enumerate(zip(phases, margins or (), strict=False)):
        phase["proof"]["margin"] = None if margin is None else margin_document(margin, length_unit)
        for name, (least, greatest) in press_limits(run, number).items():
            phase["press"][name] |= {"least": least, "greatest": "unbounded" if math.isinf(greatest) else greatest}
    return {
        "version": FORMAT_VERSION,
        "scene": run.scene.name,
        "units": {"length": length_unit, "force": _force_unit(run)},
        "method": run.method,
        "verdict": run.verdict,
        "warnings": list(run.warnings),
        "pose": writer.pose(run.pose),
        "phases": phases,
        "timing_s": {"solve": run.solve_s},
    }


def pose_document(scene: Scene, pose: Pose, length_unit: LengthUnit) -> dict[str, Any]:
    """Return a pose of a scene's object as the document has it."""
    return _Writer(scene, length_unit).pose(pose)


def drive_document(scene: Scene, drive: DriveRun, load: Load, length_unit: LengthUnit) -> dict[str, Any]:
    """Return what came of a phase's drive as the document has it."""
    return _Writer(scene, length_unit).drive(drive, load)


def _force_unit(run: Run) -> Literal["N", "load"] | None:
    """Return the unit of forces: newtons, or the load; None: phases differ, and each of them tells its own."""
    units = {force_unit(run.scene, load) for load in run.scene.loads[: len(run.phases)]}
    return units.pop() if len(units) == 1 else None


class _Writer:
    def __init__(self, scene: Scene, unit: LengthUnit) -> None:
        self.scene = scene
        self.unit: LengthUnit = unit

    def pose(self, pose: Pose) -> dict[str, Any]:
        center = pose.transform(self.scene.object.center_of_gravity_m)
        return {**pose_data(pose, self.unit), "center_of_gravity": length_data(center, self.unit)}

    def phase(self, phase: PhaseRun, load: Load) -> dict[str, Any]:
        events = [self._event(event) for event in phase.events]
        if load.drive or load.press:
            events = [shown | {"share": event.share} for shown, event in zip(events, phase.events, strict=True)]
        found: dict[str, Any] = {
            "name": phase.name,
            "verdict": phase.verdict,
            "force_unit": force_unit(self.scene, load),
            "pose": self.pose(phase.pose),
            "events": events,
            "contacts": [plain_data(contact, self.unit) for contact in phase.contacts],
            "proof": {**plain_data(phase.proof, self.unit), "uniqueness": phase.proof.uniqueness},
        }
        if load.drive:
            found["drive"] = None if phase.drive is None else self.drive(phase.drive, load)
        if phase.press is not None:
            found["press"] = {name: plain_data(body, self.unit) for name, body in phase.press.bodies.items()}
        return found

    def drive(self, drive: DriveRun, load: Load) -> dict[str, Any]:
        curve, separate = drive.curve, ("greatest_along", "greatest_share", "bodies", "curve")
        return {
            **plain_data(drive, self.unit, without=separate),
            "along": self._along(drive.along, load, drive.share),
            "greatest": {
                "along": self._along(drive.greatest_along, load, drive.greatest_share),
                "share": drive.greatest_share,
            },
            "bodies": {
                name: {**plain_data(body, self.unit), "along": self._along(body.along, load, drive.share)}
                for name, body in drive.bodies.items()
            },
            "curve": {
                "share": (curve.share + 0.0).tolist(),
                "along": [self._along(along, load, share) for share, along, _ in curve.places()],
                "position": length_data(curve.position_m, self.unit),
                "euler_zyx_deg": [angle_data(pose) for _, _, pose in curve.places()],
            },
        }

    def _along(self, along: float, load: Load, share: float) -> float:
        """A force for a travel, a moment for turns alone."""
        told: float = length_data(along, self.unit) if turns_alone(load, share) else along + 0.0
        return told

    def _event(self, event: Event) -> dict[str, Any]:
        told = plain_data(event, self.unit, without=("rule", "motion", "path", "share"))
        moved = motion_data(event.motion, self.unit)
        return {"rule": event.rule, **moved, **told, "pose": self.pose(event.pose_world_object)}
