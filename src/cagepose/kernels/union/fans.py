"""The fan of planes around a line: between two of them there is material or none.

Where a run of material ends, a face of the union begins. A run of less than half a turn is a convex edge; two runs are
two edges that touch. One of half a turn is no edge, but a border between the faces of two parts, if these lie flush.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.record import IntArray, Rows
from cagepose.kernels.algebra.vector import Vector, cross, dot, norm, plus, scaled, vector_from
from cagepose.kernels.native.kernel import entry, kernel
from cagepose.kernels.union.arcs import CONCAVE, CONVEX, SMOOTH, Arc, is_continued
from cagepose.kernels.union.lines import (
    LEAST_SINE,
    FanWork,
    Line,
    Span,
    find_cuts,
    find_spans,
    line_of,
    note_planes,
)
from cagepose.kernels.union.pieces import Pieces, Plane, outward

NO_ROOM = -1


@entry
def find_arcs(
    pairs: IntArray,
    order: IntArray,
    n_planes: int,
    middle: Vector,
    reach_m: float,
    touch_m: float,
    pieces: Pieces,
    planes: Rows[Plane],
    is_done: NDArray[np.bool_],
    work: FanWork,
    arcs: Rows[Arc],
) -> int:
    """Write the runs of material around all lines that begin or end a face; return how many there are, or `NO_ROOM`.

    Parameters
    ----------
    pairs
        Those of `find_pairs`, each once, in rising order.
    order
        Of the pairs: those of planes that are closer to a right angle first. They tell their line better, and where
        more than two planes share a line, it is that of the first pair.
    middle, reach_m
        A ball around all pieces, metres.
    touch_m
        What is closer is at one place.
    is_done
        Of each pair, all False.
    """
    n_arcs = 0
    for k in range(len(order)):
        if is_done[order[k]]:
            continue
        a, b = pairs[order[k]] // n_planes, pairs[order[k]] % n_planes
        if norm(cross(vector_from(planes[a].normal), vector_from(planes[b].normal))) < LEAST_SINE:
            continue
        line = line_of(planes[a], planes[b], middle)
        note_planes(line, reach_m, touch_m, planes, n_planes, work)
        work.holds_line[a], work.holds_line[b] = True, True
        _mark_done(pairs, n_planes, work, is_done)
        n_spans = find_spans(line, touch_m, pieces, planes, work)
        n_cuts = find_cuts(n_spans, work)
        first_arc = n_arcs
        for c in range(n_cuts - 1):
            n_rays = _find_rays(line, 0.5 * (work.cuts[c] + work.cuts[c + 1]), n_spans, pieces, planes, work)
            for i in range(n_rays):
                if work.rays[i].is_solid and not work.rays[i - 1 if i > 0 else n_rays - 1].is_solid:
                    if n_arcs == len(arcs):
                        return NO_ROOM
                    _write_arc(line, c, i, n_rays, n_spans, pieces, planes, work, arcs[n_arcs])
                    if arcs[n_arcs].kind == SMOOTH and not (arcs[n_arcs].is_border[0] or arcs[n_arcs].is_border[1]):
                        continue
                    if not is_continued(arcs, first_arc, n_arcs):
                        n_arcs += 1
    return n_arcs


@kernel
def _mark_done(pairs: IntArray, n_planes: int, work: FanWork, is_done: NDArray[np.bool_]) -> None:
    """Mark all pairs of the planes that hold a line."""
    for a in range(n_planes):
        if not work.holds_line[a]:
            continue
        for b in range(a + 1, n_planes):
            if work.holds_line[b]:
                low, high, key = 0, len(pairs), a * n_planes + b
                while low < high:
                    half = (low + high) // 2
                    if pairs[half] < key:
                        low = half + 1
                    else:
                        high = half
                if low < len(pairs) and pairs[low] == key:
                    is_done[low] = True


@kernel
def _find_rays(line: Line, at: float, n_spans: int, pieces: Pieces, planes: Rows[Plane], work: FanWork) -> int:
    """Write the rays around a place on a line in the order of their angles; return how many, 0 inside a piece."""
    n_rays = 0
    for s in range(n_spans):
        span = work.spans[s]
        if not span.start < at < span.end:
            continue
        if span.first_active == span.last_active:
            return 0
        for k in range(span.first_active, span.last_active):
            plane = pieces.faces[work.active[k]].plane
            is_new = True
            for i in range(n_rays):
                is_new = is_new and work.rays[i].plane != plane
            if is_new:
                way = cross(vector_from(planes[plane].normal), line.direction)
                for sense in (1.0, -1.0):
                    angle = math.atan2(sense * dot(way, line.second), sense * dot(way, line.first))
                    _put_in(plane, sense, angle, n_rays, work)
                    n_rays += 1
    for i in range(n_rays):
        between = _between(line, i, n_rays, work)
        work.rays[i].is_solid = False
        for s in range(n_spans):
            if work.spans[s].start < at < work.spans[s].end and _holds(work.spans[s], between, pieces, planes, work):
                work.rays[i].is_solid = True
    return n_rays


@kernel
def _put_in(plane: int, sense: float, angle: float, n_rays: int, work: FanWork) -> None:
    """Put a ray where its angle is in order."""
    k = n_rays
    while k > 0 and work.rays[k - 1].angle > angle:
        ray, before = work.rays[k], work.rays[k - 1]
        ray.plane, ray.sense, ray.angle = before.plane, before.sense, before.angle
        k -= 1
    ray = work.rays[k]
    ray.plane, ray.sense, ray.angle = plane, sense, angle


@kernel
def _between(line: Line, i: int, n_rays: int, work: FanWork) -> Vector:
    """Return the direction in the middle between a ray and the next one."""
    angle = work.rays[i].angle
    following = work.rays[i + 1].angle if i + 1 < n_rays else work.rays[0].angle + 2.0 * math.pi
    middle = 0.5 * (angle + following)
    return plus(scaled(line.first, math.cos(middle)), scaled(line.second, math.sin(middle)))


@kernel
def _holds(span: Span, direction: Vector, pieces: Pieces, planes: Rows[Plane], work: FanWork) -> bool:
    """Whether a piece has material beside a line, seen from it in a direction."""
    for k in range(span.first_active, span.last_active):
        if dot(outward(pieces.faces[work.active[k]], planes), direction) >= 0.0:
            return False
    return True


@kernel
def _write_arc(
    line: Line,
    c: int,
    first: int,
    n_rays: int,
    n_spans: int,
    pieces: Pieces,
    planes: Rows[Plane],
    work: FanWork,
    arc: Arc,
) -> None:
    """Write the run of material that begins at the ray ``first``, from a cut of the line to the next."""
    last, at = (first + 1) % n_rays, 0.5 * (work.cuts[c] + work.cuts[c + 1])
    while work.rays[last].is_solid:
        last = (last + 1) % n_rays
    start = plus(line.point, scaled(line.direction, work.cuts[c]))
    end = plus(line.point, scaled(line.direction, work.cuts[c + 1]))
    arc.slacks[0], arc.slacks[1] = work.slacks[c], work.slacks[c + 1]
    for k in range(3):
        arc.start[k], arc.end[k], arc.direction[k] = start[k], end[k], line.direction[k]
    for j in range(2):
        i, sign = (first, -1.0) if j == 0 else (last, 1.0)
        ray = work.rays[i]
        normal = vector_from(planes[ray.plane].normal)
        inward = scaled(cross(normal, line.direction), ray.sense)
        side = 1.0 if sign * dot(cross(line.direction, inward), normal) > 0.0 else -1.0
        part = _owner(line, at, i, n_rays, n_spans, pieces, planes, work)
        arc.planes[j], arc.sides[j], arc.parts[j] = ray.plane, side, part
        arc.is_border[j] = 1
        for o in range(n_rays):  # the other ray of the plane: the face goes on where material ends that begins here
            if o != i and work.rays[o].plane == ray.plane:
                before, after = work.rays[o - 1 if o > 0 else n_rays - 1].is_solid, work.rays[o].is_solid
                goes_on = before != after and after != ray.is_solid
                if goes_on and _owner(line, at, o, n_rays, n_spans, pieces, planes, work) == part:
                    arc.is_border[j] = 0
        for k in range(3):
            arc.inward[j, k], arc.normals[j, k] = inward[k], side * normal[k]
    turn = work.rays[last].angle - work.rays[first].angle
    if work.rays[first].plane == work.rays[last].plane:
        arc.kind = SMOOTH
    else:
        arc.kind = CONVEX if (turn if turn > 0.0 else turn + 2.0 * math.pi) < math.pi else CONCAVE


@kernel
def _owner(
    line: Line, at: float, i: int, n_rays: int, n_spans: int, pieces: Pieces, planes: Rows[Plane], work: FanWork
) -> int:
    """Return the first of the parts whose face lies in a ray where material begins or ends."""
    beside = i if work.rays[i].is_solid else (i - 1 if i > 0 else n_rays - 1)
    inside, owner = _between(line, beside, n_rays, work), -1
    for s in range(n_spans):
        span = work.spans[s]
        if not span.start < at < span.end or not _holds(span, inside, pieces, planes, work):
            continue
        has_face = False
        for k in range(span.first_active, span.last_active):
            has_face = has_face or pieces.faces[work.active[k]].plane == work.rays[i].plane
        part = pieces.pieces[span.piece].part
        if has_face and (owner < 0 or part < owner):
            owner = part
    return owner
