"""Where a part comes to rest in its cage when it is let go from many poses: `cage_rests`."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.model.checks import FloatArray, expect, expect_choice, expect_count
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.questions.ends import moved_before
from cagepose.questions.unanswered import Unanswered
from cagepose.questions.work import work_of
from cagepose.runs.cases import greatest_friction
from cagepose.runs.many import run_many
from cagepose.runs.methods import chosen_method
from cagepose.runs.run import AT_REST
from cagepose.runs.solve import run
from cagepose.runs.variation import Variation
from cagepose.studies.likelihood import wilson
from cagepose.studies.play import play
from cagepose.studies.play_frame import FREEDOMS, N_LENGTHS

N_STARTS = 200
MOST_PROPOSED = 100
"""Poses that are drawn for each start, at most: the part would be in the cage in others."""
SEED = 20250101
OPEN_WAY, OPEN_ANGLE = 0.25, math.pi / 4.0
"""How far starts are from the scene's own where the cage sets no limit: of the scene's size, and radians."""
SAME_POSE = 1e-3
"""Ends that are this near are one: of the scene's size, and radians."""
SAME_HEIGHT = 1e-6
"""Of the load times the scene's size. Ends that roll into each other differ in the load's work by no more."""
BEARS = 1e-6
"""Of the greatest contact force. A contact with less does not bear the load."""
PLANE_FREEDOMS = {"x", "y", "z", "yaw"}


@dataclass(frozen=True, eq=False)
class CageRest:
    """Where some of the starts ended: at one pose, or with friction, which holds the object at many, at some contacts.

    Attributes
    ----------
    verdict
        "rests", "may rest", or how a run ends that does not come to rest: "escapes", "stalled", ...
    stability
        "stable", "marginal", "unstable" or "not shown", as in `cagepose.Proof`; None: not at rest.
    pose
        The object's in the world at one of the ends.
    touching
        Names of the cage's points and shapes that touch at that end.
    undetermined
        Freedoms of the cage's frame along which the load does not tell poses apart: ends that differ in them are one.
        Where it rolls, so are ends with the load on the same parts and the centre of gravity at the same place.
    n
        How many starts ended here.
    low, high
        Between which the likelihood lies, with 95 % confidence (Wilson 1927).
    """

    verdict: str
    stability: str | None
    pose: Pose
    touching: tuple[str, ...]
    undetermined: tuple[str, ...]
    n: int
    low: float
    high: float

    def __repr__(self) -> str:
        return f"<CageRest: {self.verdict}, {self.n} starts>"


@dataclass(frozen=True, eq=False)
class CageRests:
    """What was found from starts that are drawn: there may be rests that none of them led to.

    Attributes
    ----------
    phase
        Whose load acts, alone.
    rests
        Those with most starts first.
    start_position_m, start_quaternion_wxyz
        The object's poses in the world from which it was let go, (n, 3) and (n, 4).
    ends_in
        Which of the rests each start led to, from 0.
    n_proposed
        Poses that were drawn, among them those at which it would be in the cage.
    has_friction
        Whether there is any.
    not_limited
        Freedoms in which the play has no end, so that starts lie about the scene's own; if all turns are among them,
        they are turned in any way.
    """

    phase: str
    rests: tuple[CageRest, ...]
    start_position_m: FloatArray
    start_quaternion_wxyz: FloatArray
    ends_in: tuple[int, ...]
    n_proposed: int
    has_friction: bool
    not_limited: tuple[str, ...]

    def __repr__(self) -> str:
        return f"<{len(self.rests)} CageRests of {len(self.ends_in)} starts>"


