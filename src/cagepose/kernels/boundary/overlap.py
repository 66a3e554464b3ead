"""Whether two bodies are in each other at a pose, deeper than what touches: asked where a run begins.

Each answer yes has a witness: a place on the surface of one body, or in it, that is deeper than the touch tolerance in
the other. Witnesses are looked for where two solids that overlap must have one.

- A curve in which the surfaces cross meets a strand of one of them, i.e. a sharp edge, a generator of a round side, or
  a circle across a tube.
  Cuts by the other surface, borders included, divide a strand into spans; the middle of each is asked. If a span lies
  in the surface, as where faces are flush, a place beside it is asked that is in its own body.
- Or the curve goes around a dent in which no strand is: there two smooth surfaces have a common normal.
- Or there is no such curve: a vertex, a circle or a generator of one body is in the other as a whole.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from cagepose.kernels.algebra.record import FloatArray, IntArray, Rows, empty_rows
from cagepose.kernels.algebra.vector import Vector, minus, plus, scaled, transposed_times, vector_from
from cagepose.kernels.boundary.cuts import MOST_CUTS, find_cuts
from cagepose.kernels.boundary.dents import find_dents
from cagepose.kernels.boundary.features import Boundary, PlacedBoundary, position_of, rotation_of
from cagepose.kernels.boundary.shells import Shells, empty_shells, find_shells
from cagepose.kernels.boundary.strands import (
    Frame,
    Strand,
    inward_at,
    length_of,
    on_strand,
    seen_in,
    strand_of,
)
from cagepose.kernels.boundary.touching import MOST_PAIRS, MOST_PLACES
from cagepose.kernels.boundary.tree import EDGES, VERTICES, Node
from cagepose.kernels.boundary.within import AT_SURFACE, Nearest, depth_in, limits_of
from cagepose.kernels.circles.places import Place
from cagepose.kernels.native.kernel import kernel

MOST_WAITING = 128
"""Nodes that wait while a tree is descended: their depth."""
SLACK, LEAST_SPAN, BESIDE = 2.0, 1e-3, 4.0
"""In touch tolerances: how far beyond its border a face still cuts; spans that are shorter are not asked; and how far
from the faces beside a strand the first place is that is asked where it lies in a surface."""
LEAST_SINE = 1e-3
"""Of half the angle of an edge: of a sharper one places that are as far inward are asked as of one with this."""
STEPS, FARTHER = 20, 4.0
"""Farther and farther from a strand places are asked, so many, each so many times as far."""


class Overlap(NamedTuple):
    """How deep two bodies are in each other.

    Attributes
    ----------
    feature, cage_feature
        Of the object and of the cage, near which the deepest place was found; -1: they are not in each other.
    depth_m
        A lower bound of how far the object has to be moved at least, in whatever direction, until they are apart.
    """

    feature: int
    cage_feature: int
    depth_m: float


NO_OVERLAP = Overlap(-1, -1, 0.0)


class OverlapWork(NamedTuple):
    """Memory for questions about two bodies at whatever poses, and what hangs together of each of them."""

    held: Shells
    cage: Shells
    own_waiting: IntArray
    waiting: IntArray
    pairs: IntArray
    cuts: FloatArray
    places: Rows[Place]


def empty_overlap_work(held: Boundary, cage: Boundary, n_bodies: int = 1) -> OverlapWork:
    """Return memory for questions about two bodies, of which the other may be one of several (plain Python)."""
    waiting = np.zeros(MOST_WAITING, np.int64)
    pairs, places = np.zeros((MOST_PAIRS, 2), np.int64), empty_rows(Place, MOST_PLACES)
    return OverlapWork(
        empty_shells(held), empty_shells(cage, n_bodies), waiting, np.array(waiting), pairs, np.zeros(MOST_CUTS), places
    )


@kernel
def forget_shells(work: OverlapWork) -> None:
    """Let the memory be of other bodies than before."""
    work.held.is_known[:] = work.cage.is_known[:] = False


@kernel
def with_shells_of(work: OverlapWork, body: int) -> OverlapWork:
    """Return memory for questions about one of the cage's bodies."""
    cage = Shells(work.cage.is_known[body : body + 1], work.cage.first)
    return OverlapWork(work.held, cage, work.own_waiting, work.waiting, work.pairs, work.cuts, work.places)


class Sides(NamedTuple):
    """Two bodies, of which one is asked whether it is in the other, and their frames as the other one has them."""

    own: Boundary
    solid: Boundary
    to_solid: Frame
    to_own: Frame


@kernel
def find_overlap(held: PlacedBoundary, cage: PlacedBoundary, touch_m: float, work: OverlapWork) -> Overlap:
    """Return how deep two bodies are in each other at their poses, if they are deeper than ``touch_m``.

    The depth is that of the deepest witness: how far a place of one surface is from the other surface, or how far a
    place in both bodies is from the two together. It is no more than how far the object has to go back, and may be much
    less, as where a bar is thrust through a plate.
    """
    find_shells(held.own, work.held, work.waiting)
    find_shells(cage.own, work.cage, work.waiting)
    to_cage, to_held = frame_of(held, cage), frame_of(cage, held)
    one, other = Sides(held.own, cage.own, to_cage, to_held), Sides(cage.own, held.own, to_held, to_cage)
    best = NO_OVERLAP
    for asks_all in (False, True):
        best = probe(one, work.held.first, asks_all, touch_m, best, work)
        best = swapped(probe(other, work.cage.first, asks_all, touch_m, swapped(best), work))
        if not asks_all:
            dent = find_dents(held, cage, touch_m, best.depth_m, work.pairs, work.waiting, work.places)
            if dent.feature >= 0:
                best = Overlap(dent.feature, dent.cage_feature, dent.depth_m)
        if best.depth_m == 0.0:
            break
    return best


