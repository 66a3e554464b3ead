"""Whether the object can leave its cage in the plane, by a search that leaves no way out: `judge_in_plane`."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.model.wording import number_of
from cagepose.studies.cage_verdict import CageVerdict
from cagepose.studies.plane_cells import Cells
from cagepose.studies.plane_frame import PlaneFrame
from cagepose.studies.plane_lift import lifted
from cagepose.studies.plane_search import Found, WaySearch
from cagepose.studies.plane_way import way_of

N_POSES = 40_000
"""That are asked, in some seconds."""


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
    lift = lifted(cells) if searches else None
    search = WaySearch(cells, [frame.start] if lift is None else [frame.start, lift.end])
    if searches:
        search.go_on(N_POSES, progress)
    n_asked, poses = cells.n_asked, number_of(cells.n_asked, "pose")
    if search.found == Found.NONE:
        reason = f"every way out in the plane leads through poses at which the object is in the cage; asked at {poses}"
        return CageVerdict("caged", reason, free_directions, None, None, n_asked)
    if search.found == Found.WAY:
        path = way_of(cells, lift, search.way).steps if lift is not None else ()
        reason = f"a way out of {number_of(len(path), 'motion')} was found"
        return CageVerdict("escapes", reason, free_directions, path, None, n_asked)
    searched = "no way out was searched"
    if n_asked:
        searched = f"asked at {poses}, and neither a way out was found nor that there is none"
    return CageVerdict("not certified", f"{why_not}; {searched}", free_directions, None, leaves_at, n_asked)