def cage_rests(
    scene: Scene,
    phase: str | None = None,
    *,
    n_starts: int = N_STARTS,
    progress: Callable[[float], None] | None = None,
) -> CageRests | Unanswered:
    """Let the object go from many poses in its cage under the load of one phase, and gather where it ends.

    Starts are drawn about the scene's own start pose, over the ranges of its play in each freedom, denser about the
    middle, or turned in any way, each as likely, if no turn has a limit; poses at which the object would be in the cage
    are left out. The same starts are drawn each time.

    Parameters
    ----------
    phase
        Its name; None: the first.
    n_starts
        How many.
    progress
        Called with the share of the starts that were followed.

    Raises
    ------
    SceneError
        There is no such phase, or no count of starts.
    """
    expect(scene, Scene, "scene")
    expect_count(n_starts, "n_starts")
    names = [load.name for load in scene.loads]
    if phase is not None:
        expect_choice(phase, names, "phase")
    number = 0 if phase is None else names.index(phase)
    load = scene.loads[number]
    if load.drive or load.press:
        return Unanswered(f"{load.name} drives or presses, so that the cage is not the same at the end")
    if scene.planar is not None:
        return Unanswered("starts are drawn in all six freedoms, of which this scene's plane holds three")
    if moved := moved_before(scene, number):
        return moved
    alone = scene.but_for(loads=[load])
    found = play(alone, search_s=0.0).freedoms
    limits = [(found[name].low.reached, found[name].high.reached) for name in FREEDOMS]
    opens = [OPEN_WAY * scene.size_m] * N_LENGTHS + [OPEN_ANGLE] * (len(FREEDOMS) - N_LENGTHS)
    lows = np.array([-far if low is None else max(low, -far) for (low, _), far in zip(limits, opens, strict=True)])
    highs = np.array([far if high is None else min(high, far) for (_, high), far in zip(limits, opens, strict=True)])
    not_limited = tuple(name for name, ends in zip(FREEDOMS, limits, strict=True) if None in ends)
    drops = _Drops(alone, lows, highs, any_way=turns_freely(not_limited))
    while drops.n_valid < n_starts and drops.n_proposed < MOST_PROPOSED * n_starts:
        drops.drop(n_starts)
        if progress is not None:
            progress(min(drops.n_valid / n_starts, 1.0))
    if drops.n_valid == 0:
        return Unanswered(f"no pose in the cage was found beside the start, of {drops.n_proposed} that were drawn")
    return drops.gathered(load.name, n_starts, not_limited)


def turns_freely(not_limited: tuple[str, ...]) -> bool:
    """Whether no turn has a limit, so that starts are turned in any way."""
    return set(FREEDOMS[N_LENGTHS:]) <= set(not_limited)


