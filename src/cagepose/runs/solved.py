"""From the outcome of a run, as kernels write it, to what users read: phases, events, contacts, proofs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property
from itertools import compress
from typing import Any, TypeVar

from cagepose.kernels.outcome.records import Outcome
from cagepose.kernels.outcome.trace import MOTION_NAMES, NONE, NOTE_NAMES, TRAVEL, VERDICT_NAMES
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.methods import Method
from cagepose.runs.proof import Proof
from cagepose.runs.read_proof import read_proof
from cagepose.runs.run import Contact, Event, Motion, PhaseRun, Run, Verdict

T = TypeVar("T")


class SolvedRun(Run):
    """A run that reads its phases from an outcome when they are first asked for."""

    _method: Method
    _friction: float
    _outcome: Outcome

    def __init__(self, scene: Scene, method: Method, friction: float, outcome: Outcome, solve_s: float) -> None:
        vars(self).update(scene=scene, method=method.name, solve_s=solve_s)
        vars(self).update(_method=method, _friction=friction, _outcome=outcome)

    @cached_property
    def phases(self) -> tuple[PhaseRun, ...]:
        return _Reader(self.scene, self._method, self._outcome).phases()

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        return tuple(self._method.warnings(self.scene, self.phases, self._friction))


def written(outcome: Outcome) -> Outcome:
    """Return a copy of what is written of an outcome, whose room is used again."""
    n_phases, n_events, n_path, n_contacts = outcome.counts.tolist()
    used = (4, n_phases, n_events, n_contacts, n_events, n_events, n_path)
    arrays: tuple[Any, ...] = outcome
    copies = [array[:n].copy() for array, n in zip(arrays, used, strict=True)]
    for array in copies:
        array.flags.writeable = False  # results share these arrays
    return Outcome(*copies)


class _Reader:
    """Reads one outcome, field by field: a list of Python numbers takes a tenth of the time of one after the other."""

    def __init__(self, scene: Scene, method: Method, outcome: Outcome) -> None:
        self.scene, self.rule_names, self.outcome = scene, method.rule_names, outcome
        self.point_names = scene.cage.names

    def phases(self) -> tuple[PhaseRun, ...]:
        phases: Any = self.outcome.phases
        events = self._events()
        contacts, shared = _contacts(self.scene, self.outcome), _shared(self.scene, self.outcome)
        found = list[PhaseRun]()
        pose = self.scene.object.pose_world_object
        event = contact = 0
        for index, code in enumerate(phases["verdict"].tolist()):
            last_event, last_contact = int(phases["n_events"][index]), int(phases["n_contacts"][index])
            of_phase = tuple(events[event:last_event])
            end = of_phase[-1].pose_world_object if of_phase else pose
            rows = slice(contact, last_contact)
            proof, touches = _judged(phases[index], self.scene, end, contacts[rows], shared[rows])
            verdict: Verdict = VERDICT_NAMES[code]
            found.append(
                _made(
                    PhaseRun,
                    name=self.scene.loads[index].name,
                    verdict=proof.verdict if verdict == "rests" else verdict,
                    start_pose=pose,
                    events=of_phase,
                    contacts=touches,
                    proof=proof,
                )
            )
            event, contact, pose = last_event, last_contact, end
        return tuple(found)

    def _events(self) -> list[Event]:
        events: Any = self.outcome.events
        path = [Pose.from_unit(row[:3], row[3:]) for row in self.outcome.path]
        poses = map(Pose.from_unit, events["position"], events["quaternion"])
        columns = zip(
            events["rule"].tolist(),
            events["note"].tolist(),
            self._motions(),
            self.outcome.hit.tolist(),
            self.outcome.touching.tolist(),
            poses,
            events["n_path"].tolist(),
            strict=True,
        )
        found, first = list[Event](), 0
        for rule, note, motion, hit, touching, pose, n_path in columns:
            found.append(
                _made(
                    Event,
                    rule=self.rule_names[rule],
                    motion=motion,
                    hit=tuple(compress(self.point_names, hit)),
                    contacts=tuple(compress(self.point_names, touching)),
                    pose_world_object=pose,
                    note=NOTE_NAMES[note] if note < len(NOTE_NAMES) else None,
                    path=tuple(path[first : first + n_path]),
                )
            )
            first += n_path
        return found

    def _motions(self) -> Iterator[Motion | None]:
        events: Any = self.outcome.events
        columns = zip(
            events["motion"].tolist(),
            events["along"],
            events["through"],
            events["distance"].tolist(),
            events["angle"].tolist(),
            strict=True,
        )
        for motion, along, through, distance, angle in columns:
            is_travel = motion == TRAVEL
            yield (
                None
                if motion == NONE
                else _made(
                    Motion,
                    kind=MOTION_NAMES[motion],
                    direction_world=along if is_travel else None,
                    axis_world=None if is_travel else along,
                    through_world=None if is_travel else through,
                    distance_m=distance,
                    angle_rad=angle,
                )
            )


def _contacts(scene: Scene, outcome: Outcome) -> list[Contact]:
    contacts: Any = outcome.contacts
    point_names, box_names = scene.cage.names, [str(box.name) for box in scene.object.boxes]
    columns = zip(
        contacts["point"].tolist(),
        contacts["box"].tolist(),
        contacts["normal"],
        contacts["gap"].tolist(),
        contacts["near_edge"].tolist(),
        contacts["force_normal"].tolist(),
        contacts["force_tangential"],
        strict=True,
    )
    return [
        _made(
            Contact,
            point=point_names[point],
            box=box_names[box],
            normal_world=normal,
            gap_m=gap,
            near_edge=near_edge,
            force_normal_n=force_normal,
            force_tangential_n=force_tangential,
        )
        for point, box, normal, gap, near_edge, force_normal, force_tangential in columns
    ]


def _shared(scene: Scene, outcome: Outcome) -> list[str | None]:
    """For each contact the name of its point, if its normal force is one of many."""
    contacts: Any = outcome.contacts
    marks = zip(contacts["is_shared"].tolist(), contacts["point"].tolist(), strict=True)
    return [scene.cage.names[point] if is_shared else None for is_shared, point in marks]


def contacts_and_proof(scene: Scene, outcome: Outcome, phase: int, pose: Pose) -> tuple[Proof, tuple[Contact, ...]]:
    """Return what an outcome of nothing but a judgement says of a pose."""
    record: Any = outcome.phases[phase]
    return _judged(record, scene, pose, _contacts(scene, outcome), _shared(scene, outcome))


def _judged(
    record: Any, scene: Scene, pose: Pose, contacts: list[Contact], shared: list[str | None]
) -> tuple[Proof, tuple[Contact, ...]]:
    """Return the proof of a phase's end and its contacts, which have forces only if these balance the load."""
    proof = read_proof(record, scene, pose, shared)
    if proof.verdict == "moves":
        contacts = [replace(contact, force_normal_n=None, force_tangential_n=None) for contact in contacts]
    return proof, tuple(contacts)


def _made(cls: type[T], **fields: object) -> T:
    """Make a frozen result of fields that are right: its own ``__init__`` takes five times as long."""
    instance = object.__new__(cls)
    vars(instance).update(fields)
    return instance