@kernel
def swapped(found: Overlap) -> Overlap:
    """Return an overlap as seen from the other body."""
    return Overlap(found.cage_feature, found.feature, found.depth_m)


@kernel
def frame_of(one: PlacedBoundary, other: PlacedBoundary) -> Frame:
    """Return the frame of one body as another has it."""
    turn, r = rotation_of(other), rotation_of(one)
    origin = transposed_times(turn, minus(position_of(one), position_of(other)))
    x = transposed_times(turn, (r[0][0], r[1][0], r[2][0]))
    y = transposed_times(turn, (r[0][1], r[1][1], r[2][1]))
    z = transposed_times(turn, (r[0][2], r[1][2], r[2][2]))
    return Frame(origin, ((x[0], y[0], z[0]), (x[1], y[1], z[1]), (x[2], y[2], z[2])))


@kernel
def probe(sides: Sides, first: IntArray, asks_all: bool, touch_m: float, best: Overlap, work: OverlapWork) -> Overlap:
    """Return the deepest witness on one body that is in the other, if it is deeper than the best one: of strands, and
    of the first vertex of each shell; or of all vertices, as deeper ones may be among these.
    """
    own, waiting = sides.own, work.own_waiting
    low, high = limits_of(sides.solid)
    if low[0] > high[0]:  # no surfaces
        return best
    middle, half = scaled(plus(low, high), 0.5), plus(scaled(minus(high, low), 0.5), (touch_m, touch_m, touch_m))
    for root in (VERTICES, EDGES):
        if own.nodes[root].first == own.nodes[root].last or (asks_all and root == EDGES):
            continue
        waiting[0], n_waiting = root, 1
        while n_waiting > 0:
            n_waiting -= 1
            node = own.nodes[waiting[n_waiting]]
            if is_apart(node, sides.to_solid, middle, half):
                continue
            if node.left >= 0:
                waiting[n_waiting], waiting[n_waiting + 1] = node.left, node.right
                n_waiting += 2
                continue
            for i in range(node.first, node.last):
                if root == EDGES:
                    best = probe_strand(sides, i, first[i] == i, touch_m, best, work)
                elif asks_all or first[i] == i:
                    vertex = own.features[i]
                    place = plus(vector_from(vertex.point), scaled(vector_from(vertex.toward), vertex.radius))
                    place = seen_in(sides.to_solid, place)
                    best = deeper(best, i, depth_in(sides.solid, place, touch_m, work.waiting))
    return best


@kernel
def is_apart(node: Node, frame: Frame, middle: Vector, half: Vector) -> bool:
    """Whether the box of a node in another frame is apart from a box there, along its axes."""
    at, r = minus(seen_in(frame, vector_from(node.middle)), middle), frame.rotation
    for k in range(3):
        reach = abs(r[k][0]) * node.half[0] + abs(r[k][1]) * node.half[1] + abs(r[k][2]) * node.half[2]
        if abs(at[k]) > reach + half[k]:
            return True
    return False


@kernel
def probe_strand(sides: Sides, i: int, stands_alone: bool, touch_m: float, best: Overlap, work: OverlapWork) -> Overlap:
    """Return the better of a witness and those on a strand: of one that is not cut, its shell or its ends tell, unless
    it stands alone.
    """
    strand = strand_of(sides.own, i, sides.to_solid)
    n_cuts, meets = find_cuts(strand, sides.solid, SLACK * touch_m, work.waiting, work.places, work.cuts)
    if not (meets or stands_alone or strand.is_generator):
        return best
    cuts, last = work.cuts, n_cuts - 1
    for k in range(n_cuts + 1):
        if strand.is_closed and n_cuts > 0:
            if k > last:
                break
            begin, end = cuts[k], cuts[k + 1] if k < last else cuts[0] + 2.0 * math.pi
        else:
            begin, end = cuts[k - 1] if k > 0 else strand.begin, cuts[k] if k <= last else strand.end
        if length_of(strand, begin, end) > LEAST_SPAN * touch_m:
            best = probe_span(sides, i, strand, begin, end, touch_m, best, work)
    return best


@kernel
def probe_span(
    sides: Sides, i: int, strand: Strand, begin: float, end: float, touch_m: float, best: Overlap, work: OverlapWork
) -> Overlap:
    """Return the better of a witness and those on a span between two cuts."""
    middle = 0.5 * (begin + end)
    place = on_strand(strand, middle)
    near = depth_in(sides.solid, place, touch_m, work.waiting)
    best = deeper(best, i, near)
    if near.distance != AT_SURFACE:
        return best
    for at in (begin, end):  # it may lead out of the surface at a small angle
        if at == strand.begin or at == strand.end:
            best = deeper(best, i, depth_in(sides.solid, on_strand(strand, at), touch_m, work.waiting))
    inward = inward_at(strand, middle)
    step = max(BESIDE * touch_m, best.depth_m) / max(strand.sine, LEAST_SINE)  # there the depths may add up to more
    for _ in range(STEPS):
        beside = plus(place, scaled(inward, step))
        other = depth_in(sides.solid, beside, touch_m, work.waiting)
        if other.distance <= 0.0:
            break
        own = depth_in(sides.own, seen_in(sides.to_own, beside), touch_m, work.waiting)
        if own.distance <= 0.0:
            break
        best = deeper(best, i, Nearest(own.distance + other.distance, other.feature))
        step *= FARTHER
    return best


@kernel
def deeper(best: Overlap, i: int, near: Nearest) -> Overlap:
    """Return the deeper of two witnesses."""
    return Overlap(i, near.feature, near.distance) if near.distance > best.depth_m else best
