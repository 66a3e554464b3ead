"""A `Run` as plain data without loss, its scene included."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, model_validator

from cagepose.files.scene_record import (
    PoseRecord,
    Record,
    SceneRecord,
    Three,
    list_or_none,
    record_of_scene,
    scene_of_record,
)
from cagepose.model.checks import FloatArray
from cagepose.runs.proof import FreeMotion, Proof, ProofVerdict, Stability
from cagepose.runs.run import Contact, Event, Motion, MotionKind, Note, PhaseRun, Run, Verdict


class MotionRecord(Record):
    """A `Motion`."""

    kind: MotionKind
    direction: Three | None
    axis: Three | None
    through_m: Three | None
    distance_m: float | None  # None: without end
    angle_rad: float

    @model_validator(mode="after")
    def _has_its_line(self) -> MotionRecord:
        line = (self.direction,) if self.kind == "travel" else (self.axis, self.through_m)
        if None in line:
            raise ValueError(f"a {self.kind} without its line")
        return self


class EventRecord(Record):
    """An `Event`."""

    rule: str
    motion: MotionRecord | None
    hit: list[str]
    contacts: list[str]
    pose: PoseRecord
    note: Note | None
    path: list[PoseRecord]


class ContactRecord(Record):
    """A `Contact`."""

    point: str
    box: str
    normal: Three
    gap_m: float
    near_edge: bool
    force_normal_n: float | None
    force_tangential_n: Three | None


class FreeMotionRecord(Record):
    """A `FreeMotion`."""

    kind: MotionKind
    direction: Three | None
    axis: Three | None
    through_m: Three | None
    pitch_m: float


class ProofRecord(Record):
    """A `Proof`."""

    verdict: ProofVerdict
    reason: str
    residual: float
    needs_friction: bool
    stability: Stability | None
    undetermined: list[str]
    shared: list[str]
    motion: FreeMotionRecord | None
    critical_friction: float | Literal["none"] | None  # "none": no coefficient is enough


class PhaseRecord(Record):
    """A `PhaseRun`."""

    name: str
    verdict: Verdict
    start_pose: PoseRecord
    events: list[EventRecord]
    contacts: list[ContactRecord]
    proof: ProofRecord


class RunRecord(Record):
    """A `Run`."""

    scene: SceneRecord
    method: str
    phases: Annotated[list[PhaseRecord], Field(min_length=1)]
    warnings: list[str]
    solve_s: float


def run_record(run: Run) -> dict[str, Any]:
    """Return ``run`` as plain data, its scene included."""
    record = RunRecord(
        scene=record_of_scene(run.scene),
        method=run.method,
        phases=[_phase_record(phase) for phase in run.phases],
        warnings=list(run.warnings),
        solve_s=run.solve_s,
    )
    return record.model_dump()


def run_from_record(record: object) -> Run:
    """Return the run that `run_record` wrote.

    Raises
    ------
    pydantic.ValidationError, SceneError
        As `scene_from_record`.
    """
    read = RunRecord.model_validate(record)
    phases = tuple(_phase(phase) for phase in read.phases)
    return Run(scene_of_record(read.scene), read.method, phases, tuple(read.warnings), read.solve_s)


def _phase_record(phase: PhaseRun) -> PhaseRecord:
    return PhaseRecord(
        name=phase.name,
        verdict=phase.verdict,
        start_pose=PoseRecord.of(phase.start_pose),
        events=[_event_record(event) for event in phase.events],
        contacts=[
            ContactRecord(
                point=contact.point,
                box=contact.box,
                normal=contact.normal_world.tolist(),
                gap_m=contact.gap_m,
                near_edge=contact.near_edge,
                force_normal_n=contact.force_normal_n,
                force_tangential_n=list_or_none(contact.force_tangential_n),
            )
            for contact in phase.contacts
        ],
        proof=_proof_record(phase.proof),
    )


def _proof_record(proof: Proof) -> ProofRecord:
    motion, critical = proof.motion, proof.critical_friction
    return ProofRecord(
        verdict=proof.verdict,
        reason=proof.reason,
        residual=proof.residual,
        needs_friction=proof.needs_friction,
        stability=proof.stability,
        undetermined=list(proof.undetermined),
        shared=list(proof.shared),
        motion=None
        if motion is None
        else FreeMotionRecord(
            kind=motion.kind,
            direction=list_or_none(motion.direction_world),
            axis=list_or_none(motion.axis_world),
            through_m=list_or_none(motion.through_world),
            pitch_m=motion.pitch_m,
        ),
        critical_friction="none" if critical is not None and math.isinf(critical) else critical,
    )


def _event_record(event: Event) -> EventRecord:
    motion = event.motion
    return EventRecord(
        rule=event.rule,
        motion=None
        if motion is None
        else MotionRecord(
            kind=motion.kind,
            direction=list_or_none(motion.direction_world),
            axis=list_or_none(motion.axis_world),
            through_m=list_or_none(motion.through_world),
            distance_m=motion.distance_m if math.isfinite(motion.distance_m) else None,
            angle_rad=motion.angle_rad,
        ),
        hit=list(event.hit),
        contacts=list(event.contacts),
        pose=PoseRecord.of(event.pose_world_object),
        note=event.note,
        path=[PoseRecord.of(pose) for pose in event.path],
    )


def _phase(record: PhaseRecord) -> PhaseRun:
    contacts = tuple(
        Contact(
            contact.point,
            contact.box,
            np.array(contact.normal),
            contact.gap_m,
            contact.near_edge,
            contact.force_normal_n,
            _array(contact.force_tangential_n),
        )
        for contact in record.contacts
    )
    events = tuple(_event(event) for event in record.events)
    return PhaseRun(record.name, record.verdict, record.start_pose.pose(), events, contacts, _proof(record.proof))


def _proof(record: ProofRecord) -> Proof:
    motion = record.motion
    return Proof(
        record.verdict,
        record.reason,
        record.residual,
        record.needs_friction,
        record.stability,
        tuple(record.undetermined),
        tuple(record.shared),
        None
        if motion is None
        else FreeMotion(
            motion.kind, _array(motion.direction), _array(motion.axis), _array(motion.through_m), motion.pitch_m
        ),
        math.inf if record.critical_friction == "none" else record.critical_friction,
    )


def _event(record: EventRecord) -> Event:
    motion = None if record.motion is None else _motion(record.motion)
    path = tuple(pose.pose() for pose in record.path)
    return Event(record.rule, motion, tuple(record.hit), tuple(record.contacts), record.pose.pose(), record.note, path)


def _motion(record: MotionRecord) -> Motion:
    return Motion(
        record.kind,
        _array(record.direction),
        _array(record.axis),
        _array(record.through_m),
        math.inf if record.distance_m is None else record.distance_m,
        record.angle_rad,
    )


def _array(values: list[float] | None) -> FloatArray | None:
    return None if values is None else np.array(values, dtype=np.float64)
