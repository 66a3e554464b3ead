"""Play of any shapes: its ends are where pushes come to rest (7.15)."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from time import perf_counter

import numpy as np

from cagepose.errors import SceneError
from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.run import Motion, motion_between
from cagepose.studies.cage_verdict import CageVerdict, PathStep
from cagepose.studies.play_frame import FREEDOMS, N_LENGTHS
from cagepose.studies.play_limits import Clearance, pressed_clearances
from cagepose.studies.play_result import EndStatus, PlayEnd
from cagepose.studies.pushes import PITCH, ROLL, YAW, Freedom, Pushed, Pushes
from cagepose.studies.tolerances import FARTHER_END

MOST_ROUNDS = 5
"""So many rounds of pushes start from the ends of others. One round that finds nothing is usual."""
MOST_STEPS = 5_000
"""All pushes from the ends of others take so many steps at most, as many on any machine. That is a second or two, where
shapes are many."""
WAYS_AHEAD = (0.01, 0.03, 0.1, 0.3, 1.0)
"""In sizes of the scene: how far ahead of an escape it is asked whether the way is free."""
RANDOM_SEED = 20250101

Chain = tuple[Pushed, ...]
"""Pushes one after the other, from the start; none: the start itself."""


@dataclass(eq=False)
class _Found:
    """The farthest of one end: its value with its sign, where it was pushed to, and what led to the start of that."""

    value: float
    pushed: Pushed
    before: Chain

    @property
    def is_end(self) -> bool:
        return self.pushed.rests and not self.pushed.is_saddle


class PushedPlay:
    """What pushes find for the freedoms of a scene's object and for further ways of points of it."""

    def __init__(self, scene: Scene, pushes: Pushes, shifts: Sequence[tuple[FloatArray, FloatArray]]) -> None:
        self.scene, self._pushes = scene, pushes
        lengths = [Freedom(np.zeros(3), axis) for axis in np.eye(N_LENGTHS)]
        angles = [Freedom(np.zeros(3), np.zeros(3), angle) for angle in (ROLL, PITCH, YAW)]
        self._freedoms = [*lengths, *angles, *(Freedom(*shift) for shift in shifts)]
        self._found = dict[tuple[int, float], _Found]()
        self.escape: Chain | None = None
        self._escape_by = ""
        started = perf_counter()
        self._search()
        self.analysis_s = perf_counter() - started

    def _search(self) -> None:
        """Push each way from the start, then from where other pushes came to rest, until none goes farther.

        An object that gets out is pushed from the start alone: out there nothing has an end.
        """
        named = np.flatnonzero(self._pushes.held == 0.0).tolist()
        asked = range(len(FREEDOMS), len(self._freedoms))
        self._push_middle()
        self._push_all(named, [()])
        first_steps = self._pushes.n_steps
        new = self._chains(named)
        pool = list(new)
        for _ in range(MOST_ROUNDS if self.escape is None else 0):
            before = {key: found.pushed for key, found in self._found.items()}
            self._push_all(named, new, first_steps + MOST_STEPS)
            new = [chain for key, chain in self._chains_of(named) if before[key] is not self._found[key].pushed]
            pool += new
            if not new or self.escape is not None:
                break
        if asked:
            self._push_all(asked, [(), *(pool if self.escape is None else ())])

    def _push_middle(self) -> None:
        """Push the centre of gravity each way: where it is not the origin, a push of that turns the object, which may
        catch on what it would pass straight.
        """
        center = self.scene.object.center_of_gravity_m
        for place in range(N_LENGTHS if center.any() else 0):
            for sign in (-1.0, 1.0):
                freedom = replace(self._freedoms[place], at_object_m=center)
                pushed = self._pushed_from((), freedom, sign, _words(place, sign))
                if pushed.verdict == "escapes":
                    self._found[place, sign] = _Found(math.inf, pushed, ())

    def _chains_of(self, places: Sequence[int]) -> list[tuple[tuple[int, float], Chain]]:
        return [
            (key, (*found.before, found.pushed))
            for key, found in self._found.items()
            if key[0] in places and found.pushed.rests
        ]

    def _chains(self, places: Sequence[int]) -> list[Chain]:
        return [chain for _, chain in self._chains_of(places)]

    def _push_all(self, places: Sequence[int], chains: Sequence[Chain], most_steps: float = math.inf) -> None:
        for place in places:
            for sign in (-1.0, 1.0):
                for chain in chains:
                    found = self._found.get((place, sign))
                    if found is not None and (found.pushed.goes_on or self._pushes.n_steps > most_steps):
                        break
                    self._push(place, sign, chain)

    def _push(self, place: int, sign: float, chain: Chain) -> None:
        freedom = self._freedoms[place]
        by = _words(place, sign) if place < len(FREEDOMS) else "there"
        pushed = self._pushed_from(chain, freedom, sign, by)
        value = math.inf if pushed.goes_on else sign * self._pushes.value(freedom, (*chain, pushed))
        before = self._found.get((place, sign))
        unit = self.scene.size_m if freedom.angle is None else 1.0
        if before is None or value > before.value + FARTHER_END * unit:
            self._found[place, sign] = _Found(value, pushed, chain)

    def _pushed_from(self, chain: Chain, freedom: Freedom, sign: float, by: str) -> Pushed:
        """Push from where others led; ``by``: in words, if it gets out."""
        start = chain[-1].pose if chain else self._pushes.start
        pushed = self._checked(freedom, sign, self._pushes.push(freedom, sign, start))
        if pushed.verdict == "escapes":
            self._note_escape((*chain, pushed), by)
        return pushed

    def _checked(self, freedom: Freedom, sign: float, pushed: Pushed) -> Pushed:
        """Return a push as it is if its end is free of overlap, and if it escapes what is ahead of it; else as stalled.

        Where parts have holes this is asked anew, by samples of their surfaces: a run may slide off a hole's wall into
        it where it does not press against that.
        """
        if not (self.scene.cage.holes or self.scene.object.holes):
            return pushed
        places = [pushed.pose.position_m]
        if pushed.verdict == "escapes" and freedom.angle is None:
            way = sign * self.scene.size_m * (self.scene.cage.pose_world_cage.rotation @ freedom.direction_cage)
            places += [pushed.pose.position_m + share * way for share in WAYS_AHEAD]
        if all(self._is_free(place, pushed.pose) for place in places):
            return pushed
        return replace(pushed, poses=pushed.poses[:0], verdict="stalled", passes_pole=False)

    def _is_free(self, position_m: FloatArray, pose: Pose) -> bool:
        place = {"position": position_m.tolist(), "quat_wxyz": pose.quaternion_wxyz.tolist()}
        try:
            self.scene.changed("object.pose", place)
        except SceneError:
            return False
        return True

    def ranges(self) -> list[tuple[PlayEnd, PlayEnd]]:
        """Return the ends of all freedoms, then of all ways of points, least and greatest."""
        return [(self._end(place, -1.0), self._end(place, 1.0)) for place in range(len(self._freedoms))]

    def _end(self, place: int, sign: float) -> PlayEnd:
        found = self._found.get((place, sign))
        if found is None:  # it is held
            return PlayEnd(None, 0.0, None, "local", lambda: self._pushes.start, tuple)
        if found.pushed.goes_on:
            return PlayEnd(None, None, None, "open", lambda: None, tuple)
        status: EndStatus = "local" if found.is_end else "not converged"
        find = partial(self._clearances, place, sign, found.pushed)
        clearances = find if found.is_end and not self._pushes.is_seated else tuple  # the seat's forces are no prices
        return PlayEnd(None, sign * found.value, None, status, lambda: found.pushed.pose, clearances)

    def _clearances(self, place: int, sign: float, pushed: Pushed) -> tuple[Clearance, ...]:
        push = self._pushes.wrench(self._freedoms[place], sign, pushed.pose)
        return pressed_clearances(self.scene, pushed.pose, pushed.contacts, push, self._pushes.held)

    def free_directions(self) -> tuple[str, ...]:
        """``x``: free both ways; ``+x``: free one way."""
        names = []
        for place, name in enumerate(FREEDOMS):
            if self._pushes.held[place] == 1.0:
                continue
            low, high = (self._found[place, sign].pushed.goes_on for sign in (-1.0, 1.0))
            if low or high:
                names.append(name if low and high else f"{'-' if low else '+'}{name}")
        return tuple(names)

    def judge(
        self, why_not: str, leaves_at: Pose | None, search_s: float, progress: Callable[[float], None] | None
    ) -> CageVerdict:
        """Say whether a push led out; if none of those did, push points of the object at random for a time.

        ``why_not`` and ``leaves_at`` say why there is no proof that none does.
        """
        rng, started, n_tried = np.random.default_rng(RANDOM_SEED), perf_counter(), 0
        chains = [(), *self._chains(range(len(FREEDOMS)))]
        reach, center = self.scene.object.reach_m, self.scene.object.center_of_gravity_m
        while self.escape is None:
            share = (perf_counter() - started) / search_s if search_s > 0.0 else 1.0
            if progress is not None:
                progress(min(share, 1.0))
            if share >= 1.0:
                break
            along = rng.normal(size=3)
            aim = Freedom(center + reach * rng.uniform(-1.0, 1.0, 3), along / np.linalg.norm(along))
            chain = chains[rng.integers(len(chains))]
            pushed = self._pushed_from(chain, aim, 1.0, "at random")
            n_tried += 1
            if pushed.rests:
                chains.append((*chain, pushed))
        if self.escape is not None:
            n_before = len(self.escape) - 1
            after = f" after {n_before} other {'push' if n_before == 1 else 'pushes'}" if n_before else ""
            reason = f"pushed {self._escape_by}{after}, it gets out"
            return CageVerdict("escapes", reason, self.free_directions(), self._path(self.escape), None, n_tried)
        searched = f"{n_tried} random pushes found no way out" if n_tried else "no way out was searched"
        return CageVerdict("not certified", f"{why_not}; {searched}", self.free_directions(), None, leaves_at, n_tried)

    def _note_escape(self, chain: Chain, by: str) -> None:
        """Keep the shortest way out."""
        if self.escape is None or _n_steps(chain) < _n_steps(self.escape):
            self.escape, self._escape_by = chain, by

    def _path(self, chain: Sequence[Pushed]) -> tuple[PathStep, ...]:
        held, found = self.scene.object, list[PathStep]()
        for pushed in chain:
            for number in range(len(pushed.poses)):
                before, after = pushed.pose_after(number), pushed.pose_after(number + 1)
                motion = motion_between(before, after, held.center_of_gravity_m, self.scene.size_m)
                if motion is not None and not _is_idle(motion, self.scene):
                    found.append(PathStep(motion, after))
        return tuple(found)


def _n_steps(chain: Chain) -> int:
    return sum(len(pushed.poses) for pushed in chain)


def _words(place: int, sign: float) -> str:
    """``along -x``, ``in +yaw``."""
    return f"{'along' if place < N_LENGTHS else 'in'} {'+' if sign > 0.0 else '-'}{FREEDOMS[place]}"


def _is_idle(motion: Motion, scene: Scene) -> bool:
    """Whether nothing moves by more than what counts as touching."""
    return abs(motion.distance_m) + motion.angle_rad * scene.size_m <= scene.touch_m
