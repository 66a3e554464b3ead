"""Play: how far the object can move inside its cage, what limits it, and whether it can get out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from time import perf_counter

import numpy as np
from numpy.typing import ArrayLike

from cagepose.errors import Problem, SceneError
from cagepose.kernels.algebra.record import Rows, empty_rows
from cagepose.kernels.native.slots import Slots
from cagepose.kernels.play.certificate import CAGED, certify, empty_certificate_workspace
from cagepose.kernels.play.extreme import OPEN, REACHED, Extreme
from cagepose.kernels.play.goal import SHIFT, Goal
from cagepose.kernels.play.polytope import empty_play_workspace
from cagepose.kernels.play.search import find_play
from cagepose.model.checks import FloatArray, finite_array, unit_vector
from cagepose.model.pose import Pose
from cagepose.model.scene import FARTHEST_START, Scene, millimetres
from cagepose.studies.cage_verdict import CageVerdict, judge_cage
from cagepose.studies.play_frame import FREEDOMS, PlayFrame, range_goals
from cagepose.studies.play_limits import Clearance, limiting_clearances

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
    """

    linear: float | None
    exact: float | None
    certified: float | None
    is_open: bool
    _find_pose: Callable[[], Pose | None] = field(repr=False)
    _find_clearances: Callable[[], tuple[Clearance, ...]] = field(repr=False)

    @cached_property
    def pose_world_object(self) -> Pose | None:
        """Reaches the exact end; None: there is none."""
        return self._find_pose()

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
    shifts = [(point, direction) for point in points for direction in along]
    frame = PlayFrame(scene)
    found = _Found(scene, frame, range_goals(frame, shifts))
    ranges = found.ranges()
    return Play(
        scene,
        {name: PlayRange(*ranges[index]) for index, name in enumerate(FREEDOMS)},
        tuple(PointPlay(*shift, *ends) for shift, ends in zip(shifts, ranges[len(FREEDOMS) :], strict=True)),
        judge_cage(scene, frame, found.proof, found.free_directions(), search_s, progress),
        found.analysis_s,
        found.certificate_s,
    )


def _point_near(scene: Scene, value: ArrayLike) -> FloatArray:
    point = finite_array(value, (3,), "at")
    farthest = float(np.abs(point).max())
    if farthest > FARTHEST_START * scene.size_m:
        found = f"is {millimetres(farthest)} from the object's origin, over {FARTHEST_START:g} times the scene's size"
        raise SceneError([Problem(("at",), f"{found}; ask about a point of the object")])
    return point


class _Found:
    """What the kernels find for a scene's goals, two for each range: least, greatest."""

    def __init__(self, scene: Scene, frame: PlayFrame, goals: Rows[Goal]) -> None:
        self.scene = scene
        self.frame = frame
        self.goals = goals
        self.extremes = empty_rows(Extreme, len(goals))
        self.bounds = np.full(len(goals), np.inf)
        work = empty_play_workspace(frame.geometry)
        self.proof = empty_certificate_workspace(len(work.faces))
        geometry, workspace = Slots(frame.geometry), Slots(work)
        touch = scene.tolerances.touch * scene.size_m / frame.length_m
        started = perf_counter()
        find_play(geometry, goals, self.extremes, workspace)
        analysed = perf_counter()
        certify(geometry, touch, goals, self.bounds, workspace, self.proof)
        self.analysis_s = analysed - started
        self.certificate_s = perf_counter() - analysed
        self.is_caged = bool(self.proof.certificate.outcome == CAGED)

    def ranges(self) -> list[tuple[PlayEnd, PlayEnd]]:
        goals, found = np.asarray(self.goals), np.asarray(self.extremes)
        units = np.where(goals["kind"] == SHIFT, self.frame.length_m, 1.0)
        linear = _known(units * found["linear"], found["linear_outcome"] == REACHED)
        exact = _known(units * found["value"], found["outcome"] == REACHED)
        certified = _known(units * goals["sign"] * self.bounds, self.is_caged & np.isfinite(self.bounds))
        is_open = (found["outcome"] == OPEN).tolist()
        ends = [
            PlayEnd(*values, partial(self._pose, index), partial(self._clearances, index))
            for index, values in enumerate(zip(linear, exact, certified, is_open, strict=True))
        ]
        return list(zip(ends[::2], ends[1::2], strict=True))

    def _pose(self, index: int) -> Pose | None:
        extreme = self.extremes[index]
        return self.frame.pose_after(extreme.position, extreme.quaternion) if extreme.outcome == REACHED else None

    def _clearances(self, index: int) -> tuple[Clearance, ...]:
        goal, extreme = self.goals[index], self.extremes[index]
        return limiting_clearances(self.scene, self.frame, goal, extreme) if extreme.outcome == REACHED else ()

    def free_directions(self) -> tuple[str, ...]:
        """``x``: free both ways; ``+x``: free one way; as linearised."""
        names = []
        for place, name in enumerate(FREEDOMS):
            low, high = (self.extremes[2 * place + side].linear_outcome == OPEN for side in range(2))
            if low or high:
                names.append(name if low and high else f"{'-' if low else '+'}{name}")
        return tuple(names)


def _known(values: FloatArray, is_known: np.ndarray) -> list[float | None]:
    return [value if known else None for value, known in zip(values.tolist(), is_known.tolist(), strict=True)]
