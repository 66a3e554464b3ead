"""Whether the object can leave its cage: a proof that it cannot, a way out, or neither and why."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from time import perf_counter
from typing import Literal

import numpy as np

from cagepose.kernels.algebra.pose import euler_zyx_from_quaternion
from cagepose.kernels.algebra.record import Rows, empty_rows
from cagepose.kernels.play.certificate import FREE, OFF_EDGE, RAN_OFF, UNSOLVED
from cagepose.kernels.play.escape import Station
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.model.wording import short
from cagepose.runs.run import Motion
from cagepose.studies.bounds import Bounds
from cagepose.studies.free_motions import FreeMotions
from cagepose.studies.play_frame import PlayFrame, motion_after

Caged = Literal["caged", "not certified", "escapes"]
MOST_STATIONS = 100_000
NOISE_DEG = 1e-6
"""Angles below this are told as 0."""
STAND_INS_ARE_FREE = (
    "the proof takes points within the cage's shapes and boxes within the object, and the points leave the boxes free"
)
"""This is said of shapes that are not boxes and points themselves, where pushes come to an end in every direction."""


@dataclass(frozen=True, eq=False)
class PathStep:
    """A motion on the way out, and the pose at its end."""

    motion: Motion
    pose_world_object: Pose

    def __repr__(self) -> str:
        return f"<PathStep: {self.motion.kind} to {self.pose_world_object}>"


@dataclass(frozen=True, eq=False)
class CageVerdict:
    """Whether the object can get out.

    Attributes
    ----------
    verdict
        "caged" is a proof, "escapes" too: by the path. "not certified" says that neither was found.
    reason
        In words.
    free_directions
        Freedoms that the linearised gaps leave without end.
    path
        The way out: each motion is free of collision, the last one meets nothing ahead; None: none found.
    leaves_at
        "not certified" because a point leaves its face: the object's pose in the world, as linearised, at which the
        point is farthest off; None: any other verdict or reason.
    n_tried
        Motions that the search tried; in a plane, poses at which it asked.
    """

    verdict: Caged
    reason: str
    free_directions: tuple[str, ...]
    path: tuple[PathStep, ...] | None
    leaves_at: Pose | None
    n_tried: int

    def __repr__(self) -> str:
        return f"<CageVerdict: {self.verdict}>"


def judge_cage(
    scene: Scene,
    frame: PlayFrame,
    bounds: Bounds,
    free_directions: tuple[str, ...],
    search_s: float,
    progress: Callable[[float], None] | None,
) -> tuple[CageVerdict, np.ndarray]:
    """Return the verdict, and the stations of a search that found no way out; it follows where there is no proof."""
    if bounds.is_caged:
        return is_caged("a point"), np.asarray(empty_rows(Station, 0))
    stations, n_stations, is_out, n_tried = search_way_out(scene, frame, search_s, progress)
    if is_out:
        path = _path(frame, stations, n_stations - 1)
        reason = f"an escape path of {len(path)} {'motion' if len(path) == 1 else 'motions'} was found"
        return CageVerdict("escapes", reason, free_directions, path, None, n_tried), np.asarray(stations)[:0]
    reason, leaves_at = why_not_caged(scene, frame, bounds, free_directions)
    searched = "no way out was found" if n_tried else "no way out was searched"
    verdict = CageVerdict("not certified", f"{reason}; {searched}", free_directions, None, leaves_at, n_tried)
    return verdict, np.asarray(stations)[:n_stations]


def is_caged(what: str) -> CageVerdict:
    return CageVerdict("caged", f"every pose on any way out puts {what} inside the object", (), None, None, 0)


def why_not_caged(
    scene: Scene, frame: PlayFrame, bounds: Bounds, free_directions: tuple[str, ...]
) -> tuple[str, Pose | None]:
    """Return why there is no proof, and the pose at which a point leaves its face."""
    proof, certificate = bounds.proof, bounds.proof.certificate
    if certificate.outcome == FREE and not free_directions:
        return STAND_INS_ARE_FREE, None
    if certificate.outcome == FREE:
        return f"nothing limits {' '.join(free_directions)}", None
    if certificate.outcome == UNSOLVED:
        return "the gaps depend on each other within rounding, so that the linear program is undecided", None
    turn_deg = np.degrees(np.linalg.norm(certificate.turn))
    if certificate.worst < 0:
        return f"the object turns by up to {turn_deg:.3g} deg, and the proof holds below 57 deg only", None
    pair = int(certificate.worst)
    point = scene.cage.names[pair // frame.geometry.n_own_boxes]
    box = scene.object.boxes[pair % frame.geometry.n_own_boxes].name
    if certificate.outcome == RAN_OFF:
        way = "may run off its face of" if proof.status[pair] == OFF_EDGE else "may come out behind its face of"
        reason = f"{point} {way} {box}, and the object is not held without it"
        twist = proof.lost_at[pair]
        if not np.isfinite(twist).all():
            return reason, None
        position, quaternion = motion_after(twist)
        angles = np.degrees(euler_zyx_from_quaternion(quaternion)).tolist()
        yaw, pitch, roll = (short(angle, 4, NOISE_DEG) for angle in angles)
        return (
            f"{reason}; it is farthest off, to first order, after roll {roll}, pitch {pitch}, yaw {yaw} deg"
        ), frame.pose_after(position, quaternion)
    return (
        f"the play is too large for the proof: the linearisation error of the gap of {point} to {box} is too great"
        f" (turns up to {turn_deg:.3g} deg)"
    ), None


def search_way_out(
    scene: Scene, frame: PlayFrame, search_s: float, progress: Callable[[float], None] | None = None
) -> tuple[Rows[Station], int, bool, int]:
    """Grow a tree of free motions until one leads out or time is up.

    Returns the stations (lengths of the scene), how many there are, whether the last one is out, and how many motions
    were tried.
    """
    tree = FreeMotions(scene, frame, MOST_STATIONS)
    started = perf_counter()
    while not tree.is_out and tree.has_room:
        share = (perf_counter() - started) / search_s if search_s > 0.0 else 1.0
        if progress is not None:
            progress(min(share, 1.0))
        if share >= 1.0:
            break
        tree.grow()
    return tree.stations, tree.n_stations, tree.is_out, tree.n_tried


def _path(frame: PlayFrame, stations: Rows[Station], last: int) -> tuple[PathStep, ...]:
    steps = []
    while stations[last].parent >= 0:
        steps.append(step_to(frame, stations[last]))
        last = int(stations[last].parent)
    return tuple(reversed(steps))


def step_to(frame: PlayFrame, station: Station) -> PathStep:
    """Return the motion that leads to a station of a search, and the object's pose there."""
    along = frame.vector_to_world(station.along)
    if station.angle > 0.0:
        motion = Motion("turn", None, along, frame.point_to_world(station.through), 0.0, float(station.angle))
    else:
        motion = Motion("travel", along, None, None, frame.length_m * float(station.distance), 0.0)
    return PathStep(motion, frame.pose_after(station.position, station.quaternion))
