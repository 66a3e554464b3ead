"""Whether the object can leave its cage in the plane, by a search that leaves no way out: `judge_in_plane`."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.model.wording import number_of
from cagepose.studies.cage_verdict import CageVerdict
from cagepose.studies.plane_cells import Cells
from cagepose.studies.plane_frame import PlaneFrame
from cagepose.studies.plane_search import Found, WaySearch
from cagepose.studies.plane_way import motions_of

N_POSES, OF_BATCH = 40_000, 500
"""Poses that are asked, some seconds; and at a time."""


def judge_in_plane(
    scene: Scene,
    why_not: str,
    leaves_at: Pose | None,
    free_directions: tuple[str, ...],
    searches: bool,
    progress: Callable[[float], None] | None,
) -> CageVerdict:
    """Look for ways out of a scene that moves in a plane until one is found, or none is left, if it ``searches``.

    ``why_not`` and ``leaves_at`` say why there is no other proof that there is none.
    """
    frame = PlaneFrame(scene, np.zeros((1, 3)), np.zeros((1, 3)))
    cells = Cells(scene, frame)
    search = WaySearch(cells, frame.start, math.inf)
    while searches and search.found == Found.UNDECIDED and cells.n_asked < N_POSES:
        if progress is not None:
            progress(cells.n_asked / N_POSES)
        search.go_on(cells.n_asked + OF_BATCH)
    n_asked, poses = cells.n_asked, number_of(cells.n_asked, "pose")
    if search.found == Found.NONE:
        reason = f"every way out in the plane leads through poses at which the object is in the cage; asked at {poses}"
        return CageVerdict("caged", reason, free_directions, None, None, n_asked)
    if search.found == Found.WAY:
        _, path = motions_of(cells, search.way, math.inf) if search.way else ([], [])
        motions = number_of(len(path), "motion")
        reason = f"a way out of {motions} was found"
        return CageVerdict("escapes", reason, free_directions, tuple(path), None, n_asked)
    searched = "no way out was searched"
    if n_asked:
        searched = f"asked at {poses}, and neither a way out was found nor that there is none"
    return CageVerdict("not certified", f"{why_not}; {searched}", free_directions, None, leaves_at, n_asked)
