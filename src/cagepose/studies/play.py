"""Play: how far the object can move inside its cage, what limits it, and whether it can get out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from time import perf_counter
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from cagepose.errors import Problem, SceneError
from cagepose.kernels.algebra.record import Rows, empty_rows
from cagepose.kernels.native.slots import Slots
from cagepose.kernels.play.certificate import CAGED, certify, empty_certificate_workspace
from cagepose.kernels.play.extreme import OPEN, REACHED, Extreme
from cagepose.kernels.play.goal import SHIFT, Goal
from cagepose.kernels.play.polytope import empty_play_workspace
from cagepose.kernels.play.search import find_play, find_play_from
from cagepose.model.checks import FloatArray, expect, finite_array, unit_vector
from cagepose.model.pose import Pose
from cagepose.model.scene import FARTHEST_START, Scene, millimetres
from cagepose.model.scope import check_boxes_and_points
from cagepose.model.wording import coordinates, few
from cagepose.studies.cage_verdict import CageVerdict, judge_cage
from cagepose.studies.play_frame import FREEDOMS, PlayFrame, range_goals
from cagepose.studies.play_limits import Clearance, limiting_clearances

EndStatus = Literal["proven", "local", "not converged", "open"]
MOST_STARTS = 2000
"""Poses of the search for a way out that ends are looked for from: a millisecond, and as many on any machine."""
MOST_ROUNDS = 5
"""Of searches from the ends of others. One round that finds nothing is usual."""
PROVEN_WITHIN = 0.01
"""Of an end: one that no motion can pass by more is proven. Certified bounds include more than the end itself."""
SEARCH_S = 2.0
"""Seconds that the search for a way out may take, if the object is not proven to be caged."""


@dataclass(frozen=True, eq=False)
class PlayEnd:
    """One end of a range; angles in radians, lengths in metres.

    Attributes
    ----------
    linear
        Over the polytope (7.1); None: without end, or not found.
    reached
        The farthest that the searches came (7.5), beyond all points; None: without end.
    certified
        No motion inside the cage passes this (7.7); None: not proven.
    status
        "local": no motion nearby goes farther, to first order (7.14); "proven": besides, `certified` says that none
        inside the cage goes farther by more than a hundredth; "not converged": neither is known, and the end may lie
        beyond `reached`; "open": there is no end.
    """

    linear: float | None
    reached: float | None
    certified: float | None
    status: EndStatus
    _find_pose: Callable[[], Pose | None] = field(repr=False)
    _find_clearances: Callable[[], tuple[Clearance, ...]] = field(repr=False)

    def __repr__(self) -> str:
        return f"<PlayEnd: {_end(self)} ({self.status})>"

    @property
    def exact(self) -> float | None:
        """The end, local or proven; None: without end, or not converged."""
        return self.reached if self.status in ("local", "proven") else None

    @property
    def is_open(self) -> bool:
        """Whether the end is known to lie nowhere."""
        return self.status == "open"

    @cached_property
    def pose_world_object(self) -> Pose | None:
        """Has the value ``reached``; None: there is no end."""
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

    def __repr__(self) -> str:
        return f"<PlayRange: {_end(self.low)} to {_end(self.high)}>"


@dataclass(frozen=True, eq=False)
class PointPlay:
    """How far a point of the object can go: ``at_object`` (3,) metres, along the unit vector ``direction_cage``."""

    at_object: FloatArray
    direction_cage: FloatArray
    low: PlayEnd
    high: PlayEnd

    def __repr__(self) -> str:
        line = f"{coordinates(self.at_object)} m along {coordinates(self.direction_cage, 4)}"
        return f"<PointPlay of {line}: {_end(self.low)} to {_end(self.high)}>"


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

    def __repr__(self) -> str:
        return f"<Play of {self.scene.name!r}: {self.cage.verdict}; {few(self.freedoms, 6)}, {len(self.points)} points>"


def _end(end: PlayEnd) -> str:
    return "no end" if end.reached is None else f"{end.reached:.6g}"


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
        The scene has other shapes than boxes and points; or a point or direction is not three finite numbers, a
        direction of length zero, or a point far away.
    """
    expect(scene, Scene, "scene")
    check_boxes_and_points(scene, "play")
    points = [_point_near(scene, point) for point in at]
    along = [unit_vector(direction, "direction") for direction in (directions if len(directions) else np.eye(3))]
    shifts = [(point, direction) for point in points for direction in along]
    frame = PlayFrame(scene)
    found = _Found(scene, frame, range_goals(frame, shifts))
    cage, stations = judge_cage(scene, frame, found.proof, found.free_directions(), search_s, progress)
    found.search_from(stations[:MOST_STARTS])
    ranges = found.ranges()
    return Play(
        scene,
        {name: PlayRange(*ranges[index]) for index, name in enumerate(FREEDOMS)},
        tuple(PointPlay(*shift, *ends) for shift, ends in zip(shifts, ranges[len(FREEDOMS) :], strict=True)),
        cage,
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
        geometry, workspace = self._given = Slots(frame.geometry), Slots(work)
        touch = scene.tolerances.touch * scene.size_m / frame.length_m
        started = perf_counter()
        find_play(geometry, goals, self.extremes, workspace)
        analysed = perf_counter()
        certify(geometry, touch, goals, self.bounds, workspace, self.proof)
        self.analysis_s = analysed - started
        self.certificate_s = perf_counter() - analysed
        self.is_caged = bool(self.proof.certificate.outcome == CAGED)

    def search_from(self, stations: np.ndarray) -> None:
        """Search for ends again, from the farthest of all other ends and of these poses.

        Where a freedom has no end the object leaves its cage, and out there nothing has one: no search starts there.
        """
        geometry, workspace = self._given
        ends = np.asarray(self.extremes)
        started = perf_counter()
        for _ in range(MOST_ROUNDS):
            nearby = ends[: 2 * len(FREEDOMS)]  # not those of points: answers hang on no other question
            starts, before = [nearby[nearby["outcome"] != OPEN], stations], ends["value"].copy()
            positions, quaternions = (np.concatenate([rows[k] for rows in starts]) for k in ("position", "quaternion"))
            find_play_from(geometry, self.goals, self.extremes, positions, quaternions, workspace)
            if (ends["value"] == before).all():
                break
        self.analysis_s += perf_counter() - started

    def ranges(self) -> list[tuple[PlayEnd, PlayEnd]]:
        goals, found = np.asarray(self.goals), np.asarray(self.extremes)
        units = np.where(goals["kind"] == SHIFT, self.frame.length_m, 1.0)
        linear = _known(units * found["linear"], found["linear_outcome"] == REACHED)
        reached = _known(units * found["value"], found["outcome"] != OPEN)
        certified = _known(units * goals["sign"] * self.bounds, self.is_caged & np.isfinite(self.bounds))
        ends = [
            PlayEnd(*values, self._status(index), partial(self._pose, index), partial(self._clearances, index))
            for index, values in enumerate(zip(linear, reached, certified, strict=True))
        ]
        return list(zip(ends[::2], ends[1::2], strict=True))

    def _status(self, index: int) -> EndStatus:
        extreme = self.extremes[index]
        if extreme.outcome != REACHED:
            return "open" if extreme.outcome == OPEN else "not converged"
        is_proven = self.is_caged and self.bounds[index] <= (1.0 + PROVEN_WITHIN) * abs(extreme.value)
        return "proven" if is_proven else "local"

    def _pose(self, index: int) -> Pose | None:
        extreme = self.extremes[index]
        return None if extreme.outcome == OPEN else self.frame.pose_after(extreme.position, extreme.quaternion)

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
