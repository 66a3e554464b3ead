"""How much work it takes to get a part out of its cage against its load: `escape_energy`."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from cagepose.kernels.algebra.pose import moved_pose
from cagepose.kernels.algebra.vector import vector_from
from cagepose.kernels.play.escape import LENGTH_OF_WAY_OUT
from cagepose.model.checks import expect, expect_count
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.questions.ends import moved_before, phase_asked
from cagepose.questions.plane_escape import ENDLESS, N_POSES, least_work_in_plane
from cagepose.questions.unanswered import Unanswered
from cagepose.questions.work import Work, work_of
from cagepose.runs.load_scaling import scaled_load
from cagepose.runs.run import AT_REST, Run
from cagepose.studies.cage_verdict import PathStep, step_to
from cagepose.studies.free_motions import FreeMotions
from cagepose.studies.plane_frame import has_endless_holes
from cagepose.studies.play import play
from cagepose.studies.play_frame import PlayFrame

N_MOTIONS = 20_000
MOST_STATIONS = 20_000
MOTIONS_OF_BATCH = 100
LEVEL = 1e-9
"""Of the load. A way out against which no more of it acts goes level."""
LOWER = 1e-3
"""Of the work. A way out must be better by this much."""


@dataclass(frozen=True, eq=False)
class EscapeEnergy:
    """The least work that a way out takes.

    Attributes
    ----------
    phase
        At whose end the part is, and whose load acts.
    at_least_j
        No way out takes less, joules; metres times the load where that has no newtons. Infinite: it is proven that
        there is no way out. Zero: no more is known, as in all scenes that move in space.
    at_most_j
        The path takes this much. Infinite: none was found.
    in_newtons
        Whether the load is in newtons.
    path
        The way out that was found, free of contact; empty: none. In a plane, its first motion opens all contacts at
        once.
    top
        The object's pose in the world where the load has least work done, on that path; None: there is none.
    n_ways
        So many ways out were found, each better than the one before.
    n_tried
        Motions that the search tried; in a plane, poses at which it asked whether the object is free.
    in_plane
        Whether the scene moves in a plane.
    """

    phase: str
    at_least_j: float
    at_most_j: float
    in_newtons: bool
    path: tuple[PathStep, ...]
    top: Pose | None
    n_ways: int
    n_tried: int
    in_plane: bool = False

    def __repr__(self) -> str:
        return f"<EscapeEnergy: {self.at_least_j:.6g} to {self.at_most_j:.6g} J>"


def escape_energy(
    run: Run,
    phase: str | None = None,
    *,
    n_motions: int | None = None,
    progress: Callable[[float], None] | None = None,
) -> EscapeEnergy | Unanswered:
    """Return how much work it takes to get the object out from where a phase left it, against the phase's load.

    A tree of motions free of contact is grown from there; as soon as it leads out, everything as high as that way is
    cut off, and the search goes on below. So the answer is at most what the best way takes, and a longer search finds
    better ones. Friction does not count. That there is no way out at all is a proof (`cagepose.play`).

    In a plane (`Scene.planar`) all ways are asked about at once, of parts and cages of any shape, so that the answer
    has a lower bound, too.

    Parameters
    ----------
    phase
        Its name; None: the last.
    n_motions
        How many the search tries, unless it finds a way that takes no work; the same ones each time. In a plane, at how
        many poses it asks. None: 20,000 and 60,000.
    progress
        Called with the share of them that were tried.

    Raises
    ------
    SceneError
        The run has no such phase, or no count of motions.
    """
    expect(run, Run, "run")
    if n_motions is not None:
        expect_count(n_motions, "n_motions")
    number = phase_asked(run, phase)
    ended, scene, load = run.phases[number], run.scene, run.scene.loads[number]
    if ended.verdict not in AT_REST:
        return Unanswered(f"nothing is at rest at the end of {ended.name}: it ends as {ended.verdict!r}")
    work = work_of(scene, load, ended.pose)
    if work is None:
        return Unanswered(f"{load.name} is more than weight and forces that keep their direction, so it has no energy")
    if moved := moved_before(scene, number):
        return moved
    weighed = scaled_load(scene, load)
    if play(scene, search_s=0.0).verdict == "caged":
        return EscapeEnergy(load.name, math.inf, math.inf, weighed.in_newtons, (), None, 0, 0)
    rested = scene.object.starting_at(ended.pose)
    if scene.planar is not None:
        if has_endless_holes(scene):
            return Unanswered(ENDLESS)
        n_poses = N_POSES if n_motions is None else n_motions
        found = least_work_in_plane(scene.but_for(object=rested), work.forces, work.points, n_poses, progress)
        return EscapeEnergy(
            load.name,
            found.at_least_j,
            found.at_most_j,
            weighed.in_newtons,
            found.path,
            found.top,
            found.n_ways,
            found.n_asked,
            in_plane=True,
        )
    if scene.has_other_shapes:
        return Unanswered(
            "a way out is searched for boxes among points alone, and no proof was found that there is none"
        )
    search = _Search(scene.but_for(object=rested), work)
    search.go_on(N_MOTIONS if n_motions is None else n_motions, progress)
    return EscapeEnergy(
        load.name, 0.0, search.least_j, weighed.in_newtons, search.path, search.top, search.n_ways, search.n_tried
    )


class _Search:
    """A tree of motions free of contact that stays below the best way out so far.

    Attributes
    ----------
    least_j
        What the best way takes; infinite: none was found.
    path, top
        It, and the pose on it where the potential is greatest.
    n_ways, n_tried
        Ways out, and motions that were tried.
    """

    def __init__(self, scene: Scene, work: Work) -> None:
        self._frame, self._work = PlayFrame(scene), work
        self._tree = FreeMotions(scene, self._frame, MOST_STATIONS, MOTIONS_OF_BATCH)
        self._stations = self._tree.stations
        start = scene.object.pose_world_object
        self._poses, self._tops = [start], [start]
        self._peaks = [work.potential(start)]
        self._level = work.size_n * LEVEL
        self._force = work.forces.sum(axis=0)
        self.least_j, self.path = math.inf, tuple[PathStep, ...]()
        self.top: Pose | None = None
        self.n_ways = 0

    @property
    def n_tried(self) -> int:
        return self._tree.n_tried

    def go_on(self, n_motions: int, progress: Callable[[float], None] | None) -> None:
        while self.n_tried < n_motions and self.least_j > self._level * self._frame.length_m:
            if progress is not None:
                progress(self.n_tried / n_motions)
            if not self._tree.has_room:
                self._keep([0])
            self._grow()

    def _grow(self) -> None:
        """Try some motions, and keep those that stay below the best way out."""
        before = len(self._peaks)
        self._tree.grow()
        for index in range(before, self._tree.n_stations):
            self._judge(index, self._tree.is_out and index == self._tree.n_stations - 1)
        kept = [index for index, peak in enumerate(self._peaks) if self._is_low(peak)]
        if len(kept) < len(self._peaks):
            self._keep(kept)

    def _judge(self, index: int, is_way: bool) -> None:
        """Add a station that the tree has grown, with the greatest potential on the way to it."""
        step, parent = step_to(self._frame, self._stations[index]), int(self._stations[index].parent)
        before = self._poses[parent]
        if is_way and step.motion.direction_world is not None:
            if float(self._force @ step.motion.direction_world) >= -self._level:
                if self._is_low(self._peaks[parent]):
                    self._found(parent, step)
                self._add(step.pose_world_object, math.inf, step.pose_world_object)
                return
            step = self._shortened(index, step, before)  # a way up: out of the cage only from farther along it
        highest, share = self._work.highest(before, step.motion)
        if highest > self._peaks[parent]:
            self._add(step.pose_world_object, highest, step.motion.pose_at(before, share))
        else:
            self._add(step.pose_world_object, self._peaks[parent], self._tops[parent])

    def _shortened(self, index: int, step: PathStep, before: Pose) -> PathStep:
        """End a travel up without end at a random place that is lower than the best way out."""
        assert step.motion.direction_world is not None
        station, share = self._stations[index], self._tree.share()
        height_m = step.motion.distance_m
        if math.isfinite(self.least_j):
            left_j = self.least_j - (self._work.potential(before) - self._peaks[0])
            height_m = min(height_m, -left_j / float(self._force @ step.motion.direction_world))
        share *= height_m / step.motion.distance_m
        station.distance = share * LENGTH_OF_WAY_OUT
        parent = self._stations[int(station.parent)]
        q = parent.quaternion
        position, _ = moved_pose(
            vector_from(parent.position),
            (q[0], q[1], q[2], q[3]),
            vector_from(station.along),
            (0.0, 0.0, 0.0),
            station.distance,
            0.0,
        )
        for k in range(3):
            station.position[k] = position[k]
        motion = replace(step.motion, distance_m=share * step.motion.distance_m)
        return PathStep(motion, motion.pose_at(before, 1.0))

    def _add(self, pose: Pose, peak: float, top: Pose) -> None:
        self._poses.append(pose)
        self._peaks.append(peak)
        self._tops.append(top)

    def _is_low(self, peak: float) -> bool:
        rise = peak - self._peaks[0]
        return rise < (1.0 - LOWER) * self.least_j or rise == 0.0

    def _found(self, parent: int, last: PathStep) -> None:
        self.least_j, self.top = self._peaks[parent] - self._peaks[0], self._tops[parent]
        steps = [last]
        while parent > 0:
            steps.append(step_to(self._frame, self._stations[parent]))
            parent = int(self._stations[parent].parent)
        self.path = tuple(reversed(steps))
        self.n_ways += 1

    def _keep(self, kept: list[int]) -> None:
        """Leave out all other stations; those that stand on one of them go, too."""
        number, stations = {-1: -1}, np.asarray(self._stations)
        for index in kept:
            if int(stations["parent"][index]) in number:
                number[index] = len(number) - 1
        whole = [index for index in number if index >= 0]
        stations[: len(whole)] = stations[whole]
        stations["parent"][: len(whole)] = [number[int(parent)] for parent in stations["parent"][: len(whole)]]
        self._poses = [self._poses[index] for index in whole]
        self._peaks = [self._peaks[index] for index in whole]
        self._tops = [self._tops[index] for index in whole]
        self._tree.n_stations = len(whole)
