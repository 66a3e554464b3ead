"""How a convex part rolls on a level plane without friction, slowly: its flat rests, and the orientations that lead to
each, exactly.

Down is a unit vector n in the part's frame, and the centre of gravity stands at the height h(n), the greatest n.r of
all corners r from it. The part turns as h falls fastest. While one corner r touches, n goes along a great circle away
from r; those n, the cell of r, have as sides the arcs on which two corners touch. If the foot of the centre of gravity
on the edge between these two lies between them, then n comes from both sides and goes on along the arc, away from that
foot, to the normal of a face. Else n crosses the arc, always into the cell of the nearer corner. So what becomes of all
n on the arcs of a cell follows from that of nearer corners, and areas on the sphere are sums of triangles.
"""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from operator import itemgetter
from typing import NamedTuple

import numpy as np

from cagepose.kernels.algebra.vector import cross
from cagepose.model.checks import FloatArray, as_vector, unit_rows
from cagepose.model.hull import Hull
from cagepose.questions.drains import Pass, Shares, drained

ON_EDGE = 1e-9
"""Of the part's size. A foot so little outside of a face counts as on its edge."""


@dataclass(frozen=True, eq=False)
class Rest:
    """Where the part comes to rest.

    Attributes
    ----------
    faces
        Of the hull: one, or several that stand for one round place.
    area
        Of the orientations that lead there, on the unit sphere.
    """

    faces: tuple[int, ...]
    area: float


@dataclass(frozen=True, eq=False)
class Rolling:
    """All rests, and all ways to tip from one directly to another one."""

    rests: tuple[Rest, ...]
    passes: tuple[Pass, ...]


class _Arc(NamedTuple):
    """The downs at which two corners touch, cut into pieces: points (n + 1, 3) and the face that each leads to next."""

    points: list[FloatArray]
    leads_to: list[int]

    def reversed(self) -> _Arc:
        return _Arc(self.points[::-1], self.leads_to[::-1])


class _WayOut(NamedTuple):
    """A piece of a side by which downs leave a cell: its least azimuth, the point there, and the face it leads to."""

    azimuth: float
    point: FloatArray
    leads_to: int


def _at(out: Sequence[_WayOut], azimuth: float) -> int:
    """Return the face that downs at an azimuth lead to, of pieces in turn."""
    return out[max(bisect_right(out, azimuth, key=itemgetter(0)) - 1, 0)].leads_to


HeightsOf = Callable[[FloatArray], FloatArray]


def rolling(hull: Hull, center_m: FloatArray, heights_of: HeightsOf | None = None) -> Rolling:
    """Return how a hull with a volume rolls whose centre of gravity, (3,), lies inside it.

    Parameters
    ----------
    heights_of
        How high the centre of gravity stands while units vectors (n, 3) point down, (n,), metres, if the hull stands
        for something round: faces with no higher place between them are one rest. None: the hull is as it is.
    """
    return _Roller(hull, center_m, heights_of).rolled()


