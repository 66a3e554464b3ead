"""What happened: `Run`, its phases, events, motions and contacts."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from cagepose.kernels.algebra.pose import moved_pose
from cagepose.kernels.outcome import motion as kernel
from cagepose.kernels.outcome.trace import MOTION_NAMES, NONE, TRAVEL
from cagepose.model.above import from_above
from cagepose.model.checks import FloatArray, as_vector
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.model.wording import coordinates, counted, few
from cagepose.runs.driven import DriveRun, PressRun
from cagepose.runs.frames import contact_columns, data_frame, drive_columns, event_columns
from cagepose.runs.on_the_way import first_row, is_driven_on, row_on_curve, shares_of, value_at
from cagepose.runs.proof import Proof

MotionKind = Literal["travel", "turn", "screw"]
Note = Literal["tie", "balanced", "small turn", "edge tie", "edge", "could stay"]
Verdict = Literal[
    "stable",
    "rests",
    "may rest",
    "moves",
    "escapes",
    "spins",
    "cycling",
    "stalled",
    "limit",
    "blocked",
    "jams",
    "stops",
]

FAILURES: frozenset[Verdict] = frozenset({"spins", "cycling", "stalled", "limit"})
"""Verdicts that name a run which did not find an end. None of them is a rest."""

AT_REST: frozenset[Verdict] = frozenset({"stable", "rests", "may rest"})
"""Verdicts that name a rest. The next phase starts after it."""

STOPPED: frozenset[Verdict] = frozenset({"blocked", "jams", "stops"})
"""Verdicts of a drive that does not go on, though nothing failed. The next phase starts after it."""

CONTRADICTED = "by the paper's rules; by the mechanics it moves on from there"
"""What is told behind the verdict of a run that is contradicted."""


@dataclass(frozen=True, eq=False)
class Motion:
    """A travel, a turn or a screw, exactly: the object moves ``distance_m`` along and ``angle_rad`` about one line.

    Attributes
    ----------
    kind
        "travel" (no angle), "turn" (no distance along the axis, however far off that is: a long slide that tips by a
        little is one; tables and pictures tell it as it looks) or "screw".
    distance_m, angle_rad
        How far; a travel that meets nothing has an infinite distance (the object escapes).
    direction_world
        Unit vector of a travel, (3,); None for a turn or a screw.
    axis_world, through_world
        Unit vector of the axis and a point on it, (3,) each, metres; None for a travel. Turns are right-handed.
    """

    kind: MotionKind
    direction_world: FloatArray | None
    axis_world: FloatArray | None
    through_world: FloatArray | None
    distance_m: float
    angle_rad: float

    def __repr__(self) -> str:
        line = f" {'along' if self.kind == 'travel' else 'about'} {coordinates(self.line_world, 4)}"
        distance = "" if self.kind == "turn" else f" {self.distance_m:.6g} m"
        angle = "" if self.kind == "travel" else f" {self.angle_rad:.6g} rad"
        return f"<Motion: {self.kind}{distance}{angle}{line}>"

    @property
    def line_world(self) -> FloatArray:
        """The direction of a travel, or the axis of a turn or a screw: a unit vector, (3,)."""
        line = self.direction_world if self.axis_world is None else self.axis_world
        assert line is not None
        return line

    def pose_at(self, start: Pose, fraction: float) -> Pose:
        """Return where an object is that was at ``start``, after ``fraction`` (0 to 1) of the motion.

        Raises
        ------
        ValueError
            A travel without end (the object escapes) has no fractions.
        """
        if math.isinf(self.distance_m):
            raise ValueError("this travel has no end, so there is no pose at a fraction of it")
        through = np.zeros(3) if self.through_world is None else self.through_world
        moved = moved_pose(
            *start.as_tuples(),
            as_vector(self.line_world),
            as_vector(through),
            self.distance_m * fraction,
            self.angle_rad * fraction,
        )
        return Pose(*moved)


@dataclass(frozen=True, eq=False)
class Contact:
    """One place where the object and the cage touch at the end of a phase.

    Attributes
    ----------
    point, box
        Names of the cage's point or shape, and of the object's box or shape.
    normal_world
        Outward unit normal of the face, (3,): from the object towards the point. The contact pushes the object along
        -n.
    gap_m
        Distance from the face, within the touch tolerance; below zero: inside.
    near_edge
        The point lies within the touch tolerance of an edge where the object's surface really ends.
    force_normal_n, force_tangential_n
        Force on the object: its part along -n, and the rest, (3,), in the world. Newtons if mass and magnitude are
        given as far as they count, else per unit load. None where no forces balance the load.
    place_world
        Where they touch, (3,), metres: the cage's point, or a point of the surface of the cage's shape. None in a run
        that was saved before contacts had it.
    group
        Of contacts with the same number one counts at a time: faces at an edge that a point is on, and the normals of
        sharp features that meet at one place. It is the place of the first of them among the phase's contacts, from 0.
        In older saved runs -1: the contact never counts, as another says all that it does; or None.
    """

    point: str
    box: str
    normal_world: FloatArray
    gap_m: float
    near_edge: bool
    force_normal_n: float | None = None
    force_tangential_n: FloatArray | None = None
    place_world: FloatArray | None = None
    group: int | None = None

    def __repr__(self) -> str:
        force = "" if self.force_normal_n is None else f": normal force {self.force_normal_n:.4g}"
        return f"<Contact of {self.point!r} with {self.box!r}{force}>"


@dataclass(frozen=True, eq=False)
class Event:
    """The end of one motion, or a finding without one.

    Attributes
    ----------
    rule
        The rule that chose the motion: "A-1" ... "B-4", "Slp-1", "Slp-2".
    motion
        None for a finding without motion (such as "stable" by A-4).
    hit
        Names of the points reached by this motion.
    contacts
        Names of all points that touch after it.
    pose_world_object
        Where the object is after it.
    note
        What a careful reader should know of it: "tie" (the load has no moment about the axis, so the sense of turning
        was decided by convention), "balanced" (the load's line passes through the one contact that holds), "small
        turn" (held, though the load could still turn the object by less than counts), "edge tie" (a contact on an edge
        whose faces make the same angle with the push), "edge" (it begins to move only because a contact lies exactly on
        an edge: with another face of that the contacts would hold it), "could stay" (friction could hold it where it
        begins, or on the way, and it goes on because it moves); None: nothing.
    share
        How much of the phase's drive, or of the ways of what presses, is done after it, from 0 to 1.
    path
        Poses on the way to ``pose_world_object``, the last of them, where the way is not that of ``motion`` alone (a
        sliding contact bends it); empty: it is.
    """

    rule: str
    motion: Motion | None
    hit: tuple[str, ...]
    contacts: tuple[str, ...]
    pose_world_object: Pose
    note: Note | None
    path: tuple[Pose, ...] = ()
    share: float = 0.0

    def __repr__(self) -> str:
        moved = "no motion" if self.motion is None else self.motion.kind
        hit = f", hits {few(self.hit)}" if self.hit else ""
        return f"<Event {self.rule!r}: {moved}{hit}; {len(self.contacts)} touching>"


@dataclass(frozen=True, eq=False)
class PhaseRun:
    """One load from its start to its verdict.

    Attributes
    ----------
    name, verdict
        The load's name, and how it ended.
    start_pose, events
        Where it began, and what happened.
    contacts
        At the end, with what they carry if the load is balanced.
    proof
        What the mechanics says of the pose at the end, whatever the method.
    drive
        What came of the drive of bodies of the cage; None: nothing was driven, or the object did not come to rest
        before it.
    press
        What the bodies of the cage did that press; None: none does.
    """

    name: str
    verdict: Verdict
    start_pose: Pose
    events: tuple[Event, ...]
    contacts: tuple[Contact, ...]
    proof: Proof
    drive: DriveRun | None = None
    press: PressRun | None = None

    def __repr__(self) -> str:
        counts = counted((len(self.events), "event", "events"), (len(self.contacts), "contact", "contacts"))
        return f"<PhaseRun {self.name!r}: {self.verdict}{f'; {counts}' if counts else ''}>"

    @property
    def pose(self) -> Pose:
        """The object's pose at the end of the phase."""
        return self.events[-1].pose_world_object if self.events else self.start_pose

    @property
    def is_contradicted(self) -> bool:
        """Whether the paper's rules end at rest where no forces balance the load."""
        return self.verdict == "stable" and self.proof.verdict == "moves"


