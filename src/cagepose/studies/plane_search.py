"""A search for a way out of a cage in the plane that leaves none out: `WaySearch`."""

from __future__ import annotations

import heapq
import math
from collections.abc import Callable
from enum import Enum
from itertools import count
from typing import NamedTuple

from cagepose.studies.plane_cells import Cell, Cells, State
from cagepose.studies.plane_lift import Lift

BETWEEN_TELLING = 500
"""Poses, a tenth of a second."""
FREE, OPEN, BLOCKED = (int(state) for state in State)


class Found(Enum):
    """What a search has found out: a way out, that there is none, or neither yet."""

    WAY = "way"
    NONE = "none"
    UNDECIDED = "undecided"


class Known(NamedTuple):
    """What is known of a cell: its state below the cap, whether some of its poses are out of the cage's reach, its
    least potential, and how near it is to where nothing is in reach, the lesser the nearer.
    """

    state: int
    is_out: bool
    least_j: float
    inside_m: float


class Label(NamedTuple):
    """How a cell is reached: how many cells on the way are not known to be free, the greatest of their least
    potentials, and from which cell.
    """

    n_open: int
    peak_j: float
    before: Cell | None


class WaySearch:
    """Looks for a way from the start, or from where the object is lifted off what it touches there, to where nothing is
    in its reach, with no pose on it above a cap of the potential.

    Of all ways through cells that are not blocked, or above the cap, one with the fewest cells that are not known to be
    free is looked for, and the widest of these are divided: until there is a way through free cells, or none is left.
    Each way leads from a cell to one beside it, so that none is left out.

    Attributes
    ----------
    found
        See there.
    way
        The cells of a way out that was found.
    """

    def __init__(self, cells: Cells, lift: Lift | None, cap_j: float = math.inf) -> None:
        self._cells, self._frame, self._cap_j = cells, cells.frame, cap_j
        self._starts = [cells.frame.start] if lift is None else [cells.frame.start, lift.end]
        self._reached, self._followers = dict[Cell, Label](), dict[Cell, set[Cell]]()
        self._waiting = list[tuple[int, float, float, int, Cell, Cell | None]]()
        self._facts, self._tie = dict[Cell, Known](), count()
        self.found, self.way = Found.UNDECIDED, list[Cell]()
        self._begin()

    def go_on(self, n_poses: int, progress: Callable[[float], None] | None = None) -> Found:
        """Search until something is found out, or so many poses have been asked in all; call ``progress`` with the
        share of them now and then.
        """
        told = 0
        while self.found == Found.UNDECIDED and self._cells.n_asked < n_poses:
            if progress is not None and self._cells.n_asked >= told:
                progress(self._cells.n_asked / n_poses)
                told = self._cells.n_asked + BETWEEN_TELLING
            last = self._next_out()
            if last is None:
                self.found = Found.NONE
                break
            way = self._way_to(last)
            unknown = [cell for cell in way if self._known(cell).state == OPEN]
            if not unknown:
                self.found, self.way = Found.WAY, way
                break
            widest = min(cell[0] for cell in unknown)
            self._divide([cell for cell in unknown if cell[0] == widest])
        return self.found

    def _begin(self) -> None:
        """Have the cells of all starts wait."""
        for start in self._starts:
            cell = self._cells.cell_of(start)
            if cell is None:  # it is out
                self.found = Found.WAY
            elif cell not in self._reached:
                self._put(cell, None)

    def _next_out(self) -> Cell | None:
        """Return the cell at the end of the best way out; None: there is none."""
        while self._waiting:
            n_open, peak_j, _, _, cell, before = heapq.heappop(self._waiting)
            if cell in self._reached or self._cells.is_divided(cell):
                continue
            if before is not None:
                if before not in self._reached:  # it has been divided since
                    continue
                self._followers.setdefault(before, set()).add(cell)
            self._reached[cell] = Label(n_open, peak_j, before)
            if self._known(cell).is_out:
                return cell
            for beside in self._cells.beside(cell):
                if beside not in self._reached:
                    self._put(beside, cell)
        return None

    def _known(self, cell: Cell) -> Known:
        found = self._facts.get(cell)
        if found is None:
            block, frame = self._cells.block(cell), self._frame
            least_j, greatest_j = frame.potentials(block)
            state = BLOCKED if least_j > self._cap_j else int(self._cells.state(cell))
            if state == FREE and greatest_j > self._cap_j:
                state = OPEN
            found = Known(state, frame.may_be_outside(block), least_j, -frame.from_center(block.middle))
            self._facts[cell] = found
        return found

    def _put(self, cell: Cell, before: Cell | None) -> None:
        """Have a cell wait to be reached from another one."""
        known = self._known(cell)
        if known.state == BLOCKED:
            return
        n_open, peak_j = known.state, known.least_j
        if before is not None:
            there = self._reached[before]
            n_open, peak_j = n_open + there.n_open, max(peak_j, there.peak_j)
        heapq.heappush(self._waiting, (n_open, peak_j, known.inside_m, next(self._tie), cell, before))

    def _way_to(self, last: Cell) -> list[Cell]:
        """Return the cells of a way, from the first to the last."""
        way = [last]
        while (before := self._reached[way[-1]].before) is not None:
            way.append(before)
        return way[::-1]

    def _divide(self, cells: list[Cell]) -> None:
        """Divide cells, and forget all that was reached through them."""
        lost, waiting = list[Cell](), list(cells)
        while waiting:
            at = waiting.pop()
            if at in self._reached:
                before = self._reached.pop(at).before
                if before is not None:
                    self._followers.get(before, set()).discard(at)
                lost.append(at)
                waiting += self._followers.pop(at, ())
        parts = [part for cell in cells for part in self._cells.divide(cell)]
        self._begin()
        for at in [*lost, *parts]:
            if not self._cells.is_divided(at) and self._known(at).state != BLOCKED:
                for beside in self._cells.beside(at):
                    if beside in self._reached:
                        self._put(at, beside)
