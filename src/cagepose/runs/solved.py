"""From the outcome of a run, as kernels write it, to what users read: phases, events, contacts, proofs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
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
from cagepose.runs.read_proof import read_proofs
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
        return _Reader(self.scene, self._method.rule_names, self._outcome).phases()

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

    def __init__(self, scene: Scene, rule_names: Sequence[str], outcome: Outcome) -> None:
        self.scene, self.rule_names, self.outcome = scene, rule_names, outcome
        self.point_names = scene.cage.names

    def phases(self) -> tuple[PhaseRun, ...]:
        phases: Any = self.outcome.phases
        codes = phases["verdict"].tolist()
        events = _divided(self._events(), phases["n_events"].tolist())
        ends = [of_phase[-1].pose_world_object for of_phase in events]
        contacts, proofs = judged(self.scene, self.outcome, ends)
        starts = [self.scene.object.pose_world_object, *ends]
        found = list[PhaseRun]()
        for index, (code, proof) in enumerate(zip(codes, proofs, strict=True)):
            verdict: Verdict = VERDICT_NAMES[code]
            found.append(
                _made(
                    PhaseRun,
                    name=self.scene.loads[index].name,
                    verdict=proof.verdict if verdict == "rests" else verdict,
                    start_pose=starts[index],
                    events=tuple(events[index]),
                    contacts=tuple(contacts[index]),
                    proof=proof,
                )
            )
        return tuple(found)

    def _events(self) -> list[Event]:
        events: Any = self.outcome.events
        path = list(map(Pose.from_unit, self.outcome.path[:, :3], self.outcome.path[:, 3:]))
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


def judged(scene: Scene, outcome: Outcome, ends: Sequence[Pose]) -> tuple[list[list[Contact]], list[Proof]]:
    """Return the contacts and the proof at the end of each phase, given the poses there.

    Contacts have forces only if these balance the load.
    """
    phases: Any = outcome.phases
    records: Any = outcome.contacts
    last_contacts = phases["n_contacts"].tolist()
    contacts = _divided(_contacts(scene, outcome), last_contacts)
    is_shared = _divided(records["is_shared"].tolist(), last_contacts)
    shared = [
        list(dict.fromkeys(contact.point for contact in compress(of_phase, marks)))
        for of_phase, marks in zip(contacts, is_shared, strict=True)
    ]
    proofs = read_proofs(outcome, scene, ends, shared)
    for index, proof in enumerate(proofs):
        if proof.verdict == "moves":
            contacts[index] = [
                replace(contact, force_normal_n=None, force_tangential_n=None) for contact in contacts[index]
            ]
    return contacts, proofs


def _divided(rows: list[T], lasts: list[int]) -> list[list[T]]:
    """Divide rows by the place where each phase's end."""
    return [rows[first:last] for first, last in zip([0, *lasts], lasts, strict=False)]


def _made(cls: type[T], **fields: object) -> T:
    """Make a frozen result of fields that are right: its own ``__init__`` takes five times as long."""
    instance = object.__new__(cls)
    object.__setattr__(instance, "__dict__", fields)
    return instance
