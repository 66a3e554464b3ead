"""A way out in the plane as few motions that are free of contact: `way_of`."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from cagepose.runs.run import Motion
from cagepose.studies.cage_verdict import PathStep
from cagepose.studies.plane_cells import Cell, Cells
from cagepose.studies.plane_frame import InPlane, PlaneFrame, nearest_in
from cagepose.studies.plane_lift import Lift

SAFE = 0.9
"""Of a gap. So far a motion may go until the gap is asked again."""
LEAST_GAP = 1e-7
"""Of the object's reach. A motion that comes nearer to the cage is no shorter way."""
LEAST_TURN, LEAST_TRAVEL = 1e-9, 1e-9
"""Radians, and of the object's reach. What is less is no motion."""


class Way(NamedTuple):
    """Motions free of contact, one after the other, and where the potential is greatest on them."""

    steps: tuple[PathStep, ...]
    top: InPlane


def way_of(cells: Cells, lift: Lift, way: Sequence[Cell], cap_j: float = math.inf) -> Way:
    """Return a way from the start to where the object is lifted, and from there through cells that are free, as turns
    and travels. It is made shorter where that is free of contact, too, and stays below a cap of the potential.
    """
    frame = cells.frame
    places = [lift.end, *_places(cells, way)]
    short, at = places[:1], 0
    while at < len(places) - 1:
        known, step = at + 1, 2
        while at + step < len(places) and _is_free(cells, places[at], places[at + step], cap_j):
            known, step = at + step, 2 * step
        beyond = min(at + step, len(places))
        while beyond - known > 1:
            middle = (known + beyond) // 2
            if _is_free(cells, places[at], places[middle], cap_j):
                known = middle
            else:
                beyond = middle
        short.append(places[known])
        at = known
    steps = [] if lift.step is None else [lift.step]
    tops = [frame.start, lift.end]
    for one, other in pairwise(short):
        steps += _steps(frame, one, other)
        tops += [frame.highest(*leg) for leg in _legs(one, other)]
    return Way(tuple(steps), max(tops, key=frame.potential))


def _places(cells: Cells, way: Sequence[Cell]) -> list[InPlane]:
    """Return poses, each of which and the next are in one cell: the middles of these, and of the faces between."""
    places = [cells.block(cell).middle for cell in way[:1]]
    for one, other in pairwise(way):
        small, wide = (one, other) if one[0] >= other[0] else (other, one)
        places += [nearest_in(cells.block(wide), cells.block(small).middle), cells.block(other).middle]
    return places


def _legs(one: InPlane, other: InPlane) -> Iterator[tuple[InPlane, InPlane]]:
    """Yield the ends of the turn, and then the travel, from one pose to another."""
    turn = (other.turn - one.turn + math.pi) % (2.0 * math.pi) - math.pi
    turned = InPlane(one.u, one.v, one.turn + turn)
    yield one, turned
    yield turned, InPlane(other.u, other.v, turned.turn)


def _is_free(cells: Cells, one: InPlane, other: InPlane, cap_j: float) -> bool:
    """Whether the turn and the travel from one pose to another meet nothing, and stay below a cap of the potential."""
    frame = cells.frame
    for begin, end in _legs(one, other):
        if frame.potential(frame.highest(begin, end)) > cap_j:
            return False
        length_m = math.hypot(end.u - begin.u, end.v - begin.v) + frame.reach_m * abs(end.turn - begin.turn)
        gone_m = 0.0
        while True:
            share = gone_m / length_m if length_m > 0.0 else 1.0
            at = InPlane(*(a + share * (b - a) for a, b in zip(begin, end, strict=True)))
            gap_m = cells.gap_m(at, max(frame.reach_m, length_m))
            if gap_m <= LEAST_GAP * frame.reach_m:
                return False
            if gone_m + gap_m >= length_m:
                break
            gone_m += SAFE * gap_m
    return True


def _steps(frame: PlaneFrame, one: InPlane, other: InPlane) -> Iterator[PathStep]:
    """Yield the turn and the travel from one pose to another, those that are none left out."""
    (begin, turned), (_, end) = _legs(one, other)
    angle = turned.turn - begin.turn
    if abs(angle) > LEAST_TURN:
        axis = math.copysign(1.0, angle) * frame.normal
        yield PathStep(Motion("turn", None, axis, frame.place(begin), 0.0, abs(angle)), frame.pose(turned))
    travel = frame.place(end) - frame.place(turned)
    distance = float(np.linalg.norm(travel))
    if distance > LEAST_TRAVEL * frame.reach_m:
        yield PathStep(Motion("travel", travel / distance, None, None, distance, 0.0), frame.pose(end))
