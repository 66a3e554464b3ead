"""A run as something to play: shots from the start to the end, and a row of words for each event."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cagepose.files.units import LengthUnit
from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.changes import Seen, as_seen
from cagepose.runs.driven_cage import CageAt, cage_at, cage_at_start
from cagepose.runs.further import LED
from cagepose.runs.on_the_way import is_driven_on, row_on_curve, share_before, value_at
from cagepose.runs.run import Contact, Event, Frame, Motion, PhaseRun, Run
from cagepose.studies.acts import Act, acts_of
from cagepose.studies.touching import PlacesOfContact, TouchFinder
from cagepose.views.viewer.surface import nearest_on_object

SHOTS_PER_MOTION = 24
"""One second of film for each motion."""
MOTIONS_PER_DRIVE = 4
"""A whole drive takes as long as so many motions."""
SHOTS_OF_A_LED_WAY = 24
"""At least: it may go around corners."""
MOST_SHOTS = 4_800
"""A run has at most so many shots, so that each of thousands of motions has fewer. A failed run of 3,000 took 29 MB and
6 s as a page."""
SHOWN_OF_ESCAPE = 0.6
"""How much of a travel without end is shown, in sizes of the scene; of a turn, in radians."""


@dataclass(frozen=True, eq=False)
class Touches:
    """What touches. Normals and forces are in the object's frame: so they stay as they are while the object moves.

    Attributes
    ----------
    points
        Indices of n of the cage's points and shapes, points first, (n,). A shape may touch in several places.
    boxes
        Names of the parts of the object that they touch.
    normals_object
        Outward unit normals of the object, (n, 3).
    forces_object
        Forces on the object, (n, 3), newtons or parts of the load; None: not known, as during a motion.
    places_world
        Where they touch, (n, 3), metres.
    """

    points: NDArray[np.int64]
    boxes: tuple[str, ...]
    normals_object: FloatArray
    forces_object: FloatArray | None
    places_world: FloatArray

    def chosen(self, which: Sequence[bool]) -> Touches:
        """Return those of which ``which`` says so, without forces."""
        boxes = tuple(itertools.compress(self.boxes, which))
        mask = np.array(which, dtype=bool)
        return Touches(self.points[mask], boxes, self.normals_object[mask], None, self.places_world[mask])


@dataclass(frozen=True, eq=False)
class Shot:
    """One moment of a run.

    Attributes
    ----------
    row
        Index of the event that is going on; -1 at the start.
    phase
        Index of the phase.
    pose_world_object, cage
        Where the object is, and where the bodies of the cage are.
    touches
        What touches there; of a cage of points without bodies one and the same for all shots on the way of a motion.
    share, along
        How much of the phase's drive is done, and the sum of the drivers' forces along their ways; None: none is
        driven yet.
    """

    row: int
    phase: int
    pose_world_object: Pose
    cage: CageAt
    touches: Touches
    share: float = 0.0
    along: float | None = None


@dataclass(frozen=True, eq=False)
class Row:
    """One event, for the list beside the picture.

    Attributes
    ----------
    phase
        Index of the phase.
    event, seen
        What happened, and how its motion looks.
    verdict
        How the phase ended, if this was its last event.
    first_shot, last_shot
        Where in the playback; the shot before ``first_shot`` is the one where the event began.
    """

    phase: int
    event: Event
    seen: Seen | None
    verdict: str | None
    first_shot: int
    last_shot: int


@dataclass(frozen=True, eq=False)
class Film:
    """The object on its way, as pictures show it.

    Attributes
    ----------
    scene, length_unit
        What is shown, and the unit of lengths on screen.
    points_world
        The points of the cage at the start, (n, 3), metres.
    shots, rows
        The film and its list of events.
    shots_per_motion
        How many shots each motion has, but for those of drives.
    loads
        For each phase that was run, what acts.
    """

    scene: Scene
    length_unit: LengthUnit
    points_world: FloatArray
    shots: tuple[Shot, ...]
    rows: tuple[Row, ...]
    shots_per_motion: int
    loads: tuple[tuple[Act, ...], ...]

    @property
    def greatest_forces(self) -> tuple[float, ...]:
        """The greatest contact force of each phase, newtons or parts of the load; 1 where none is known."""
        greatest = [0.0] * len(self.loads)
        for shot in self.shots:
            if shot.touches.forces_object is not None:
                found = float(np.linalg.norm(shot.touches.forces_object, axis=1).max(initial=0.0))
                greatest[shot.phase] = max(greatest[shot.phase], found)
        return tuple(force or 1.0 for force in greatest)


@dataclass(frozen=True, eq=False)
class Playback(Film):
    """All that a viewer shows of a run."""

    run: Run


def single_motion(scene: Scene, end: Pose, touching: tuple[str, ...], length_unit: LengthUnit) -> Film:
    """Return the object's way from its start to a pose, where what has these names touches; without loads."""
    at, start, cage = _TouchesAt(scene), scene.object.pose_world_object, cage_at_start(scene.cage)
    shots = (Shot(-1, 0, start, cage, at.of(start, cage, ())), Shot(0, 0, end, cage, at.of(end, cage, touching)))
    rows = (Row(0, Event("", None, (), touching, end, None), None, None, 1, 1),)
    return Film(scene, length_unit, scene.cage.points_world(), shots, rows, 1, ((),))


