"""A `Run` as plain data without loss, its scene included."""

from __future__ import annotations

import math
from typing import Annotated, Any

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
from cagepose.nouns.checks import FloatArray
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


class ContactRecord(Record):
    """A `Contact`."""

    point: str
    box: str
    normal: Three
    gap_m: float
    near_edge: bool
    force_normal_n: float | None
    force_tangential_n: Three | None


class PhaseRecord(Record):
    """A `PhaseRun`."""

    name: str
    verdict: Verdict
    start_pose: PoseRecord
    events: list[EventRecord]
    contacts: list[ContactRecord]


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
    return PhaseRun(record.name, record.verdict, record.start_pose.pose(), events, contacts)


def _event(record: EventRecord) -> Event:
    motion = None if record.motion is None else _motion(record.motion)
    return Event(record.rule, motion, tuple(record.hit), tuple(record.contacts), record.pose.pose(), record.note)


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
