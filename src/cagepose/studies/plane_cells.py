"""All poses of a part in its plane, in cells of which each is free, blocked, or neither as far as is known: `Cells`."""

from __future__ import annotations

import math
from collections.abc import Iterator
from enum import IntEnum

from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.vector import Vector
from cagepose.kernels.boundary.gaps import empty_gap_work, find_gaps
from cagepose.kernels.boundary.geometry import overlap_at
from cagepose.kernels.boundary.overlap import empty_overlap_work
from cagepose.kernels.native.slots import Slots
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.driven_cage import CageAt
from cagepose.studies.plane_frame import Block, InPlane, PlaneFrame
from cagepose.studies.plane_thick import thickened
from cagepose.studies.touching import PlacesOfContact, TouchFinder

AT_FIRST = 8
"""Cells along each axis before any is divided."""

ASIDE = (0.618, 0.414, 0.302)
"""Shares of half a cell: a pose in it that is nothing special."""

HALVES = [(a, b, c) for a in (0, 1) for b in (0, 1) for c in (0, 1)]
AT_SIDE = {
    (axis, step): [half for half in HALVES if half[axis - 1] == (0 if step > 0 else 1)]
    for axis in (1, 2, 3)
    for step in (-1, 1)
}
"""The halves of a cell along its three axes, and which of its eight parts are at the face that a step leads to."""

Cell = tuple[int, int, int, int]
"""How often it was divided, and its number along both axes and around, counted in cells of its own size."""


class State(IntEnum):
    """What is known of the poses of a cell: at none of them the object is in the cage, at all of them it is, or
    neither.
    """

    FREE = 0
    OPEN = 1
    BLOCKED = 2


