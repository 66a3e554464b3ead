"""From the outcome of a run, as kernels write it, to what users read: phases, events, contacts, proofs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import compress
from typing import Any, TypeVar

from cagepose.kernels.outcome.records import Outcome
from cagepose.kernels.outcome.trace import MOTION_NAMES, NONE, NOTE_NAMES, TRAVEL, VERDICT_NAMES
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.methods import Method
from cagepose.runs.proof import Proof
from cagepose.runs.read_drive import read_drives, read_presses, shares_of_steps
from cagepose.runs.read_proof import read_proofs
from cagepose.runs.run import Contact, Event, Motion, PhaseRun, Run, Verdict

T = TypeVar("T")


class Solution:
    """What a kernel has written of a run: a `Run` reads from it when it is asked.

    Attributes
    ----------
    scene, method, rules, friction
        What was run, by which method with which numbers, and with which coefficient of friction.
    outcome
        Everything that the kernel gave.
    """

    def __init__(self, scene: Scene, method: Method, rules: Any, friction: float, outcome: Outcome) -> None:
        self.scene, self.method, self.rules, self.friction, self.outcome = scene, method, rules, friction, outcome

    def run(self, solve_s: float) -> Run:
        """Return the run, whose phases and warnings are read when they are first asked for."""
        return _made(Run, scene=self.scene, method=self.method.name, solve_s=solve_s, solution=self)

    def phases(self) -> tuple[PhaseRun, ...]:
        return _read_phases(self.scene, self.method, self.outcome)

    def warnings(self, phases: Sequence[PhaseRun]) -> tuple[str, ...]:
        return tuple(self.method.warnings(self.scene, phases, self.friction))

    def steps_of(self, phase: int, event: int) -> tuple[int, int]:
        """Return the first step of an event, and how many it is made of.

        Raises
        ------
        IndexError
            There is no such phase or event.
        """
        records: Any = self.outcome.phases
        lasts = [0, *records["n_events"].tolist()]
        if not (0 <= phase < len(records) and 0 <= event < lasts[phase + 1] - lasts[phase]):
            raise IndexError(f"there is no event {event} in phase {phase} of this run")
        events: Any = self.outcome.events
        n_steps = events["n_steps"].tolist()
        place = lasts[phase] + event
        return sum(n_steps[:place]), n_steps[place]


def written(outcome: Outcome) -> Outcome:
    """Return a copy of what is written of an outcome, whose memory is used again."""
    n_phases, n_events, n_steps, n_contacts = outcome.counts.tolist()
    used = (4, n_phases, n_events, n_contacts, n_events, n_events, n_steps, n_phases, n_phases, n_steps, n_steps)
    arrays: tuple[Any, ...] = outcome
    copies = [array[:n].copy() for array, n in zip(arrays, used, strict=True)]
    for array in copies:
        array.flags.writeable = False  # results share these arrays
    return Outcome(*copies)


def _read_phases(scene: Scene, method: Method, outcome: Outcome) -> tuple[PhaseRun, ...]:
    phases: Any = outcome.phases
    codes = phases["verdict"].tolist()
    events = _divided(read_events(scene, method, outcome), phases["n_events"].tolist())
    ends = [of_phase[-1].pose_world_object for of_phase in events]
    contacts, proofs = judged(scene, outcome, ends)
    drives, presses = read_drives(scene, outcome), read_presses(scene, outcome)
    starts = [scene.object.pose_world_object, *ends]
    found = list[PhaseRun]()
    for index, (code, proof) in enumerate(zip(codes, proofs, strict=True)):
        verdict: Verdict = VERDICT_NAMES[code]
        found.append(
            _made(
                PhaseRun,
                name=scene.loads[index].name,
                verdict=proof.verdict if verdict == "rests" else verdict,
                start_pose=starts[index],
                events=tuple(events[index]),
                contacts=tuple(contacts[index]),
                proof=proof,
                drive=drives[index],
                press=presses[index],
            )
        )
    return tuple(found)


def read_events(scene: Scene, method: Method, outcome: Outcome) -> list[Event]:
    """Return the events of an outcome.

    Fields are read one after the other: a list of Python numbers takes a tenth of the time of its numbers one by one.
    """
    events: Any = outcome.events
    path = list[Pose]()
    if method.joins_steps:
        path = list(map(Pose.from_unit, outcome.path[:, :3], outcome.path[:, 3:]))
    poses = map(Pose.from_unit, events["position"], events["quaternion"])
    columns = zip(
        events["rule"].tolist(),
        events["note"].tolist(),
        _motions(outcome),
        outcome.hit.tolist(),
        outcome.touching.tolist(),
        poses,
        events["n_steps"].tolist(),
        strict=True,
    )
    shares = shares_of_steps(scene, outcome)
    found, first, elements = list[Event](), 0, scene.cage.element_names
    for rule, note, motion, hit, touching, pose, n_steps in columns:
        found.append(
            _made(
                Event,
                rule=method.rule_names[rule],
                motion=motion,
                hit=tuple(compress(elements, hit)),
                contacts=tuple(compress(elements, touching)),
                pose_world_object=path[first + n_steps - 1] if path else pose,
                note=NOTE_NAMES[note] if note < len(NOTE_NAMES) else None,
                path=tuple(path[first : first + n_steps]),
                share=shares[first + n_steps - 1],
            )
        )
        first += n_steps
    return found


def _motions(outcome: Outcome) -> Iterator[Motion | None]:
    events: Any = outcome.events
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
    point_names, box_names = scene.cage.element_names, scene.object.element_names
    columns = zip(
        contacts["cage_part"].tolist(),
        contacts["part"].tolist(),
        contacts["normal"],
        contacts["gap"].tolist(),
        contacts["near_edge"].tolist(),
        contacts["group"].tolist(),
        contacts["force_normal"].tolist(),
        contacts["force_tangential"],
        contacts["place"],
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
            place_world=place,
            group=group,
        )
        for point, box, normal, gap, near_edge, group, force_normal, force_tangential, place in columns
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
                _made(Contact, **{**vars(contact), "force_normal_n": None, "force_tangential_n": None})
                for contact in contacts[index]
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
