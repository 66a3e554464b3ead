"""Play about the pose in which a load has seated the object: `seated_play` (7.15)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from cagepose.errors import Problem, SceneError
from cagepose.kernels.algebra.linear_program import program_rows
from cagepose.kernels.algebra.record import IntArray, empty_rows
from cagepose.kernels.play.extreme import REACHED, Extreme, find_linear_play
from cagepose.kernels.play.polytope import N_TRUST, PlayWorkspace, empty_play_workspace, write_start
from cagepose.model.checks import FloatArray, expect, finite_array, unit_vector
from cagepose.model.pose import Pose
from cagepose.model.scope import check_boxes_and_points
from cagepose.runs.run import AT_REST, PhaseRun, Run
from cagepose.studies.play_frame import FREEDOMS, LENGTHS, PlayFrame, range_goals

BEARS = 1e-9
"""Of the greatest contact force: a contact with less carries nothing."""
FLAT = 1e-12
"""Lengths of the scene: how exactly what carries load stays at its face."""
FARTHEST, MOST_TURN_RAD = 0.5, 0.35
"""Lengths of the scene, and radians: what could move farther to first order is free, as that says no more by then."""


@dataclass(frozen=True, eq=False)
class SeatedEnd:
    """One end of a range, metres or radians from the seated pose, to first order.

    Attributes
    ----------
    value
        None: nothing nearby ends it.
    stops
        Names of the cage points that do, sorted.
    """

    value: float | None
    stops: tuple[str, ...]

    def __repr__(self) -> str:
        return f"<SeatedEnd: {'free' if self.value is None else f'{self.value:.6g}'}>"


@dataclass(frozen=True, eq=False)
class SeatedRange:
    """How far one freedom, or a point of the object along a direction, goes from the seated pose.

    Attributes
    ----------
    seated
        Least and greatest value while all contacts that carry load stay closed.
    lifted
        The same where any contact may open.
    """

    seated: tuple[SeatedEnd, SeatedEnd]
    lifted: tuple[SeatedEnd, SeatedEnd]


@dataclass(frozen=True, eq=False)
class SeatedPlay:
    """Play about the end of one phase.

    Attributes
    ----------
    run, phase
        What was run, and the name of the phase.
    pose_world_object
        Where it ended: all is measured from there.
    bearing
        Names of the cage points that carry load there.
    freedoms
        "x", "y", "z": displacement of the object's origin, metres; "roll", "pitch", "yaw": ZYX angles, radians; both in
        the cage's axes.
    points
        For each point asked about and each direction.
    """

    run: Run
    phase: str
    pose_world_object: Pose
    bearing: tuple[str, ...]
    freedoms: dict[str, SeatedRange]
    points: tuple[SeatedRange, ...]

    def __repr__(self) -> str:
        return f"<SeatedPlay of {self.run.scene.name!r} at the end of {self.phase!r}, on {' '.join(self.bearing)}>"


def seated_play(
    run: Run, phase: str | None = None, at: Sequence[ArrayLike] = (), directions: Sequence[ArrayLike] = ()
) -> SeatedPlay:
    """Say how far the object can move about the pose in which a phase has left it, to first order.

    Parameters
    ----------
    run
        Its friction and its loads count as far as they say where it ends and which contacts carry load.
    phase
        Name; None: the last one that was run.
    at, directions
        Points of the object, metres in its frame, and directions in the cage's frame, as in `cagepose.play`.

    Raises
    ------
    SceneError
        The scene has other shapes than boxes and points; no such phase, or one that did not end at rest with known
        forces; a point or a direction that is none.
    """
    expect(run, Run, "run")
    scene = run.scene
    check_boxes_and_points(scene, "play")
    ended = _ended(run, phase)
    points = [finite_array(point, (3,), "at") for point in at]
    along = [unit_vector(direction, "direction") for direction in (directions if len(directions) else np.eye(3))]
    frame = PlayFrame(scene, ended.pose)
    work = empty_play_workspace(frame.geometry)
    write_start(frame.geometry, work)
    forces = np.array([contact.force_normal_n for contact in ended.contacts], dtype=np.float64)
    loaded = [c for c, force in zip(ended.contacts, forces, strict=True) if force > BEARS * forces.max()]
    boxes = [box.name for box in scene.object.boxes]
    bearing = [scene.cage.names.index(c.point) * len(boxes) + boxes.index(c.box) for c in loaded]
    goals = range_goals(frame, [(point, direction) for point in points for direction in along])
    ends = []
    for kept in (np.array(bearing, dtype=np.int64), np.zeros(0, dtype=np.int64)):
        extremes = empty_rows(Extreme, len(goals))
        find_linear_play(goals, *_kept_closed(work, kept), work.program, extremes)
        ends.append([_end(run, frame, work, extremes[index], index, kept) for index in range(len(goals))])
    ranges = [
        SeatedRange((ends[0][low], ends[0][low + 1]), (ends[1][low], ends[1][low + 1]))
        for low in range(0, len(goals), 2)
    ]
    names = tuple(dict.fromkeys(contact.point for contact in loaded))
    found = dict(zip(FREEDOMS, ranges, strict=False))
    return SeatedPlay(run, ended.name, ended.pose, names, found, tuple(ranges[len(FREEDOMS) :]))


def _ended(run: Run, name: str | None) -> PhaseRun:
    """Return the phase that is meant, if it has seated the object."""
    phases = {phase.name: phase for phase in run.phases}
    if name is not None and name not in phases:
        raise SceneError([Problem(("phase",), f"{name} was not run; use one of: {', '.join(phases)}")])
    phase = run.phases[-1] if name is None else phases[name]
    if phase.verdict not in AT_REST:
        raise SceneError(
            [Problem(("phase",), f"{phase.name} ends with {phase.verdict}, not at rest: nothing seats it")]
        )
    if not phase.contacts or any(contact.force_normal_n is None for contact in phase.contacts):
        raise SceneError(
            [Problem(("phase",), f"{phase.name} has no known contact forces at its end: nothing seats it")]
        )
    return phase


def _kept_closed(work: PlayWorkspace, kept: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return the polytope (7.1) in which the points of some rows stay where they are: at their faces."""
    n_pairs = len(work.faces)
    rows, bounds = program_rows(n_pairs + max(N_TRUST, len(kept)))
    rows[:n_pairs], bounds[:n_pairs] = work.rows[:n_pairs], work.bounds[:n_pairs]
    bounds[kept] = FLAT
    rows[n_pairs : n_pairs + len(kept)], bounds[n_pairs : n_pairs + len(kept)] = -rows[kept], FLAT
    return rows, bounds


def _end(run: Run, frame: PlayFrame, work: PlayWorkspace, extreme: Extreme, index: int, kept: IntArray) -> SeatedEnd:
    twist = np.asarray(extreme.linear_twist)
    is_near = np.linalg.norm(twist[:3]) <= FARTHEST and np.linalg.norm(twist[3:]) <= MOST_TURN_RAD
    if extreme.linear_outcome != REACHED or not is_near:
        return SeatedEnd(None, ())
    limits = extreme.linear_limits
    n_boxes, is_angle = len(run.scene.object.boxes), LENGTHS <= index // 2 < len(FREEDOMS)
    pairs = [pair for pair in limits.pairs[: limits.n_pairs].tolist() if pair < len(work.faces) and pair not in kept]
    stops = sorted({run.scene.cage.names[pair // n_boxes] for pair in pairs})
    value = float(extreme.linear) * (1.0 if is_angle else frame.length_m)
    return SeatedEnd(value if abs(value) > FLAT else 0.0, tuple(stops))
