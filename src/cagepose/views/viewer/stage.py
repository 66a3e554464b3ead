"""The room that a playback is drawn in: its scale follows the scene's size, and play can be exaggerated.

Drawing coordinates have the scene's size as their unit and the middle of the scene as their origin, so that a scene in
millimetres and one in metres look alike.

Exaggeration by k shows the object k times as far from a reference pose, turned k times as much; a cage point is shown k
times as far from the nearest place of the object at the reference, a shape of the cage as a whole. A hole goes with
what it is cut out of, and its play around what stands in it is k times as wide. To first order in the motion, the gaps
on screen are then k times the true ones: what touches on screen touches. (Of a shape this holds where it comes to touch
along the way on which it was nearest.) A body of the cage that can be driven goes as one with what is nearest of it,
and no farther than exaggerated motions reach: else one that waits for its phase would be out of the picture.

Each phase has an exaggeration of its own. A long travel, such as the way into the cage, is shown as it is, and what
follows is measured from its end. So is a motion to what was not nearest before, which would not touch on screen.
"""

from __future__ import annotations

import itertools
import math
import operator
from collections.abc import Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np

from cagepose.kernels.algebra.pose import quaternion_about, rotation_vector
from cagepose.model.checks import FloatArray
from cagepose.model.hole import Hole
from cagepose.model.pose import Pose
from cagepose.runs.driven_cage import CageAt
from cagepose.views.solids import REACHES_OF_VIEW, cut_off, outer_points, vertices_of
from cagepose.views.viewer.playback import Film, Touches
from cagepose.views.viewer.surface import nearest_on_object

EXAGGERATIONS = (1, 2, 5, 10, 20, 50, 100, 200)
"""What a slider offers."""
MOST_TURN_RAD, MOST_WAY = math.radians(10.0), 0.15
"""The exaggeration that is proposed shows no greater turn, and no longer way in sizes of the scene. A motion that would
pass this at twice its size is a long one.
"""
MOST_PARTED, LONG_AT = 0.04, 10.0
"""In sizes of the scene: nor do contacts part farther on screen. A motion at whose end they would at ten times its size
is a long one, too, as where a screw falls into its seat: what touches then is not what was nearest before.
"""
MOST_ADDED = 0.5
"""A cage point is moved away from the object by at most this many sizes: one that is far off must stay in the picture.
"""
GREATEST_ENLARGEMENT = 1.5
"""A picture shows bodies of the cage as a whole if it need not be more than so many times as large for it."""
SIZE_STEP = 1.25
"""The unit of drawing is the scene's size, less so many such steps as what is shown of it is smaller."""
MOTION_AT_REST = 1e-7
"""Radians, and sizes of the scene. What moves less stands still but for rounding."""
LEAST_SEEN = 1e-6
"""Sizes of the scene, and radians. Less is not seen."""
EASED_SHARE = 0.25
"""Share of a motion that an exaggeration takes to pass into another."""


class PhaseView(NamedTuple):
    """What a phase is measured from.

    Attributes
    ----------
    first, last
        Its first and its last shot.
    start
        The shot from which on motions are exaggerated: the end of its last long motion, else the end of the phase
        before.
    reference
        The shot whose pose all is measured from.
    proposed
        The greatest of `EXAGGERATIONS` that keeps every turn and way small on screen, and what touches together; 1
        where nothing moves.
    """

    first: int
    last: int
    start: int
    reference: int
    proposed: int


class Look(NamedTuple):
    """How one moment is shown: exaggerated by ``factor``, from the pose of the shot ``reference``, with the bodies of
    the cage where they are in ``cage``.
    """

    reference: int
    factor: float
    cage: CageAt


