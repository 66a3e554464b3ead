"""Play: how far the object can move inside its cage, what limits it, and whether it can get out."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from cagepose.errors import Problem, SceneError
from cagepose.model.checks import FloatArray, expect, finite_array, unit_vector
from cagepose.model.scene import FARTHEST_START, Scene, millimetres
from cagepose.studies.cage_verdict import CageVerdict, judge_cage
from cagepose.studies.play_frame import FREEDOMS, PlayFrame, range_goals
from cagepose.studies.play_result import Play, PlayRange, PointPlay
from cagepose.studies.polytope_play import MOST_STARTS, PolytopePlay
from cagepose.studies.pushed_play import PushedPlay
from cagepose.studies.pushes import unseated
from cagepose.studies.seat import seated as seated_pushes

SEARCH_S = 2.0
"""Seconds that the search for a way out may take, if the object is not proven to be caged."""


def play(
    scene: Scene,
    at: Sequence[ArrayLike] = (),
    directions: Sequence[ArrayLike] = (),
    *,
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
        In the cage's frame; none: x, y and z. Each goes with each point.
    seated
        Name of a phase: how far the object can move from where the scene's run comes to rest in it, while its load goes
        on, pushed a ten-thousandth as hard and without friction. None: from the start, without a load.
    search_s
        Seconds for the search for a way out, if need be.
    progress
        Called with the share of that time that has passed.

    Raises
    ------
    SceneError
        A point or direction is not three finite numbers, a direction of length zero, or a point far away; or the scene
        has no phase ``seated``, or does not come to rest in it.
    """
    expect(scene, Scene, "scene")
    points = [_point_near(scene, point) for point in at]
    along = [unit_vector(direction, "direction") for direction in (directions if len(directions) else np.eye(3))]
    shifts = [(point, direction) for point in points for direction in along]
    cage: CageVerdict | None = None
    if seated is not None:
        pushed = PushedPlay(scene, seated_pushes(scene, seated), shifts)
        ranges, times = pushed.ranges(), (pushed.analysis_s, 0.0)
    elif scene.has_other_shapes:
        pushed = PushedPlay(scene, unseated(scene), shifts)
        cage, ranges, times = pushed.judge(search_s, progress), pushed.ranges(), (pushed.analysis_s, 0.0)
    else:
        frame = PlayFrame(scene)
        found = PolytopePlay(scene, frame, range_goals(frame, shifts))
        cage, stations = judge_cage(scene, frame, found.proof, found.free_directions(), search_s, progress)
        found.search_from(stations[:MOST_STARTS])
        ranges, times = found.ranges(), (found.analysis_s, found.certificate_s)
    return Play(
        scene,
        {name: PlayRange(*ranges[index]) for index, name in enumerate(FREEDOMS)},
        tuple(PointPlay(*shift, *ends) for shift, ends in zip(shifts, ranges[len(FREEDOMS) :], strict=True)),
        cage,
        seated,
        *times,
    )


def _point_near(scene: Scene, value: ArrayLike) -> FloatArray:
    point = finite_array(value, (3,), "at")
    farthest = float(np.abs(point).max())
    if farthest > FARTHEST_START * scene.size_m:
        found = f"is {millimetres(farthest)} from the object's origin, over {FARTHEST_START:g} times the scene's size"
        raise SceneError([Problem(("at",), f"{found}; ask about a point of the object")])
    return point
