"""A `Run` as the document of ``--json``: lengths in the scene's unit, angles in degrees, null for what is unknown."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Literal

from cagepose.files.margin_document import margin_document
from cagepose.files.units import LengthUnit, from_metres
from cagepose.model.checks import FloatArray
from cagepose.model.load import Load
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.driven import BodyRun, DriveRun
from cagepose.runs.drives import turns_alone
from cagepose.runs.load_scaling import force_unit
from cagepose.runs.proof import FreeMotion, Proof
from cagepose.runs.run import Contact, Event, Motion, PhaseRun, Run
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


def motion_document(motion: FreeMotion, length_unit: LengthUnit) -> dict[str, Any]:
    """Return how an object begins to move as the document has it."""
    through = motion.through_world
    return {
        "kind": motion.kind,
        "direction": _vector_or_none(motion.direction_world),
        "axis": _vector_or_none(motion.axis_world),
        "through": None if through is None else _numbers(from_metres(through, length_unit)),
        "pitch": _plain(float(from_metres(motion.pitch_m, length_unit))),
    }


def _force_unit(run: Run) -> Literal["N", "load"] | None:
    """Return the unit of forces: newtons, or the load; None: phases differ, and each of them tells its own."""
    units = {force_unit(run.scene, load) for load in run.scene.loads[: len(run.phases)]}
    return units.pop() if len(units) == 1 else None


class _Writer:
    def __init__(self, scene: Scene, unit: LengthUnit) -> None:
        self.scene = scene
        self.unit: LengthUnit = unit

    def pose(self, pose: Pose) -> dict[str, Any]:
        return {
            "position": self._lengths(pose.position_m),
            "euler_zyx_deg": _angles(pose),
            "quat_wxyz": _numbers(pose.quaternion_wxyz),
            "center_of_gravity": self._lengths(pose.transform(self.scene.object.center_of_gravity_m)),
        }

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
            "contacts": [self._contact(contact) for contact in phase.contacts],
            "proof": self._proof(phase.proof),
        }
        if load.drive:
            found["drive"] = None if phase.drive is None else self.drive(phase.drive, load)
        if phase.press is not None:
            found["press"] = {name: self._pressing(body) for name, body in phase.press.bodies.items()}
        return found

    def drive(self, drive: DriveRun, load: Load) -> dict[str, Any]:
        curve = drive.curve
        return {
            "share": drive.share,
            "along": self._along(drive.along, load, drive.share),
            "greatest": {
                "along": self._along(drive.greatest_along, load, drive.greatest_share),
                "share": drive.greatest_share,
            },
            "work": self._length(drive.work_j),
            "jam_possible": [list(shares) for shares in drive.jam_possible],
            "critical_jam_friction": drive.critical_jam_friction,
            "bodies": {name: self._body(body, load, drive.share) for name, body in drive.bodies.items()},
            "curve": {
                "share": _numbers(curve.share),
                "along": [self._along(along, load, share) for share, along, _ in curve.places()],
                "position": [self._lengths(position) for position in curve.position_m],
                "euler_zyx_deg": [_angles(pose) for _, _, pose in curve.places()],
            },
        }

    def _body(self, body: BodyRun, load: Load, share: float) -> dict[str, Any]:
        return {
            "travel": self._length(body.travel_m),
            "angle_deg": _plain(math.degrees(body.angle_rad)),
            "force": _numbers(body.force_n),
            "moment": self._lengths(body.moment_nm),
            "along": self._along(body.along, load, share),
        }

    def _pressing(self, body: BodyRun) -> dict[str, Any]:
        return {
            "travel": self._length(body.travel_m),
            "along": _plain(body.along),
            "force": _numbers(body.force_n),
            "moment": self._lengths(body.moment_nm),
        }

    def _along(self, along: float, load: Load, share: float) -> float:
        """A force for a travel, a moment for turns alone."""
        return self._length(along) if turns_alone(load, share) else _plain(along)

    def _proof(self, proof: Proof) -> dict[str, Any]:
        critical = proof.critical_friction
        return {
            "verdict": proof.verdict,
            "uniqueness": proof.uniqueness,
            "reason": proof.reason,
            "residual": proof.residual,
            "gap_work": proof.gap_work,
            "largest_force": proof.largest_force,
            "needs_friction": proof.needs_friction,
            "stability": proof.stability,
            "undetermined": list(proof.undetermined),
            "shared": list(proof.shared),
            "motion": None if proof.motion is None else motion_document(proof.motion, self.unit),
            "critical_friction": "none" if critical is not None and math.isinf(critical) else critical,
        }

    def _event(self, event: Event) -> dict[str, Any]:
        motion = event.motion
        return {
            "rule": event.rule,
            "motion": None if motion is None else motion.kind,
            "direction": None if motion is None else _vector_or_none(motion.direction_world),
            "axis": None if motion is None else _vector_or_none(motion.axis_world),
            "through": None if motion is None or motion.through_world is None else self._lengths(motion.through_world),
            "distance": 0.0 if motion is None else self._distance(motion),
            "angle_deg": 0.0 if motion is None else _plain(math.degrees(motion.angle_rad)),
            "hit": list(event.hit),
            "contacts": list(event.contacts),
            "pose": self.pose(event.pose_world_object),
        }

    def _distance(self, motion: Motion) -> float | None:
        """None for a travel without end (an escape): JSON has no infinite number."""
        return self._length(motion.distance_m) if math.isfinite(motion.distance_m) else None

    def _contact(self, contact: Contact) -> dict[str, Any]:
        return {
            "point": contact.point,
            "box": contact.box,
            "at": None if contact.place_world is None else self._lengths(contact.place_world),
            "normal": _numbers(contact.normal_world),
            "gap": self._length(contact.gap_m),
            "group": contact.group,
            "force_normal": contact.force_normal_n,
            "force_tangential": _vector_or_none(contact.force_tangential_n),
        }

    def _length(self, length_m: float) -> float:
        return _plain(float(from_metres(length_m, self.unit)))

    def _lengths(self, lengths_m: FloatArray) -> list[float]:
        return _numbers(from_metres(lengths_m, self.unit))


def _angles(pose: Pose) -> list[float]:
    return [_plain(math.degrees(angle)) for angle in pose.euler_zyx]


def _plain(value: float) -> float:
    return float(value) + 0.0  # -0.0 becomes 0.0


def _numbers(values: FloatArray) -> list[float]:
    return [_plain(value) for value in values]


def _vector_or_none(values: FloatArray | None) -> list[float] | None:
    return None if values is None else _numbers(values)
