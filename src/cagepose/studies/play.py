"""Play: how far the object can move inside its cage, what limits it, and whether it can get out."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from time import perf_counter

import numpy as np
from numpy.typing import ArrayLike

from cagepose.errors import Problem, SceneError
from cagepose.kernels.algebra.record import Rows, empty_rows
from cagepose.kernels.play.certificate import CAGED, CertificateRoom, certify, empty_certificate_room
from cagepose.kernels.play.goal import PITCH, ROLL, SHIFT, YAW, Goal
from cagepose.kernels.play.rows import empty_play_room
from cagepose.kernels.play.search import OPEN, REACHED, Extreme, find_play
from cagepose.model.checks import FloatArray, finite_array, unit_vector
from cagepose.model.pose import Pose
from cagepose.model.scene import FARTHEST_START, Scene, millimetres
from cagepose.studies.cage_verdict import CageVerdict, judge_cage
from cagepose.studies.play_frame import FREEDOMS, PlayFrame
from cagepose.studies.play_limits import Clearance, limiting_clearances

_ANGLES = {"roll": ROLL, "pitch": PITCH, "yaw": YAW}
SEARCH_S = 2.0
"""Seconds that the search for a way out may take, if the object is not proven to be caged."""


@dataclass(frozen=True, eq=False)
class PlayEnd:
    """One end of a range; angles in radians, lengths in metres.

    Attributes
    ----------
    linear
        Over the polytope (7.1); None: without end, or not found.
    exact
        Locally optimal (7.5); None: without end, or not found.
    certified
        No motion inside the cage passes this (7.7); None: not proven.
    is_open
        Whether the exact end is known to lie nowhere.
    pose_world_object
        Reaches the exact end; None: there is none.
    """

    linear: float | None
    exact: float | None
    certified: float | None
    is_open: bool
    pose_world_object: Pose | None
    _find_clearances: Callable[[], tuple[Clearance, ...]] = field(repr=False)

    @cached_property
    def clearances(self) -> tuple[Clearance, ...]:
        """The gaps that limit the exact end, the one first that is best to close; found when first asked for."""
        return self._find_clearances()


@dataclass(frozen=True, eq=False)
class PlayRange:
    """The least and the greatest value of a freedom."""

    low: PlayEnd
    high: PlayEnd


@dataclass(frozen=True, eq=False)
class PointPlay:
    """How far a point of the object can go: ``at_object`` (3,) metres, along the unit vector ``direction_cage``."""

    at_object: FloatArray
    direction_cage: FloatArray
    low: PlayEnd
    high: PlayEnd


@dataclass(frozen=True, eq=False)
class Play:
    """All ranges, measured from the start pose in the cage's axes.

    Attributes
    ----------
    scene
        What was asked.
    freedoms
        "x", "y", "z": displacement of the object's origin; "roll", "pitch", "yaw": ZYX angles.
    points
        In the order asked.
    cage
        Whether it can get out.
    analysis_s, certificate_s
        How long both took, seconds, without the search for a way out.
    """

    scene: Scene
    freedoms: dict[str, PlayRange]
    points: tuple[PointPlay, ...]
    cage: CageVerdict
    analysis_s: float
    certificate_s: float


def play(
    scene: Scene,
    at: Sequence[ArrayLike] = (),
    directions: Sequence[ArrayLike] = (),
    *,
    search_s: float = SEARCH_S,
    progress: Callable[[float], None] | None = None,
) -> Play:
    """Say how far the object can move, and whether it is caged.

    Parameters
    ----------
    scene
        Loads and friction do not matter.
    at
        Points of the object, in its frame, metres.
    directions
        In the cage's frame; none: x, y and z. Each goes with each point.
    search_s
        Seconds for the search for a way out, if need be.
    progress
        Called with the share of that time that has passed.

    Raises
    ------
    SceneError
        A point or direction that is not three finite numbers, a direction of length zero, or a point far away.
    """
    points = [_point_near(scene, point) for point in at]
    along = [unit_vector(direction, "direction") for direction in (directions if len(directions) else np.eye(3))]
    frame = PlayFrame(scene)
    pairs = [(point, direction) for point in points for direction in along]
    goals = _goals(frame, pairs)
    extremes = empty_rows(Extreme, len(goals))
    room = empty_play_room(frame.geometry)
    work = empty_certificate_room(len(room.faces))
    bounds = np.full(len(goals), np.inf)
    touch_m = scene.tolerances.touch * scene.size_m
    started = perf_counter()
    find_play(frame.geometry, frame.length_m, goals, extremes, room)
    analysed = perf_counter()
    certify(frame.geometry, frame.length_m, touch_m, goals, bounds, room, work)
    certified = perf_counter()
    writer = _Writer(scene, frame, goals, extremes, bounds, work)
    freedoms = {name: PlayRange(*writer.ends(place)) for place, name in enumerate(FREEDOMS)}
    return Play(
        scene,
        freedoms,
        tuple(PointPlay(*pair, *writer.ends(len(FREEDOMS) + place)) for place, pair in enumerate(pairs)),
        judge_cage(scene, frame, work, _free_names(extremes), search_s, progress),
        analysed - started,
        certified - analysed,
    )


def _point_near(scene: Scene, value: ArrayLike) -> FloatArray:
    point = finite_array(value, (3,), "at")
    farthest = float(np.abs(point).max())
    if farthest > FARTHEST_START * scene.size_m:
        found = f"is {millimetres(farthest)} from the object's origin, over {FARTHEST_START:g} times the scene's size"
        raise SceneError([Problem(("at",), f"{found}; ask about a point of the object")])
    return point


def _goals(frame: PlayFrame, pairs: Sequence[tuple[FloatArray, FloatArray]]) -> Rows[Goal]:
    """Two goals for each range: least, greatest."""
    origin = frame.pose_frame_object.position_m
    shifts = [(origin, axis) for axis in np.eye(3)]
    shifts += [(frame.pose_frame_object.transform(point), direction) for point, direction in pairs]
    goals = empty_rows(Goal, 2 * (len(shifts) + len(_ANGLES)))
    for place in range(len(goals)):
        goal = goals[place]
        goal.sign = 1.0 if place % 2 else -1.0
        index = place // 2
        if 3 <= index < len(FREEDOMS):
            goal.kind = _ANGLES[FREEDOMS[index]]
            continue
        goal.kind = SHIFT
        goal.starts[0], goal.directions[0] = shifts[index if index < 3 else index - 3]
    return goals


def _free_names(extremes: Rows[Extreme]) -> tuple[str, ...]:
    """``x``: free both ways; ``+x``: free one way; as linearised."""
    names = []
    for place, name in enumerate(FREEDOMS):
        low, high = (extremes[2 * place + side].linear_outcome == OPEN for side in range(2))
        if low or high:
            names.append(name if low and high else f"{'-' if low else '+'}{name}")
    return tuple(names)


class _Writer:
    def __init__(
        self,
        scene: Scene,
        frame: PlayFrame,
        goals: Rows[Goal],
        extremes: Rows[Extreme],
        bounds: FloatArray,
        work: CertificateRoom,
    ) -> None:
        self.scene = scene
        self.frame = frame
        self.goals = goals
        self.extremes = extremes
        self.bounds = bounds
        self.work = work

    def ends(self, place: int) -> tuple[PlayEnd, PlayEnd]:
        return self._end(2 * place), self._end(2 * place + 1)

    def _end(self, index: int) -> PlayEnd:
        extreme = self.extremes[index]
        is_reached = extreme.outcome == REACHED
        has_bound = self.work.certificate.outcome == CAGED and math.isfinite(self.bounds[index])
        motion = Pose(extreme.position, extreme.quaternion) if is_reached else None
        return PlayEnd(
            linear=float(extreme.linear) if extreme.linear_outcome == REACHED else None,
            exact=float(extreme.value) if is_reached else None,
            certified=float(self.goals[index].sign * self.bounds[index]) if has_bound else None,
            is_open=bool(extreme.outcome == OPEN),
            pose_world_object=None if motion is None else self.frame.outward(*motion.as_tuples()),
            _find_clearances=partial(self._clearances, index, motion),
        )

    def _clearances(self, index: int, motion: Pose | None) -> tuple[Clearance, ...]:
        return () if motion is None else limiting_clearances(self.scene, self.frame, self.goals[index], motion)