class _Drops:
    """Starts, and where they ended."""

    def __init__(self, scene: Scene, lows: FloatArray, highs: FloatArray, *, any_way: bool) -> None:
        self._scene, self._lows, self._highs, self._any_way = scene, lows, highs, any_way
        self._work = work_of(scene, scene.loads[0], scene.object.pose_world_object)
        self._has_friction = greatest_friction(scene, chosen_method(scene, None).friction(scene)) > 0.0
        self._random = np.random.default_rng(SEED)
        self._starts, self._ends = list[Pose](), list[FloatArray]()
        self._verdicts, self._touching = list[str](), list[NDArray[np.bool_]]()
        self.n_proposed = 0

    @property
    def n_valid(self) -> int:
        return len(self._verdicts)

    def drop(self, n: int) -> None:
        """Draw poses and let the object go from those that are free."""
        shares = self._random.random((n, len(FREEDOMS))) * np.cbrt(self._random.random((n, 1)))
        sides = np.where(self._random.random((n, len(FREEDOMS))) < 0.5, self._lows, self._highs)
        values = shares * sides
        poses = [self._pose(row) for row in values]
        if self._any_way:
            turns = self._random.normal(size=(n, 4))
            poses = [Pose(pose.position_m, turn) for pose, turn in zip(poses, turns, strict=True)]
        # As the batch makes them, so that a start that is followed again ends there again, bit for bit.
        angles = [pose.euler_zyx for pose in poses]
        poses = [Pose(pose.position_m, euler_zyx=turned) for pose, turned in zip(poses, angles, strict=True)]
        ended = run_many(
            self._scene,
            Variation(
                object_position_m=np.array([pose.position_m for pose in poses]),
                object_euler_zyx=np.array(angles),
            ),
        )
        self.n_proposed += n
        is_free = ended.verdict != "invalid"
        for row in np.flatnonzero(is_free).tolist():
            self._starts.append(poses[row])
            self._ends.append(np.concatenate([ended.position_m[row, 0], ended.quaternion_wxyz[row, 0]]))
            self._verdicts.append(str(ended.verdict[row]))
            self._touching.append(ended.touching[row, 0])

    def _pose(self, values: FloatArray) -> Pose:
        """Return the object's pose in the world after displacements and angles from the start in the cage's axes."""
        cage, start = self._scene.cage.pose_world_cage, self._scene.object.pose_world_object
        axes = Pose(quaternion_wxyz=cage.quaternion_wxyz)
        turn = Pose(euler_zyx=values[:2:-1])
        turned = axes @ turn @ axes.inverse() @ Pose(quaternion_wxyz=start.quaternion_wxyz)
        return Pose(start.position_m + axes.transform(values[:N_LENGTHS]), turned.quaternion_wxyz)

    def gathered(self, phase: str, n_starts: int, not_limited: tuple[str, ...]) -> CageRests:
        n = min(self.n_valid, n_starts)
        values = self._values(np.array(self._ends[:n]))
        verdicts, touching = np.array(self._verdicts[:n]), np.array(self._touching[:n])
        left, found = np.arange(n), list[tuple[_End, NDArray[np.int64]]]()
        while len(left):
            first = int(left[0])
            end = self._end(first)
            alike = verdicts[left] == verdicts[first]
            if end.stability is not None and self._has_friction:
                alike &= (touching[left] == touching[first]).all(axis=1)
            elif end.stability is not None and end.rolls:
                alike[alike] = [self._is_rolled(self._end(row), end) for row in left[alike].tolist()]
            elif end.stability is not None:
                determined = [name not in end.undetermined for name in FREEDOMS]
                apart = np.abs(values[left] - values[first])
                apart[:, N_LENGTHS:] = np.minimum(apart[:, N_LENGTHS:], 2.0 * math.pi - apart[:, N_LENGTHS:])
                apart[:, :N_LENGTHS] /= self._scene.size_m
                alike &= (apart[:, determined] <= SAME_POSE).all(axis=1)
            found.append((end, left[alike]))
            left = left[~alike]
        found.sort(key=lambda one: -len(one[1]))
        ends_in = np.zeros(n, dtype=np.int64)
        for number, (_, rows) in enumerate(found):
            ends_in[rows] = number
        rests = tuple(end.rest(len(rows), n) for end, rows in found)
        starts = self._starts[:n]
        return CageRests(
            phase,
            rests,
            np.array([start.position_m for start in starts]),
            np.array([start.quaternion_wxyz for start in starts]),
            tuple(ends_in.tolist()),
            self.n_proposed,
            self._has_friction,
            not_limited,
        )

    def _end(self, row: int) -> _End:
        """Follow one start again, and tell how it ends."""
        ended = run(self._scene.but_for(object=self._scene.object.starting_at(self._starts[row]))).phases[0]
        if ended.verdict not in AT_REST:
            return _End(ended.verdict, None, ended.pose, (), (), frozenset())
        touching = tuple(dict.fromkeys(contact.point for contact in ended.contacts))
        forces = [(contact.point, contact.box, contact.force_normal_n or 0.0) for contact in ended.contacts]
        least_n = BEARS * max((force_n for *_, force_n in forces), default=0.0)
        bearing = frozenset((point, part) for point, part, force_n in forces if force_n > least_n)
        proof = ended.proof
        return _End(ended.verdict, proof.stability, ended.pose, touching, proof.undetermined, bearing)

    def _is_rolled(self, end: _End, first: _End) -> bool:
        """Whether one end has the load on the same parts as another, at the same height, and its centre of gravity at
        the same place, as far as the load says where that is.
        """
        if end.bearing != first.bearing or end.stability is None:
            return False
        center = self._scene.object.center_of_gravity_m
        way = self._scene.cage.pose_world_cage.rotation.T @ (end.pose.transform(center) - first.pose.transform(center))
        is_told = [name not in first.undetermined for name in FREEDOMS[:N_LENGTHS]]
        if (np.abs(way[is_told]) > SAME_POSE * self._scene.size_m).any():
            return False
        if self._work is None:
            return True
        rise = self._work.potential(end.pose) - self._work.potential(first.pose)
        return abs(rise) <= SAME_HEIGHT * self._work.size_n * self._scene.size_m

    def _values(self, ends: FloatArray) -> FloatArray:
        """Return displacements and angles from the start in the cage's axes, (n, 6), of poses (n, 7) in the world."""
        start = self._scene.object.pose_world_object
        axes = Pose(quaternion_wxyz=self._scene.cage.pose_world_cage.quaternion_wxyz)
        back = Pose(quaternion_wxyz=start.quaternion_wxyz).inverse() @ axes
        turns = [(axes.inverse() @ Pose(quaternion_wxyz=end[3:]) @ back).euler_zyx[::-1] for end in ends]
        return np.concatenate([axes.inverse_transform(ends[:, :3] - start.position_m), np.array(turns)], axis=1)


class _End(NamedTuple):
    """How one start ends; ``bearing``: the parts of the cage and the object between which forces are."""

    verdict: str
    stability: str | None
    pose: Pose
    touching: tuple[str, ...]
    undetermined: tuple[str, ...]
    bearing: frozenset[tuple[str, str]]

    @property
    def rolls(self) -> bool:
        """Whether the object can turn on otherwise than about the cage's z axis through anywhere: then neither its
        position nor its angles tell ends apart.
        """
        left = set(self.undetermined)
        return not left <= PLANE_FREEDOMS or ("yaw" in left and not {"x", "y"} <= left)

    def rest(self, n_here: int, n: int) -> CageRest:
        return CageRest(*self[:5], n_here, *wilson(n_here, n))