class Stage:
    """Where things of a playback are drawn.

    Attributes
    ----------
    middle_world
        The origin of drawing coordinates, (3,), metres.
    size_m
        Their unit: the size of the scene, or of what is shown of it.
    bodies_world
        Points whose hull is that of each shape of the cage, as far as they are shown: tuples of (n, 3), metres. Those
        of a body that is driven are where it starts and where it is after each event.
    reach_m
        So far from the object and the points, along each axis, are they shown.
    middles_world
        Of each of these at the start, and the mouth of each hole of the cage, (n, 3), metres.
    radius
        A sphere about the origin that holds the cage and the object at the start and the end, in drawing units.
    phases
        What each phase is measured from.
    """

    def __init__(self, shown: Film, before: Stage | None = None) -> None:
        """``before``: the stage of a playback whose first phases are those of this one, but for its last; what was
        found out about these is taken over.
        """
        scene, held = shown.scene, shown.scene.object
        self.shown = shown
        self.center_object_m = held.center_of_gravity_m
        self._gaps: dict[int, FloatArray] = {}
        self._known: tuple[PhaseView, ...] = ()
        if before is not None:
            self._known = before.phases[: shown.rows[-1].phase]
            self._gaps = {shot: gaps for shot, gaps in dict(before._gaps).items() if shot <= self._known[-1].last}
        ends = (shown.shots[0].pose_world_object, shown.shots[-1].pose_world_object)
        cages = _distinct([shown.shots[0].cage, *(shown.shots[row.last_shot].cage for row in shown.rows)])
        points = (cage.points_world for cage in cages)
        everything = np.concatenate([*points, *(pose.transform(outer_points(held)) for pose in ends)])
        bodies = [_everywhere(cages, which) for which in range(len(scene.cage.shapes))]
        whole = _extent([everything, *bodies])
        near = [cut_off(body, everything, held.reach_m) for body in bodies]
        is_whole = whole <= GREATEST_ENLARGEMENT * _extent([everything, *near])
        self._needed = None if is_whole else everything
        self.bodies_world = tuple(bodies if is_whole else near)
        self.reach_m = whole if is_whole else REACHES_OF_VIEW * held.reach_m
        start = cages[0]
        shapes = [self._as_far_as_shown(_everywhere(cages[:1], which)) for which in range(len(bodies))]
        holes = range(len(shapes), len(shapes) + len(scene.cage.holes))
        mouths = [start.pose_of_shape(which).position_m for which in holes]
        self.middles_world = np.array([*(shape.mean(axis=0) for shape in shapes), *mouths]).reshape(-1, 3)
        everything = np.concatenate([everything, *self.bodies_world])
        self.middle_world: FloatArray = (everything.min(axis=0) + everything.max(axis=0)) / 2.0
        radius_m = float(np.linalg.norm(everything - self.middle_world, axis=1).max())
        # Of a ball on a large table the scene's size is that of the table, of which little is shown. In steps from what
        # no slider changes: a page need not build its shapes anew for each answer.
        steps = math.floor(math.log(scene.size_m / (2.0 * radius_m), SIZE_STEP)) if bodies else 0
        self.size_m: float = scene.size_m / SIZE_STEP ** max(0, steps)
        self.radius = radius_m / self.size_m

    def driven_bodies(self, look: Look) -> list[FloatArray]:
        """Return points whose hull is that of each shape of bodies that can be driven, (n, 3), metres, as shown."""
        cage, shifts = look.cage.cage, self.shifts(look)
        n_points = len(cage.names)
        return [
            self._as_far_as_shown(_everywhere([look.cage], which) + shifts[n_points + which])
            for which in range(len(cage.shapes))
            if cage.element_bodies[n_points + which]
        ]

    def _as_far_as_shown(self, body: FloatArray) -> FloatArray:
        """Return points of a body of the cage, (n, 3), metres, those far from what must be seen moved near."""
        return body if self._needed is None else cut_off(body, self._needed, self.reach_m)

    def place(self, point_world: FloatArray) -> FloatArray:
        """Return a point of the world, (3,) or (n, 3) in metres, in drawing coordinates."""
        drawn: FloatArray = (point_world - self.middle_world) / self.size_m
        return drawn

    @cached_property
    def phases(self) -> tuple[PhaseView, ...]:
        views = list(self._known)
        for phase, group in itertools.groupby(self.shown.rows, lambda row: row.phase):
            rows = list(group)
            if phase < len(self._known):
                continue
            before = views[-1] if views else PhaseView(0, 0, 0, 0, 1)
            long = [row.last_shot for row in rows if self._is_long(row.first_shot - 1, row.last_shot)]
            start, reference = (long[-1], long[-1]) if long else (before.last, before.reference)
            last = rows[-1].last_shot
            views.append(PhaseView(before.last, last, start, reference, self._proposed(reference, start, last)))
        return tuple(views)

    @property
    def proposed(self) -> tuple[int, ...]:
        """The exaggeration that is proposed for each phase."""
        return tuple(phase.proposed for phase in self.phases)

    def look(self, shot: int, exaggerations: Sequence[float]) -> Look:
        """Return how a shot is shown, exaggerated by so much in each phase."""
        index, cage = next(index for index, phase in enumerate(self.phases) if shot <= phase.last), self.cage(shot)
        phase = self.phases[index]
        before = Look(0, exaggerations[0] if phase.start == 0 else 1.0, cage)
        if index > 0:
            ended = self.phases[index - 1]
            before = Look(ended.reference, exaggerations[index - 1] if ended.start < ended.last else 1.0, cage)
        if phase.start > phase.first:  # a long motion
            if shot <= phase.start:
                return Look(before.reference, self._passing(before.factor, 1.0, phase.first, phase.start, shot), cage)
            before = Look(phase.reference, 1.0, cage)
        factor = self._passing(before.factor, exaggerations[index], phase.start, phase.last, shot)
        return Look(phase.reference, factor, cage)

    def cage(self, shot: int) -> CageAt:
        """Return the cage of a shot, its bodies where they are then."""
        return self.shown.shots[shot].cage

    def _passing(self, factor: float, other: float, first: int, last: int, shot: int) -> float:
        room = min(max(1.0, EASED_SHARE * self.shown.shots_per_motion), last - first)
        return factor + (other - factor) * (min(1.0, (shot - first) / room) if room else 1.0)

    def pose(self, pose_world_object: Pose, look: Look) -> Pose:
        """Return the pose, in the world and in metres, at which the object is shown."""
        if look.factor == 1.0:
            return pose_world_object
        reference = self.shown.shots[look.reference].pose_world_object
        before = reference.transform(self.center_object_m)
        center = before + look.factor * (pose_world_object.transform(self.center_object_m) - before)
        turn = _turn_vector(reference, pose_world_object)
        turned = _from_turn_vector(look.factor * turn) @ reference
        return Pose(center - turned.rotation @ self.center_object_m, turned.quaternion_wxyz)

    def gaps_world(self, reference: int) -> FloatArray:
        """Return, from the place of the object at a reference that is nearest to each of the cage's points and shapes,
        the way to the place there, (n, 3), metres; of a hole, that of what it is cut out of, and of a body that can be
        driven, that of what is nearest.
        """
        if reference not in self._gaps:
            scene = self.shown.scene
            pose = self.shown.shots[reference].pose_world_object
            nearest = nearest_on_object(scene.object, pose, self.cage(reference))
            gaps = nearest.places_world - nearest.feet_world
            index = {name: number for number, name in enumerate(scene.cage.element_names)}
            bodies = [next((index[name] for name in hole.in_), None) for hole in scene.cage.holes]
            with_bodies = [np.zeros(3) if body is None else gaps[body] for body in bodies]
            self._gaps[reference] = self._as_one(np.concatenate([gaps, np.array(with_bodies).reshape(-1, 3)]))
        return self._gaps[reference]

    def _as_one(self, gaps: FloatArray) -> FloatArray:
        """Return gaps of the cage's elements, (n, 3), those of each body that can be driven all like its least."""
        cage = self.shown.scene.cage
        bodies, n_solid = np.array(cage.element_bodies), len(cage.names) + len(cage.shapes)
        for body in range(1, 1 + len(cage.bodies)):
            solid = np.nonzero(bodies[:n_solid] == body)[0]
            if len(solid):
                gaps[bodies == body] = gaps[solid[np.linalg.norm(gaps[solid], axis=1).argmin()]]
        return gaps

    @cached_property
    def plays(self) -> tuple[FloatArray, FloatArray]:
        """How much wider each hole is than what stands in it at the end, metres, of the object's holes and of the
        cage's; zero where nothing does.
        """
        held, pose, at = self.shown.scene.object, self.shown.shots[-1].pose_world_object, self.cage(-1)
        shapes, holes = at.cage.shapes, at.cage.holes
        others = [at.pose_of_cage(which).transform(vertices_of([shape])) for which, shape in enumerate(shapes)]
        others_world = np.concatenate([np.zeros((0, 3)), *others])
        own_world = pose.transform(vertices_of(held.shapes))
        around = [_play(hole, pose @ hole.pose_body_shape, others_world) for hole in held.holes]
        within = [_play(hole, at.pose_of_shape(which), own_world) for which, hole in enumerate(holes, len(shapes))]
        return np.array(around), np.array(within)

    def shifts(self, look: Look) -> FloatArray:
        """Return how far each of the cage's points, shapes and holes is moved from its place, (n, 3), metres."""
        if look.factor == 1.0:
            return np.zeros((len(self.shown.scene.cage.element_names), 3))
        gaps = self.gaps_world(look.reference)
        lengths = np.maximum(np.linalg.norm(gaps, axis=1, keepdims=True), MOTION_AT_REST * self.size_m)
        bodies = np.array(self.shown.scene.cage.element_bodies)[:, None]
        of_bodies = np.maximum(MOST_WAY * self.size_m - lengths, 0.0)
        most = np.where(bodies > 0, of_bodies, MOST_ADDED * self.size_m) / lengths
        moved: FloatArray = np.minimum(look.factor - 1.0, most) * gaps
        return moved

    def touch_shifts(self, touches: Touches, look: Look) -> FloatArray:
        """Return how far each contact is shown from its place, (n, 3), metres; on the wall of a hole of the cage, as
        far out as that.
        """
        cage = self.shown.scene.cage
        shifts = self.shifts(look)[touches.points]
        first = len(cage.names) + len(cage.shapes)
        for row in np.nonzero(touches.points >= first)[0].tolist():
            number = int(touches.points[row]) - first
            hole = look.cage.pose_of_shape(len(cage.shapes) + number)
            out = hole.inverse_transform(touches.places_world[row]) * [1.0, 1.0, 0.0]
            aside = float(np.linalg.norm(out)) or 1.0
            shifts[row] += hole.rotation @ out * ((look.factor - 1.0) * self.plays[1][number] / aside)
        return shifts

    def is_magnified(self, shot: int, look: Look) -> bool:
        """Whether anything of a look is larger than it is: where nothing has moved and all touches, nothing is."""
        if look.factor == 1.0:
            return False
        pose = self.shown.shots[shot].pose_world_object
        shown = self.pose(pose, look)
        way = shown.transform(self.center_object_m) - pose.transform(self.center_object_m)
        moved = np.concatenate([way[None], self.shifts(look)]) / self.size_m
        plays = (look.factor - 1.0) * np.concatenate(self.plays) / self.size_m
        turned = np.linalg.norm(_turn_vector(pose, shown))
        return bool(max(np.linalg.norm(moved, axis=1).max(), plays.max(initial=0.0), turned) > LEAST_SEEN)

    def points(self, look: Look) -> FloatArray:
        """Return where the cage points are shown, (n, 3), metres in the world."""
        moved: FloatArray = look.cage.points_world + self.shifts(look)[: len(self.shown.points_world)]
        return moved

    def normal(self, normal_world: FloatArray, true: Pose, shown: Pose) -> FloatArray:
        """Return how a vector that turns with the object is shown, (3,)."""
        turned: FloatArray = shown.rotation @ (true.rotation.T @ normal_world)
        return turned

    def _moved(self, one: int, other: int) -> tuple[float, float]:
        """Return by how much the object turns, radians, and how far its centre goes, metres, between two shots."""
        start, end = (self.shown.shots[shot].pose_world_object for shot in (one, other))
        way_m = math.dist(end.transform(self.center_object_m), start.transform(self.center_object_m))
        return math.hypot(*_turn_vector(start, end)), way_m

    def _fits(self, moved: tuple[float, float], exaggeration: int) -> bool:
        return exaggeration * moved[0] <= MOST_TURN_RAD and exaggeration * moved[1] <= MOST_WAY * self.size_m

    def _meet(self, shot: int, look: Look) -> bool:
        """Whether what touches at a shot touches on screen."""
        touches, true = self.shown.shots[shot].touches, self.shown.shots[shot].pose_world_object
        on_object = self.pose(true, look).transform(true.inverse_transform(touches.places_world))
        parted = on_object - touches.places_world - self.touch_shifts(touches, look)
        return bool((np.linalg.norm(parted, axis=1) <= MOST_PARTED * self.size_m).all())

    def _is_long(self, one: int, other: int) -> bool:
        """Whether a motion is shown as it is, from one shot to another, as one is on which bodies are driven."""
        if self.cage(one) is not self.cage(other):
            return True
        moved = self._moved(one, other)
        if self._stands(moved):
            return False
        return not (self._fits(moved, 2) and self._meet(other, Look(one, LONG_AT, self.cage(other))))

    def _stands(self, moved: tuple[float, float]) -> bool:
        return moved[0] < MOTION_AT_REST and moved[1] < MOTION_AT_REST * self.size_m

    def _proposed(self, reference: int, start: int, last: int) -> int:
        ends = [row.last_shot for row in self.shown.rows if start < row.last_shot <= last]
        moves = [self._moved(reference, shot) for shot in ends]
        if all(map(self._stands, moves)):
            return 1
        for k in reversed(EXAGGERATIONS):
            if all(self._fits(move, k) for move in moves) and all(
                self._meet(shot, Look(reference, k, self.cage(shot))) for shot in ends
            ):
                return k
        return 1


