"""Play: how far the object can move inside its cage, what limits it, and whether it can get out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cagepose.errors import Problem, SceneError
from cagepose.model.checks import FloatArray, expect, finite_array, unit_vector
from cagepose.model.planar import held_freedoms
from cagepose.model.pose import Pose
from cagepose.model.scene import FARTHEST_START, Scene, millimetres
from cagepose.studies.bounds import Bounds
from cagepose.studies.cage_verdict import CageVerdict, is_caged, judge_cage, why_not_caged
from cagepose.studies.held import held_for_play
from cagepose.studies.inner_cage import inner_scene
from cagepose.studies.plane_frame import has_endless_holes
from cagepose.studies.plane_verdict import judge_in_plane
from cagepose.studies.play_frame import FREEDOMS, N_LENGTHS, PlayFrame, range_goals
from cagepose.studies.play_result import Play, PlayEnd, PlayRange, PointPlay
from cagepose.studies.polytope_play import MOST_STARTS, PolytopePlay
from cagepose.studies.pushed_play import PushedPlay
from cagepose.studies.pushes import unseated
from cagepose.studies.seat import seated as seated_pushes
from cagepose.studies.tolerances import PROVEN_WITHIN

NO_INNER_CAGE = "bounds can be proven only for boxes of the object, among points and solid shapes over their faces"
SEARCH_S = 2.0
"""Seconds that the search for a way out may take, if the object is not proven to be caged."""

# Least and greatest; points of the object, and a direction for each.
Ends = tuple[PlayEnd, PlayEnd]
Shifts = Sequence[tuple[FloatArray, FloatArray]]
Progress = Callable[[float], None] | None


def play(
    scene: Scene,
    at: Sequence[ArrayLike] = (),
    directions: Sequence[ArrayLike] = (),
    *,
    hold: Sequence[str] = (),
    seated: str | None = None,
    search_s: float = SEARCH_S,
    progress: Callable[[float], None] | None = None,
) -> Play:
    """Say how far the object can move, and whether it is caged.

    Parameters
    ----------
    scene
        Loads and friction do not matter, if ``seated`` is None.
    at
        Points of the object, in its frame, metres.
    directions
        In the cage's frame; none: x, y and z, of those the plane's where the scene has one. Each goes with each point.
    hold
        Freedoms that are held: any of "x", "y" and "z", and of "roll", "pitch" and "yaw" none, two or all three. What
        is said then, that it is caged too, is of motions in the others alone.
    seated
        Name of a phase: how far the object can move from where the scene's run comes to rest in it, while its load goes
        on, pushed a ten-thousandth as hard and without friction. None: from the start, without a load.
    search_s
        Seconds for the search for a way out, if need be; in a plane, it asks at 40,000 poses instead, unless this is 0.
    progress
        Called with the share of that time that has passed.

    Raises
    ------
    SceneError
        A point or direction is not three finite numbers, a direction of length zero, or a point far away; freedoms that
        cannot be held, see `held_for_play`; or the scene
        has no phase ``seated``, or does not come to rest in it.
    """
    expect(scene, Scene, "scene")
    points = [_point_near(scene, point) for point in at]
    held = held_for_play(scene, hold)
    if hold and seated is not None:
        raise SceneError([Problem(("hold",), "is asked of an object without a load; leave out seated")])
    is_free = held == 0.0
    axes = np.eye(N_LENGTHS)[is_free[:N_LENGTHS]]
    along = [unit_vector(direction, "direction") for direction in (directions if len(directions) else axes)]
    shifts = [(point, direction) for point in points for direction in along]
    if seated is not None:
        pushed = PushedPlay(scene, seated_pushes(scene, seated), shifts)
        found = _Found(None, pushed.ranges(), pushed.analysis_s, 0.0)
    elif scene.has_other_shapes or held.any():
        found = _of_shapes(scene, held, shifts, search_s, progress)
    else:
        found = _of_boxes_among_points(scene, shifts, search_s, progress)
    return Play(
        scene,
        {name: PlayRange(*found.ranges[index]) for index, name in enumerate(FREEDOMS) if is_free[index]},
        tuple(PointPlay(*shift, *ends) for shift, ends in zip(shifts, found.ranges[len(FREEDOMS) :], strict=True)),
        found.cage,
        tuple(name for name, is_held in zip(FREEDOMS, held, strict=True) if is_held),
        seated,
        found.analysis_s,
        found.certificate_s,
    )


class _Found(NamedTuple):
    """An answer: the cage, the ends of all freedoms and then of all ways of points, and seconds."""

    cage: CageVerdict | None
    ranges: list[Ends]
    analysis_s: float
    certificate_s: float


def _of_boxes_among_points(scene: Scene, shifts: Shifts, search_s: float, progress: Progress) -> _Found:
    frame = PlayFrame(scene)
    goals = range_goals(frame, shifts)
    found, bounds = PolytopePlay(scene, frame, goals), Bounds(frame, goals, scene.touch_m)
    cage, stations = judge_cage(scene, frame, bounds, found.free_directions(), search_s, progress)
    found.search_from(stations[:MOST_STARTS])
    return _Found(cage, _bounded(found.ranges(), bounds.ends), found.analysis_s, bounds.certificate_s)


def _of_shapes(scene: Scene, held: FloatArray, shifts: Shifts, search_s: float, progress: Progress) -> _Found:
    if (held != held_freedoms(scene.planar)).any():  # what is held is the origin; without a load any centre will do
        scene = scene.changed("object.center_of_gravity", [0.0, 0.0, 0.0])
    pushed, inner = PushedPlay(scene, unseated(scene, held), shifts), inner_scene(scene)
    in_plane = scene.planar is not None and (held == held_freedoms(scene.planar)).all() and not has_endless_holes(scene)

    def judged(why_not: str, leaves_at: Pose | None) -> CageVerdict:
        if in_plane and pushed.escape is None and search_s > 0.0:
            return judge_in_plane(scene, why_not, leaves_at, pushed.free_directions(), progress)
        return pushed.judge(why_not, leaves_at, search_s, progress)

    if inner is None:
        return _Found(judged(NO_INNER_CAGE, None), pushed.ranges(), pushed.analysis_s, 0.0)
    frame = PlayFrame(inner, held)
    bounds = Bounds(frame, range_goals(frame, shifts), inner.touch_m)
    if bounds.is_caged:
        cage = is_caged("a point of the cage's shapes")
    else:
        cage = judged(*why_not_caged(inner, frame, bounds, pushed.free_directions()))
    return _Found(cage, _bounded(pushed.ranges(), bounds.ends), pushed.analysis_s, bounds.certificate_s)


def _bounded(ranges: list[Ends], bounds: Sequence[float | None]) -> list[Ends]:
    """Return ends with what no motion passes, two for each range."""
    pairs = zip(ranges, bounds[::2], bounds[1::2], strict=True)
    return [(_bounded_end(low, least), _bounded_end(high, greatest)) for (low, high), least, greatest in pairs]


def _bounded_end(end: PlayEnd, certified: float | None) -> PlayEnd:
    if certified is None:
        return end
    if end.reached is None:  # a push that seemed to go on for ever
        return replace(end, reached=0.0, certified=certified, status="not converged")
    is_proven = end.status == "local" and abs(certified) <= (1.0 + PROVEN_WITHIN) * abs(end.reached)
    return replace(end, certified=certified, status="proven" if is_proven else end.status)


def _point_near(scene: Scene, value: ArrayLike) -> FloatArray:
    point = finite_array(value, (3,), "at")
    farthest = float(np.abs(point).max())
    if farthest > FARTHEST_START * scene.size_m:
        found = f"is {millimetres(farthest)} from the object's origin, over {FARTHEST_START:g} times the scene's size"
        raise SceneError([Problem(("at",), f"{found}; ask about a point of the object")])
    return point
