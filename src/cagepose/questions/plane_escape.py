"""How much work it takes to get a part out of its cage in a plane, from below and from above: `least_work_in_plane`."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.studies.cage_verdict import PathStep
from cagepose.studies.plane_cells import Cell, Cells
from cagepose.studies.plane_frame import PlaneFrame
from cagepose.studies.plane_lift import lifted
from cagepose.studies.plane_search import Found, WaySearch
from cagepose.studies.plane_verdict import searched
from cagepose.studies.plane_way import way_of
from cagepose.studies.play import play

N_POSES = 60_000
AS_NEAR = 0.01
"""Of the work. A way out that takes no more than what is proven and this is as good as known."""
LEVEL = 1e-6
"""Of the load times the size. A way out that takes less goes level."""

ENDLESS = "a hole that stands alone is in a plate without end, out of whose reach nothing gets"


def way_out_in_plane(scene: Scene, n_poses: int) -> bool | None:
    """Return whether there is a way out; None: it was not found out by asking at so many poses."""
    if play(scene, search_s=0.0).verdict == "caged":
        return False
    found = searched(scene, n_poses).search.found
    return None if found == Found.UNDECIDED else found == Found.WAY


class LeastWork(NamedTuple):
    """No way out takes less than ``at_least_j``, infinite: there is none; the motions of one take ``at_most_j``,
    infinite: none was found, and on it the potential is greatest at ``top``. So many ways were found, and at so many
    poses it was asked whether the part is free.
    """

    at_least_j: float
    at_most_j: float
    path: tuple[PathStep, ...]
    top: Pose | None
    n_ways: int
    n_asked: int


def least_work_in_plane(
    scene: Scene, forces: FloatArray, points: FloatArray, n_poses: int, progress: Callable[[float], None] | None = None
) -> LeastWork:
    """Return how much work it takes to get the object out, against forces (n, 3) that act at points (n, 3) of it.

    All ways that stay below a potential are asked about at once (`WaySearch`): either one of them is free, or there is
    none. So what is between the two works is halved.
    """
    frame = PlaneFrame(scene, forces, points)
    cells, level_j = Cells(scene, frame), frame.potential(frame.start)
    levels_j = LEVEL * frame.load * scene.size_m
    lift = lifted(cells)
    lift_j = 0.0 if lift is None else max(frame.potential(lift.end) - level_j, 0.0)
    at_least_j, at_most_j, cap_j = 0.0, math.inf, math.inf
    best, n_ways = list[Cell](), 0
    while cells.n_asked < n_poses:
        search = WaySearch(cells, lift, cap_j)
        found = search.go_on(n_poses, progress)
        if found == Found.NONE:
            at_least_j = cap_j - level_j
        elif found == Found.WAY:
            greatest_j = (frame.potentials(cells.block(cell))[1] - level_j for cell in search.way)
            takes_j = max([lift_j, *greatest_j])
            if takes_j >= at_most_j:  # the first step away from what it touches is the highest
                break
            best, n_ways, at_most_j = search.way, n_ways + 1, takes_j
        is_known = at_least_j == math.inf or at_most_j <= max(levels_j, (1.0 + AS_NEAR) * at_least_j)
        if is_known or found == Found.UNDECIDED:
            break
        cap_j = level_j + 0.5 * (at_least_j + at_most_j)
    if lift is None or n_ways == 0:
        top = frame.pose(frame.start) if n_ways else None
        return LeastWork(at_least_j, at_most_j, (), top, n_ways, cells.n_asked)
    way = way_of(cells, lift, best, level_j + at_most_j)
    return LeastWork(at_least_j, at_most_j, way.steps, frame.pose(way.top), n_ways, cells.n_asked)
