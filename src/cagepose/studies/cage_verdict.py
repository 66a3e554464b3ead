"""Whether the object can leave its cage: a proof that it cannot, a way out, or neither and why."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from time import perf_counter
from typing import Literal

import numpy as np

from cagepose.kernels.escape import N_RANDOM, Station, grow_tree
from cagepose.kernels.geometry import empty_placement
from cagepose.kernels.play_certificate import CAGED, FREE, RAN_OFF, Certificate
from cagepose.kernels.record import Rows, empty_rows
from cagepose.kernels.tolerances import kernel_tolerances
from cagepose.nouns.checks import as_vector
from cagepose.nouns.pose import Pose
from cagepose.nouns.scene import Scene
from cagepose.runs.run import Motion
from cagepose.studies.play_frame import PlayFrame

Caged = Literal["caged", "not certified", "escapes"]
MOST_STATIONS = 100_000
BATCH = 500
"""Motions that are tried between two looks at the clock: some milliseconds."""
SEED = 20250101


@dataclass(frozen=True, eq=False)
class PathStep:
    """A motion on the way out, and the pose at its end."""

    motion: Motion
    pose_world_object: Pose


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
    n_tried
        Motions that the search tried.
    """

    verdict: Caged
    reason: str
    free_directions: tuple[str, ...]
    path: tuple[PathStep, ...] | None
    n_tried: int


def judge_cage(
    scene: Scene,
    frame: PlayFrame,
    certificate: Certificate,
    free_directions: tuple[str, ...],
    search_s: float,
    progress: Callable[[float], None] | None,
) -> CageVerdict:
    """Return the verdict; a search for a way out follows where there is no proof."""
    if certificate.outcome == CAGED:
        return CageVerdict("caged", "every pose on the way out puts a point inside the object", (), None, 0)
    stations, n_stations, is_out, n_tried = search_way_out(scene, frame, search_s, progress)
    if is_out:
        path = _path(frame, stations, n_stations - 1)
        return CageVerdict("escapes", f"a way out of {len(path)} motions was found", free_directions, path, n_tried)
    return CageVerdict(
        "not certified", _reason(scene, frame, certificate, free_directions), free_directions, None, n_tried
    )


def _reason(scene: Scene, frame: PlayFrame, certificate: Certificate, free_directions: tuple[str, ...]) -> str:
    if certificate.outcome == FREE:
        return f"nothing limits {' '.join(free_directions)}; no way out was found"
    point = scene.cage.names[certificate.worst // frame.geometry.n_own_boxes]
    box = scene.object.boxes[certificate.worst % frame.geometry.n_own_boxes].name
    if certificate.outcome == RAN_OFF:
        return f"{point} may run off its face of {box}, and without it the object is not held; no way out was found"
    return (
        f"the play is too large for the proof: what linearising the gap of {point} to {box} leaves out grows faster"
        " than the room it is given; no way out was found"
    )


def search_way_out(
    scene: Scene, frame: PlayFrame, search_s: float, progress: Callable[[float], None] | None = None
) -> tuple[Rows[Station], int, bool, int]:
    """Grow a tree of free motions until one leads out or time is up.

    Returns the stations, how many there are, whether the last one is out, and how many motions were tried.
    """
    stations = empty_rows(Station, MOST_STATIONS)
    stations[0].parent = -1
    stations[0].quaternion[0] = 1.0
    n_stations, n_tried, is_out = 1, 0, False
    placement = empty_placement(frame.geometry)
    tolerances = kernel_tolerances(scene.size_m, scene.tolerances.touch)
    random = np.random.default_rng(SEED)
    started = perf_counter()
    while not is_out and n_stations + BATCH <= MOST_STATIONS:
        share = (perf_counter() - started) / search_s if search_s > 0.0 else 1.0
        if progress is not None:
            progress(min(share, 1.0))
        if share >= 1.0:
            break
        dice = random.random((BATCH, N_RANDOM))
        n_stations, is_out = grow_tree(
            frame.geometry, frame.length_m, dice, stations, n_stations, placement, tolerances
        )
        n_tried += BATCH
    return stations, n_stations, is_out, n_tried


def _path(frame: PlayFrame, stations: Rows[Station], last: int) -> tuple[PathStep, ...]:
    steps = []
    while stations[last].parent >= 0:
        station = stations[last]
        w, x, y, z = station.quaternion.tolist()
        pose = frame.outward(as_vector(station.position), (w, x, y, z))
        along = frame.to_world(as_vector(station.along))
        if station.angle > 0.0:
            through = frame.point_to_world(as_vector(station.through))
            motion = Motion("turn", None, along, through, 0.0, float(station.angle))
        else:
            motion = Motion("travel", along, None, None, float(station.distance), 0.0)
        steps.append(PathStep(motion, pose))
        last = int(station.parent)
    return tuple(reversed(steps))