class _Roller:
    def __init__(self, hull: Hull, center_m: FloatArray, heights_of: HeightsOf | None) -> None:
        self._corners = hull.vertices_m - center_m
        self._loops, self._normals = hull.faces, hull.normals
        self._heights_of = heights_of
        self._size_m = float(np.linalg.norm(self._corners, axis=1).max())
        self._face_of = {
            side: face for face, loop in enumerate(hull.faces) for side in zip(loop, loop[1:] + loop[:1], strict=True)
        }
        # Around each corner, the corners before it in each loop: across these sides lie the arcs of its cell.
        self._around: list[list[int]] = [[] for _ in hull.vertices_m]
        for start, end in self._face_of:
            self._around[end].append(start)
        self._arcs: dict[tuple[int, int], _Arc] = {}
        self._tops: list[Pass] = []
        self._same_as = list(range(len(hull.faces)))

    def rolled(self) -> Rolling:
        for side in self._face_of:
            if side not in self._arcs and self._is_kept(*side):
                self._set_arc(side, self._kept_arc(*side))
        is_stable = [self._is_stable(face) for face in range(len(self._loops))]
        self._join([face if stable else None for face, stable in enumerate(is_stable)])
        for corner in np.argsort(np.linalg.norm(self._corners, axis=1), kind="stable").tolist():
            entered = [other for other in self._around[corner] if self._enters(other, corner)]
            if entered:
                out = self._ways_out(corner)
                for other in entered:
                    self._set_arc((other, corner), self._crossed_arc(other, corner, out))
        following = [face if stable else self._next(face) for face, stable in enumerate(is_stable)]
        at_end = _ends(following)
        self._join(at_end)
        ends = [self._same(face) for face in at_end]
        shares, passes = self._drained(ends)
        rests = sorted({face for end in set(ends) for face in shares.get(end, {end: 1.0})})
        numbers = {face: number for number, face in enumerate(rests)}
        totals = np.zeros(len(rests))
        for end, area in zip(ends, self._areas().tolist(), strict=True):
            for face, share in shares.get(end, {end: 1.0}).items():
                totals[numbers[face]] += share * area
        alike = [tuple(face for face in np.flatnonzero(is_stable).tolist() if ends[face] == rest) for rest in rests]
        return Rolling(
            tuple(Rest(faces, area) for faces, area in zip(alike, totals.tolist(), strict=True)),
            tuple(top._replace(between=(numbers[top.between[0]], numbers[top.between[1]])) for top in passes),
        )

    def _drained(self, ends: Sequence[int]) -> tuple[Shares, list[Pass]]:
        """Return which faces those where faces end lead to in turn, and the ways to tip between these."""
        between = [top._replace(between=(ends[top.between[0]], ends[top.between[1]])) for top in self._tops]
        tops = [top for top in between if top.between[0] != top.between[1]]
        if self._heights_of is None:
            return {}, tops
        return drained(self._normals, tops, self._heights_of, ON_EDGE * self._size_m)

    def _areas(self) -> FloatArray:
        """Return the areas that lead to each face first, (n_faces,): of triangles between a corner and its arcs, below
        zero if clockwise (van Oosterom and Strackee).
        """
        pieces = [
            (corner, start, end, face)
            for (_, corner), arc in self._arcs.items()
            for start, end, face in zip(arc.points[:-1], arc.points[1:], arc.leads_to, strict=True)
        ]
        corners, first, last, faces = zip(*pieces, strict=True)
        axes, starts, ends = unit_rows(self._corners[list(corners)]), np.array(first), np.array(last)
        volumes = np.einsum("ij,ij->i", axes, np.cross(starts, ends))
        cosines = [np.einsum("ij,ij->i", *pair) for pair in ((axes, starts), (starts, ends), (ends, axes))]
        of_pieces = 2.0 * np.arctan2(volumes, 1.0 + sum(cosines))
        areas: FloatArray = np.zeros(len(self._loops))
        np.add.at(areas, list(faces), of_pieces)
        return areas

    def _join(self, ends: Sequence[int | None]) -> None:
        """Make those rests one that are level with all between them. Where faces end may not be known of all yet."""
        if self._heights_of is None or not self._tops:
            return
        level_m = ON_EDGE * self._size_m
        heights = self._heights_of(self._normals)
        tops = self._heights_of(np.array([top.down for top in self._tops])).tolist()
        self._tops = [top._replace(height_m=height_m) for top, height_m in zip(self._tops, tops, strict=True)]
        for top in self._tops:
            one, other = (ends[face] for face in top.between)
            if one is None or other is None:
                continue
            if abs(heights[one] - heights[other]) <= level_m and top.height_m <= heights[one] + level_m:
                first, second = sorted((self._same(one), self._same(other)))
                self._same_as[second] = first
        for arc in self._arcs.values():
            arc.leads_to[:] = [self._same(face) for face in arc.leads_to]

    def _same(self, face: int) -> int:
        while self._same_as[face] != face:
            face = self._same_as[face]
        return face

    def _set_arc(self, side: tuple[int, int], arc: _Arc) -> None:
        """An arc belongs to the cells of both its corners; each sees it with the cell to the left."""
        self._arcs[side], self._arcs[side[::-1]] = arc, arc.reversed()

    def _is_kept(self, one: int, other: int) -> bool:
        """Whether the part goes on about an edge: the foot of the centre of gravity lies between its two corners."""
        way = self._corners[other] - self._corners[one]
        return float(self._corners[one] @ way) <= 0.0 <= float(self._corners[other] @ way)

    def _enters(self, other: int, corner: int) -> bool:
        """Whether downs cross from the cell of the one corner into that of the other: they leave the farther one."""
        if self._is_kept(other, corner):
            return False
        way = self._corners[corner] - self._corners[other]
        return float((self._corners[corner] + self._corners[other]) @ way) < 0.0

    def _ends_of(self, other: int, corner: int) -> tuple[int, int]:
        """Return the faces beside an edge, as the cell of the second corner has them in turn."""
        return self._face_of[other, corner], self._face_of[corner, other]

    def _kept_arc(self, other: int, corner: int) -> _Arc:
        first, last = self._ends_of(other, corner)
        way = self._corners[corner] - self._corners[other]
        foot = self._corners[other] - way * float(self._corners[other] @ way) / float(way @ way)
        start, end = self._normals[first], self._normals[last]
        across = _cross(start, end)
        down = foot / np.linalg.norm(foot)
        after, before = float(across @ _cross(start, down)), float(across @ _cross(down, end))
        top = start if after <= 0.0 else end if before <= 0.0 else down
        self._tops.append(Pass((first, last), top, float(self._corners[corner] @ top)))
        if after > 0.0 and before > 0.0:
            return _Arc([start, down, end], [first, last])
        return _Arc([start, end], [last if after <= 0.0 else first])

    def _crossed_arc(self, other: int, corner: int, out: list[_WayOut]) -> _Arc:
        """Return the arc of a side by which downs come into a cell: each goes on to another side of it."""
        first, last = self._ends_of(other, corner)
        start, end = self._normals[first], self._normals[last]
        across, middle = _cross(start, end), start + end
        highest, lowest = self._azimuths(corner, np.array([start, end])).tolist()
        points, leads_to = [start], [_at(out, highest)]
        last_before = bisect_left(out, highest, key=itemgetter(0)) - 1
        for way, before in zip(out[last_before:0:-1], out[last_before - 1 :: -1], strict=False):
            if way.azimuth <= lowest:
                break
            if before.leads_to != leads_to[-1]:
                met = _cross(across, _cross(self._corners[corner], way.point))
                points.append(met * (math.copysign(1.0, float(met @ middle)) / float(np.linalg.norm(met))))
                leads_to.append(before.leads_to)
        return _Arc([*points, end], leads_to)

    def _ways_out(self, corner: int) -> list[_WayOut]:
        """Return the pieces of the sides by which downs leave a cell, in turn."""
        found = []
        for other in self._around[corner]:
            if self._enters(other, corner):
                continue
            arc = self._arcs[other, corner]
            azimuths = self._azimuths(corner, np.array(arc.points[:-1])).tolist()
            found += [_WayOut(*way) for way in zip(azimuths, arc.points[:-1], arc.leads_to, strict=True)]
        return sorted(found, key=itemgetter(0))

    def _azimuths(self, corner: int, downs: FloatArray) -> FloatArray:
        """Return the angles of downs about a corner's own direction, from the middle of its cell, (n,)."""
        axis = self._corners[corner] / np.linalg.norm(self._corners[corner])
        middle = self._normals[[self._face_of[other, corner] for other in self._around[corner]]].sum(axis=0)
        ahead = middle - axis * float(middle @ axis)
        ahead /= max(float(np.linalg.norm(ahead)), np.finfo(float).tiny)
        found: FloatArray = np.arctan2(downs @ _cross(axis, ahead), downs @ ahead)
        return found

    def _is_stable(self, face: int) -> bool:
        """Whether the foot of the centre of gravity lies on a face."""
        normal, corners = self._normals[face], self._corners[list(self._loops[face])]
        sides = unit_rows(np.roll(corners, -1, axis=0) - corners)
        inside = np.einsum("ij,ij->i", np.cross(normal, sides), -corners)
        return bool(inside.min() >= -ON_EDGE * self._size_m)

    def _next(self, face: int) -> int:
        """Return the face that the part goes to from one that is not stable: over what is nearest to the foot."""
        loop, normal = self._loops[face], self._normals[face]
        corners = self._corners[list(loop)]
        ways = np.roll(corners, -1, axis=0) - corners
        shares = np.clip(np.einsum("ij,ij->i", -corners, ways) / np.einsum("ij,ij->i", ways, ways), 0.0, 1.0)
        places = corners + shares[:, None] * ways
        nearest = int(np.argmin(np.linalg.norm(places - np.outer(places @ normal, normal), axis=1)))
        one, other = loop[nearest], loop[(nearest + 1) % len(loop)]
        if 0.0 < shares[nearest] < 1.0:
            return self._face_of[other, one]
        corner = one if shares[nearest] == 0.0 else other
        return _at(self._ways_out(corner), float(self._azimuths(corner, normal[None])[0]))


def _ends(following: list[int]) -> list[int]:
    """Return where each leads at last, following each to the next."""
    ends = list(range(len(following)))
    for _ in ends:
        further = [following[face] for face in ends]
        if further == ends:
            break
        ends = further
    return ends


def _cross(one: FloatArray, other: FloatArray) -> FloatArray:
    """Return the product of two vectors (3,): NumPy's own takes ten times as long of so few numbers."""
    return np.array(cross(as_vector(one), as_vector(other)))