class Cells:
    """Cells in which all poses are from which the cage is in the object's reach.

    A cell is blocked if, at its middle, the object and the cage are deeper in each other than any point moves from
    there to a pose of the cell, equation (7.17); and free if the gap there is as wide.

    Attributes
    ----------
    frame
        See there.
    n_asked
        Poses at which it was asked how deep the object is in the cage, or how far from it; and parts of free cells,
        which are free.
    """

    def __init__(self, scene: Scene, frame: PlaneFrame) -> None:
        self.frame, self.n_asked = frame, 0
        scene = thickened(scene)
        self._touches = TouchFinder(scene)
        self._scene, self._cage = scene, CageAt(scene.cage, (Pose(),) * (1 + len(scene.cage.bodies)))
        geometry = scene.geometry
        n_bodies = len(geometry.cage.first_nodes) - 1
        self._overlaps = Slots(empty_overlap_work(geometry.held, geometry.cage.own, n_bodies))
        self._found = empty_gap_work(1)
        self._gaps = Slots(self._found)
        self._states, self._divided = dict[Cell, State](), set[Cell]()

    def block(self, cell: Cell) -> Block:
        """Return the poses of a cell."""
        level, i, j, k = cell
        n = AT_FIRST << level
        half_m, half_rad = self.frame.outside_m / n, math.pi / n
        u, v = (float(to) + (2 * at + 1 - n) * half_m for to, at in zip(self.frame.center, (i, j), strict=True))
        return Block(InPlane(u, v, (2 * k + 1 - n) * half_rad), half_m, half_rad)

    def cell_of(self, at: InPlane) -> Cell | None:
        """Return the cell that a pose is in; None: it is outside."""
        u, v = (
            0.5 + 0.5 * (x - float(to)) / self.frame.outside_m for x, to in zip(at[:2], self.frame.center, strict=True)
        )
        around = (0.5 + 0.5 * at.turn / math.pi) % 1.0

        def numbered(level: int) -> Cell:
            n = AT_FIRST << level
            return level, math.floor(u * n), math.floor(v * n), math.floor(around * n)

        cell = numbered(0)
        if not all(0 <= number < AT_FIRST for number in cell[1:]):
            return None
        while cell in self._divided:
            cell = numbered(cell[0] + 1)
        return cell

    def state(self, cell: Cell) -> State:
        found = self._states.get(cell)
        if found is None:
            found = self._states[cell] = self._asked(cell)
        return found

    def is_divided(self, cell: Cell) -> bool:
        return cell in self._divided

    def divide(self, cell: Cell) -> list[Cell]:
        """Divide a cell into eight, and return these; those of a free one are free."""
        level, i, j, k = cell
        self._divided.add(cell)
        found = [(level + 1, 2 * i + a, 2 * j + b, 2 * k + c) for a, b, c in HALVES]
        if self._states.pop(cell, State.OPEN) == State.FREE:
            self.n_asked += len(found)
            self._states.update(dict.fromkeys(found, State.FREE))
        return found

    def beside(self, cell: Cell) -> Iterator[Cell]:
        """Yield the cells that share a part of a face with one."""
        level, i, j, k = cell
        n = AT_FIRST << level
        for step in (-1, 1):
            if 0 <= i + step < n:
                yield from self._at_face((level, i + step, j, k), 1, step)
            if 0 <= j + step < n:
                yield from self._at_face((level, i, j + step, k), 2, step)
            yield from self._at_face((level, i, j, (k + step) % n), 3, step)

    def _at_face(self, cell: Cell, axis: int, step: int) -> Iterator[Cell]:
        """Yield the cells that are where one would be of a size, as far as they touch the face that one steps over."""
        level, i, j, k = cell
        while level and (level - 1, i >> 1, j >> 1, k >> 1) not in self._divided:
            level, i, j, k = level - 1, i >> 1, j >> 1, k >> 1
        if (level, i, j, k) not in self._divided:
            yield level, i, j, k
            return
        waiting, parts = [(level, i, j, k)], AT_SIDE[axis, step]
        while waiting:
            level, i, j, k = waiting.pop()
            for a, b, c in parts:
                part = (level + 1, 2 * i + a, 2 * j + b, 2 * k + c)
                if part in self._divided:
                    waiting.append(part)
                else:
                    yield part

    def gap_m(self, at: InPlane, within_m: float) -> float:
        """Return a length that the object is at least away from the cage at a pose, up to ``within_m``; zero: it
        touches the cage, or is in it.
        """
        self.n_asked += 1
        pose = self.frame.pose_of(at)
        if self._depth_m(pose) > 0.0:
            return 0.0
        n_found = find_gaps(self._touches.geometry, *pose, within_m, True, self._touches.placement, self._gaps)
        if n_found == 0:
            return 0.0 if len(self.touching(at).elements) else within_m
        return float(self._found.rows[0].gap) if n_found > 0 else 0.0

    def touching(self, at: InPlane) -> PlacesOfContact:
        """Return where the object touches the cage at a pose."""
        return self._touches.at(self.frame.pose(at), self._cage)

    def _depth_m(self, pose: tuple[Vector, Quaternion]) -> float:
        return overlap_at(self._touches.geometry, *pose, self._touches.placement, self._overlaps)[2]

    def _asked(self, cell: Cell) -> State:
        block = self.block(cell)
        goes_by = self.frame.goes_by(block) + self._scene.geometry.touch_m
        depth_m = self._depth_m(self.frame.pose_of(block.middle))
        if depth_m > 0.0:
            self.n_asked += 1
            return State.BLOCKED if depth_m > goes_by else State.OPEN
        if self.gap_m(block.middle, goes_by) < goes_by:
            return State.OPEN
        u, v, turn = block.middle  # what is in the middle of a hidden surface tells no depth
        aside = InPlane(u + ASIDE[0] * block.half_m, v + ASIDE[1] * block.half_m, turn + ASIDE[2] * block.half_rad)
        return State.OPEN if self._depth_m(self.frame.pose_of(aside)) > 0.0 else State.FREE