@dataclass(frozen=True, eq=False)
class Frame:
    """One picture of a run.

    Attributes
    ----------
    phase_index, event_index
        Where in the run; ``event_index`` is -1 for the start pose.
    fraction
        How much of the event's motion is done, above 0 to 1.
    pose_world_object
        Where the object is.
    share
        How much of the phase's drive, or of the ways of what presses, is done, from 0 to 1.
    """

    phase_index: int
    event_index: int
    fraction: float
    pose_world_object: Pose
    share: float = 0.0

    def __repr__(self) -> str:
        place = f"phase {self.phase_index}, event {self.event_index}, fraction {self.fraction:.4g}"
        share = f", {self.share:.4g} of the drive" if self.share else ""
        return f"<Frame: {place}{share}, {self.pose_world_object}>"


@dataclass(frozen=True, eq=False)
class Run:
    """The answer to a scene.

    Attributes
    ----------
    scene, method
        What was asked, and how it was answered.
    phases
        One for each load that was run: a phase that does not end at rest stops the run.
    warnings
        What a careful reader of the result should know.
    solve_s
        Wall time of the compiled run, seconds.
    """

    scene: Scene
    method: str
    phases: tuple[PhaseRun, ...]
    warnings: tuple[str, ...]
    solve_s: float

    def __repr__(self) -> str:
        ended = ", ".join(f"{phase.name}: {phase.verdict}" for phase in self.phases)
        return f"<Run of {self.scene.name!r} ({self.method}): {ended}>"

    def __str__(self) -> str:
        """What ``cagepose run`` prints, lengths in millimetres."""
        text: str = from_above("text")(self)
        return text

    def _repr_html_(self) -> str:
        """What a notebook shows: the page that plays it, and the same text."""
        html: str = from_above("run as html")(self)
        return html

    def __getattr__(self, name: str) -> object:
        """Read phases and warnings from the solution, once, when they are first asked for."""
        solution = vars(self).get("solution")
        if solution is None or name not in ("phases", "warnings"):
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
        found: object = solution.phases() if name == "phases" else solution.warnings(self.phases)
        vars(self)[name] = found
        return found

    @property
    def verdict(self) -> Verdict:
        """The verdict of the last phase that was run."""
        return self.phases[-1].verdict

    @property
    def failed(self) -> bool:
        """Whether the run ended without an answer (spins, cycling, stalled, limit)."""
        return self.verdict in FAILURES

    @property
    def is_contradicted(self) -> bool:
        """Whether the last phase is."""
        return self.phases[-1].is_contradicted

    @property
    def pose(self) -> Pose:
        """The object's pose at the end."""
        return self.phases[-1].pose

    @property
    def contacts(self) -> tuple[Contact, ...]:
        """The contacts at the end."""
        return self.phases[-1].contacts

    @property
    def center_of_gravity_world(self) -> FloatArray:
        """The centre of gravity at the end, (3,), metres."""
        return self.pose.transform(self.scene.object.center_of_gravity_m)

    def to_frame(self, rows: Literal["events", "contacts", "drive"] = "events") -> Any:
        """Return a ``pandas.DataFrame`` with a row for each event; for each contact at the end of each phase, with the
        force that it carries; or for each place along a drive, with how much of it is done, the drivers' force and the
        object's pose. Lengths are metres, angles radians; what there is none of is NaN.

        Raises
        ------
        MissingExtraError
            There is no pandas.
        ValueError
            Other rows.
        """
        if rows == "events":
            return data_frame(event_columns(self.phases))
        if rows == "contacts":
            return data_frame(contact_columns(self.scene, self.phases))
        if rows == "drive":
            return data_frame(drive_columns(self.phases))
        raise ValueError(f"rows is {rows!r}; give 'events', 'contacts' or 'drive'")

    def frames(self, per_turn: int = 10) -> Iterator[Frame]:
        """Yield the start pose, then ``per_turn`` pictures of each turn or screw and of each event in which a drive
        goes on, and one of each other travel.

        Those of a bent way lie on it: see `Event.path`.

        Raises
        ------
        ValueError
            ``per_turn`` below 1.
        """
        if per_turn < 1:
            raise ValueError(f"per_turn is {per_turn}; give at least 1")
        yield Frame(0, -1, 1.0, self.phases[0].start_pose)
        for phase_index, phase in enumerate(self.phases):
            for event_index, event in enumerate(phase.events):
                goes_on = is_driven_on(phase, event_index)
                if event.motion is None and not goes_on:
                    continue
                is_one = event.motion is not None and event.motion.kind == "travel" and not goes_on
                n_frames = 1 if is_one else per_turn
                for step in range(1, n_frames):
                    yield self.frame_at(phase_index, event_index, step / n_frames)
                yield Frame(phase_index, event_index, 1.0, event.pose_world_object, event.share)

    def frame_at(self, phase_index: int, event_index: int, fraction: float) -> Frame:
        """Return what is to be seen after ``fraction`` (0 to below 1) of an event.

        Where its phase's drive goes on in it, or what presses, that does so evenly.

        Raises
        ------
        ValueError
            The event is a travel without end, or neither a motion nor a drive that goes on.
        """
        phase = self.phases[phase_index]
        event = phase.events[event_index]
        start = phase.events[event_index - 1].pose_world_object if event_index else phase.start_pose
        row, shares = row_on_curve(phase, event_index, fraction), shares_of(phase)
        if shares is None or row is None or not is_driven_on(phase, event_index):
            return Frame(phase_index, event_index, fraction, self.pose_on_the_way(start, event, fraction), event.share)
        first = first_row(phase, event_index) or 0
        pose = self._pose_on_path(start, event, row - first)
        return Frame(phase_index, event_index, fraction, pose, value_at(shares, row))

    def pose_on_the_way(self, start: Pose, event: Event, fraction: float) -> Pose:
        """Return where the object is after ``fraction`` (0 to below 1) of an event's motion that began at ``start``.

        Raises
        ------
        ValueError
            The event is no motion, or a travel without end.
        """
        if event.motion is None:
            raise ValueError(f"the event {event.rule!r} is no motion, so there is no way to be on")
        if not event.path:
            return event.motion.pose_at(start, fraction)
        return self._pose_on_path(start, event, fraction * len(event.path))

    def _pose_on_path(self, start: Pose, event: Event, place: float) -> Pose:
        """Return where the object is at a place of an event's path: 1.5 is midway between its first two poses."""
        n_done = int(place)
        if n_done >= len(event.path):
            return event.pose_world_object
        before = event.path[n_done - 1] if n_done else start
        step = motion_between(before, event.path[n_done], self.scene.object.center_of_gravity_m, self.scene.size_m)
        return before if step is None else step.pose_at(before, place - n_done)


def motion_between(start: Pose, end: Pose, center_object_m: FloatArray, size_m: float) -> Motion | None:
    """Return the one motion from ``start`` to ``end`` (Chasles); None: they are one pose.

    ``center_object_m``: a point of the object, (3,), whose way is measured; it sets what counts as rounding.
    ``size_m``: how far the object's points are apart at most, or more.
    """
    before, after = as_vector(start.transform(center_object_m)), as_vector(end.transform(center_object_m))
    found = kernel.motion_between(before, start.as_tuples()[1], after, end.as_tuples()[1], size_m, (0.0, 0.0, 0.0))
    if found.motion == NONE:
        return None
    along, through = np.array(found.along), np.array(found.through)
    if found.motion == TRAVEL:
        return Motion("travel", along, None, None, found.distance, 0.0)
    return Motion(MOTION_NAMES[found.motion], None, along, through, found.distance, found.angle)