def playback(run: Run, length_unit: LengthUnit = "mm", shots_per_motion: int = SHOTS_PER_MOTION) -> Playback:
    """Turn a run into shots and rows; each motion gets ``shots_per_motion`` of them, or what `MOST_SHOTS` leaves, each
    finding one. A whole drive gets as many as `MOTIONS_PER_DRIVE` motions.
    """
    n_events = sum(len(phase.events) for phase in run.phases)
    shots_per_motion = max(1, min(shots_per_motion, MOST_SHOTS // max(n_events, 1)))
    camera = _Camera(run, shots_per_motion)
    for phase_index, phase in enumerate(run.phases):
        camera.shoot(phase_index, phase)
    loads = tuple(acts_of(run.scene, load) for load in run.scene.loads[: len(run.phases)])
    return camera.film(length_unit, loads)


def playback_led_on(before: Playback, run: Run) -> Playback:
    """Return the playback of a run that `further` has led on, given that of the run which it was led on from: what was
    shot of the phases that both have is taken over. In the last phase acts what acts in the one before.
    """
    last = len(run.phases) - 1
    camera = _Camera(run, before.shots_per_motion)
    camera.rows = [row for row in before.rows if row.phase < last]
    camera.shots = list(before.shots[: camera.rows[-1].last_shot + 1])
    camera.shoot(last, run.phases[last])
    return camera.film(before.length_unit, (*before.loads[:last], before.loads[last - 1]))


class _TouchesAt:
    """Finds what touches at poses of one scene."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.index = {name: index for index, name in enumerate(scene.cage.element_names)}
        self.finder = TouchFinder(scene) if scene.has_other_shapes else None

    def of(self, pose: Pose, cage: CageAt, names: tuple[str, ...]) -> Touches:
        """Return what touches of what has these names, while the bodies of the cage are where they are."""
        if not names:
            return Touches(self.indices(()), (), np.zeros((0, 3)), None, np.zeros((0, 3)))
        elements, scene = self.indices(names), self.scene
        n_solid = len(scene.cage.names) + len(scene.cage.shapes)
        found, left = [], elements
        if self.finder is not None:
            all_places = self.finder.at(pose, cage)
            is_asked = np.isin(all_places.elements, elements)
            found.append(all_places.chosen(is_asked))
            left = np.setdiff1d(elements, all_places.elements)
            left = left[left < n_solid]  # a hole has no place but where it touches
        if len(left) or not found:
            near = nearest_on_object(scene.object, pose, cage, left.tolist())
            found.insert(0, PlacesOfContact(left, near.parts, near.places_world, near.normals_world))
        each, parts, places, normals = (np.concatenate(columns) for columns in zip(*found, strict=True))
        boxes = tuple(scene.object.element_names[part] for part in parts.tolist())
        return Touches(each, boxes, normals @ pose.rotation, None, places)

    def indices(self, names: tuple[str, ...]) -> NDArray[np.int64]:
        return np.array([self.index[name] for name in names], dtype=np.int64)


class _Camera:
    def __init__(self, run: Run, shots_per_motion: int) -> None:
        self.run = run
        self.shots_per_motion = shots_per_motion
        self.points_world = run.scene.cage.points_world()
        self.at = _TouchesAt(run.scene)
        self.moves = bool(self.at.finder or run.scene.cage.bodies)  # places of contacts do, on the way of a motion
        start, cage = run.phases[0].start_pose, cage_at_start(run.scene.cage)
        self.shots: list[Shot] = [Shot(-1, 0, start, cage, self.at.of(start, cage, ()))]
        self.rows: list[Row] = []
        self._asked, self._found = (0, 0.0), cage

    def film(self, length_unit: LengthUnit, loads: tuple[tuple[Act, ...], ...]) -> Playback:
        """Return what was shot."""
        shots, rows = tuple(self.shots), tuple(self.rows)
        scene = self.run.scene
        return Playback(scene, length_unit, self.points_world, shots, rows, self.shots_per_motion, loads, self.run)

    def shoot(self, phase_index: int, phase: PhaseRun) -> None:
        pose, before = phase.start_pose, frozenset[str]()
        for index, event in enumerate(phase.events):
            last = event is phase.events[-1]
            first_shot, row = len(self.shots), len(self.rows)
            escape = _escape(phase, self.run.scene.size_m) if last else None
            end = event.pose_world_object if escape is None else escape.pose_at(pose, 1.0)
            cage = self._cage(phase_index, event.share)
            touches = self.at.of(end, cage, event.contacts)
            stays = tuple(name for name in event.contacts if name in before)
            kept = touches.chosen([name in before for name in event.contacts]) if not self.moves else None
            for frame in self._way(phase_index, index, pose, escape):  # places on what is round, or driven, move along
                way, at = frame.pose_world_object, self._cage(phase_index, frame.share)
                along = self._along(phase, index, frame.fraction)
                touching = kept or self.at.of(way, at, stays)
                self.shots.append(Shot(row, phase_index, way, at, touching, frame.share, along))
            if last and escape is None:
                touches = self._held(end, cage, phase.contacts)
            along = self._along(phase, index, 1.0)
            self.shots.append(Shot(row, phase_index, end, cage, touches, event.share, along))
            verdict = phase.verdict if last else None
            seen = as_seen(event, pose, self.run.scene)
            self.rows.append(Row(phase_index, event, seen, verdict, first_shot, len(self.shots) - 1))
            pose, before = event.pose_world_object, frozenset(event.contacts)

    def _cage(self, phase_index: int, share: float) -> CageAt:
        """Return the cage where so much of a drive is done: one and the same while no body moves."""
        asked = (phase_index, share)
        if asked != self._asked:
            self._asked = asked
            found = cage_at(self.run, phase_index, share)
            before = self.shots[-1].cage.displaced
            stands = all(map(_is_same, found.displaced, before))
            self._found = self.shots[-1].cage if stands else found
        return self._found

    @staticmethod
    def _along(phase: PhaseRun, event_index: int, fraction: float) -> float | None:
        row = row_on_curve(phase, event_index, fraction)
        return None if row is None or phase.drive is None else value_at(phase.drive.curve.along, row)

    def _way(self, phase_index: int, event_index: int, start: Pose, escape: Motion | None) -> list[Frame]:
        phase = self.run.phases[phase_index]
        event = phase.events[event_index]
        n_shots = self.shots_per_motion
        if escape is not None:
            return [
                Frame(phase_index, event_index, step / n_shots, escape.pose_at(start, step / n_shots), event.share)
                for step in range(1, n_shots)
            ]
        if is_driven_on(phase, event_index):
            way = event.share - share_before(phase, event_index)
            n_shots = math.ceil(MOTIONS_PER_DRIVE * way * n_shots)
        elif event.motion is None:
            return []
        elif event.rule == LED:
            n_shots = max(n_shots, SHOTS_OF_A_LED_WAY)
        return [self.run.frame_at(phase_index, event_index, step / n_shots) for step in range(1, n_shots)]

    def _held(self, pose: Pose, cage: CageAt, contacts: tuple[Contact, ...]) -> Touches:
        if not contacts:
            return self.at.of(pose, cage, ())
        forces = [_force(contact) for contact in contacts]
        elements = self.at.indices(tuple(contact.point for contact in contacts))
        return Touches(
            elements,
            tuple(contact.box for contact in contacts),
            np.array([contact.normal_world for contact in contacts]) @ pose.rotation,
            None if any(force is None for force in forces) else np.array(forces) @ pose.rotation,
            np.array(
                [
                    cage.points_world[element] if contact.place_world is None else contact.place_world
                    for element, contact in zip(elements.tolist(), contacts, strict=True)
                ]
            ),
        )


def _is_same(one: Pose, other: Pose) -> bool:
    pairs = ((one.position_m, other.position_m), (one.quaternion_wxyz, other.quaternion_wxyz))
    return all(np.array_equal(*pair) for pair in pairs)


def _escape(phase: PhaseRun, size_m: float) -> Motion | None:
    """Return as much as is shown of the motion by which an object gets away at the end of a phase."""
    motion = phase.events[-1].motion
    if phase.verdict != "escapes" or motion is None or math.isfinite(motion.distance_m):
        return None
    onset = phase.proof.motion
    if onset is None or phase.events[-1].rule != "escapes":  # the paper's rules let it travel
        return replace(motion, distance_m=SHOWN_OF_ESCAPE * size_m)
    way_m, angle = (
        (SHOWN_OF_ESCAPE * size_m, 0.0)
        if onset.kind == "travel"
        else (SHOWN_OF_ESCAPE * onset.pitch_m, SHOWN_OF_ESCAPE)
    )
    return Motion(onset.kind, onset.direction_world, onset.axis_world, onset.through_world, way_m, angle)


def _force(contact: Contact) -> FloatArray | None:
    if contact.force_normal_n is None:
        return None
    sideways = np.zeros(3) if contact.force_tangential_n is None else contact.force_tangential_n
    force: FloatArray = sideways - contact.force_normal_n * contact.normal_world
    return force
