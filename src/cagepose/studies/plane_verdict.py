"""Whether the object can leave its cage in the plane, by a search that leaves no way out: `judge_in_plane`."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.model.wording import number_of
from cagepose.studies.cage_verdict import CageVerdict
from cagepose.studies.plane_cells import Cells
from cagepose.studies.plane_frame import PlaneFrame
from cagepose.studies.plane_lift import Lift, lifted
from cagepose.studies.plane_search import Found, WaySearch
from cagepose.studies.plane_way import way_of

N_POSES = 40_000
"""That are asked, in some seconds."""


class Searched(NamedTuple):
    """A search, the cells that it has asked, and how the object leaves what it touches; None: not known."""

    cells: Cells
    lift: Lift | None
    search: WaySearch


def searched(scene: Scene, n_poses: int, progress: Callable[[float], None] | None = None) -> Searched:
    """Look for ways out of a scene that moves in a plane until one is found, or none is left, or so many poses have
    been asked.
    """
    cells = Cells(scene, PlaneFrame(scene))
    lift = lifted(cells)
    search = WaySearch(cells, lift)
    search.go_on(n_poses, progress)
    return Searched(cells, lift, search)


def judge_in_plane(
    scene: Scene,
    why_not: str,
    leaves_at: Pose | None,
    free_directions: tuple[str, ...],
    progress: Callable[[float], None] | None,
) -> CageVerdict:
    """Say whether a search in the plane finds a way out, or that there is none.

    ``why_not`` and ``leaves_at`` say why there is no other proof that there is none.
    """
    cells, lift, search = searched(scene, N_POSES, progress)
    n_asked, poses = cells.n_asked, number_of(cells.n_asked, "pose")
    if search.found == Found.NONE:
        reason = f"every way out in the plane leads through poses at which the object is in the cage; asked at {poses}"
        return CageVerdict("caged", reason, free_directions, None, None, n_asked)
    if search.found == Found.WAY:
        path = way_of(cells, lift, search.way).steps if lift is not None else ()
        reason = f"a way out of {number_of(len(path), 'motion')} was found"
        return CageVerdict("escapes", reason, free_directions, path, None, n_asked)
    unknown = f"asked at {poses}, and neither a way out was found nor that there is none"
    return CageVerdict("not certified", f"{why_not}; {unknown}", free_directions, None, leaves_at, n_asked)