def _extent(points: Sequence[FloatArray]) -> float:
    """Return the diagonal of the box around all of some points, (n, 3) each."""
    return float(np.linalg.norm(np.ptp(np.concatenate(points), axis=0)))


def _distinct(cages: Sequence[CageAt]) -> list[CageAt]:
    """Return cages without those whose bodies are where they are in another."""
    return list({id(cage): cage for cage in cages}.values())


def _everywhere(cages: Sequence[CageAt], which: int) -> FloatArray:
    """Return the vertices of a shape of the cage wherever it is in some of them, (n, 3), metres."""
    cage = cages[0].cage
    body, vertices = cage.element_bodies[len(cage.names) + which], vertices_of([cage.shapes[which]])
    return np.concatenate([at.pose_of_cage(which).transform(vertices) for at in (cages if body else cages[:1])])


def _play(hole: Hole, pose_world_hole: Pose, others_world: FloatArray) -> float:
    """Return how much wider a hole is than what stands in it, wherever in it, of vertices of the other body, (n, 3)."""
    across = pose_world_hole.inverse_transform(others_world)[:, :2]
    # What stands in a hole may come out of it at both ends, where a mesh has its vertices.
    beside = across[np.hypot(*across.T) < 1.2 * hole.radius_m]
    if not len(beside):
        return 0.0
    middle = (beside.min(axis=0) + beside.max(axis=0)) / 2.0
    return max(0.0, hole.radius_m - float(np.hypot(*(beside - middle).T).max()))


def _turn_vector(start: Pose, end: Pose) -> FloatArray:
    """Return axis times angle, (3,), of the turn in the world from one orientation to another, at most half a turn."""
    before, after = start.as_tuples()[1], end.as_tuples()[1]
    is_near = sum(map(operator.mul, before, after)) >= 0.0
    return np.array(rotation_vector(before, after if is_near else (-after[0], -after[1], -after[2], -after[3])))


def _from_turn_vector(vector: FloatArray) -> Pose:
    angle = math.hypot(*vector)
    if angle == 0.0:
        return Pose()
    x, y, z = (vector / angle).tolist()
    return Pose(quaternion_wxyz=quaternion_about((x, y, z), angle))
