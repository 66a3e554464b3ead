"""The convex hull of points in space, as contact takes it: corners, edges, and flat faces with all their corners.

Points outside are added to a hull of triangles: of those that wait at one triangle, the farthest first. On which side
of a triangle a point lies is decided exactly, in whole numbers where rounding leaves it open, so that the triangles
always close up. Only then triangles that lie in one plane within `FLAT` are made one face. A corner that is left with
fewer than three faces lies within a face or an edge: it is no corner.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.vector import Vector
from cagepose.model.checks import FloatArray, unit_rows
from cagepose.model.near_pairs import near_pairs

FLAT = 1e-9
"""Points this close to a plane, a line or each other lie on it, as a fraction of the points' extent."""
THIN = 10.0 * FLAT
"""Points this close to a plane or a line span no more than that: faces of what is thicker are told apart."""
DECIDED = 64.0 * float(np.finfo(np.float64).eps)
"""Sides of a plane that floating point tells apart, as a fraction of the third power of the extent."""

_Triangle = tuple[int, int, int]


@dataclass(frozen=True, eq=False)
class Hull:
    """A convex hull, of points that span a volume, a polygon, a segment or a single point.

    Attributes
    ----------
    vertices_m
        Its corners, (n, 3), metres, in the order in which they were given.
    edges
        Index pairs of corners, (n_edges, 2).
    faces
        Loops of corner indices, counter-clockwise seen from outside. A polygon has two: one for each side.
    normals
        Unit outward normals of the faces, (n_faces, 3).
    """

    vertices_m: FloatArray
    edges: NDArray[np.int64]
    faces: tuple[tuple[int, ...], ...]
    normals: FloatArray

    @property
    def has_sides(self) -> bool:
        """Whether each face has sides that lead along it: not so of points some of which are 1e9 times as far away."""
        for face, normal in zip(self.faces, self.normals, strict=True):
            corners = self.vertices_m[list(face)]
            out = np.cross(np.roll(corners, -1, axis=0) - corners, normal)
            if len(face) < 3 or not (np.abs(out).max(axis=1) > 0.0).all():
                return False
        return True

    @property
    def dimension(self) -> int:
        """3 for a volume, 2 for a polygon, 1 for a segment, 0 for a point."""
        return 3 if len(self.faces) > 2 else len(self.faces) or len(self.edges)


def hull_of(vertices_m: FloatArray) -> Hull:
    """Return the convex hull of points (n, 3) in metres, n at least one; points that are no corners are left out.

    Those of the last few points are remembered: what changes from scene to scene is rarely a shape.
    """
    return _hull_of(np.ascontiguousarray(vertices_m, dtype=np.float64).tobytes())


@lru_cache(maxsize=64)
def _hull_of(numbers: bytes) -> Hull:
    points = np.frombuffer(numbers).reshape(-1, 3)
    extent = float(np.ptp(points, axis=0).max())
    kept = _distinct(points, FLAT * extent)
    points = points[kept]
    # A power of two as unit of length changes no digit, and third powers neither vanish nor overflow.
    scaled = (points - points[0]) / 2.0 ** float(np.frexp(extent)[1]) if extent > 0.0 else points - points[0]
    size = float(np.ptp(scaled, axis=0).max())
    tolerance = FLAT * size
    simplex = _simplex(scaled, THIN * size)
    if len(simplex) == 4:
        faces = _merged(scaled, _triangles(points, scaled, simplex), tolerance)
    elif len(simplex) == 3:
        loop = _polygon(scaled, simplex, tolerance)
        faces = [loop, loop[::-1]]
    else:
        faces = []
    corners = sorted({corner for face in faces for corner in face} or simplex)
    place = {corner: index for index, corner in enumerate(corners)}
    loops = tuple(tuple(place[corner] for corner in face) for face in faces)
    pairs = {(min(pair), max(pair)) for loop in loops for pair in zip(loop, loop[1:] + loop[:1], strict=True)}
    if len(simplex) == 2:
        pairs = {(0, 1)}
    hull = Hull(
        points[corners],
        np.array(sorted(pairs), dtype=np.int64).reshape(-1, 2),
        loops,
        _normals(np.array([_area_vector(scaled[face]) for face in faces]).reshape(-1, 3)),
    )
    for array in (hull.vertices_m, hull.edges, hull.normals):
        array.setflags(write=False)
    return hull


def _distinct(points: FloatArray, tolerance: float) -> list[int]:
    """Return the indices of the points, without those that lie on an earlier one."""
    first = np.sort(np.unique(points, axis=0, return_index=True)[1])
    is_kept = [True] * len(first)
    for earlier, later in near_pairs(points[first] - tolerance, points[first]).tolist():
        if is_kept[earlier]:
            is_kept[later] = False
    return [index for index, kept in zip(first.tolist(), is_kept, strict=True) if kept]


def _simplex(points: FloatArray, tolerance: float) -> list[int]:
    """Return up to four points that span all: each is the one farthest from what the ones before it span."""
    chosen = [int(np.argmax(np.linalg.norm(points - points.mean(axis=0), axis=1)))]
    rest = points - points[chosen[0]]
    for _ in range(3):
        distances = np.linalg.norm(rest, axis=1)
        farthest = int(np.argmax(distances))
        if distances[farthest] <= tolerance:
            break
        chosen.append(farthest)
        direction = rest[farthest] / distances[farthest]
        rest = rest - np.outer(rest @ direction, direction)
    return chosen


def _polygon(points: FloatArray, simplex: list[int], tolerance: float) -> list[int]:
    """Return the outline of points that lie in one plane (Andrew's monotone chain)."""
    origin, first, second = points[simplex]
    along, across = unit_rows(np.array([first - origin, second - origin]))
    normal = unit_rows(np.cross(along, across)[None])[0]
    flat = (points - origin) @ np.array([along, np.cross(normal, along)]).T
    order = np.lexsort((flat[:, 1], flat[:, 0])).tolist()

    def chain(run: list[int]) -> list[int]:
        built: list[int] = []
        for corner in run:
            while len(built) > 1 and _height(flat[built[-1]], flat[built[-2]], flat[corner]) <= tolerance:
                built.pop()
            built.append(corner)
        return built[:-1]

    return chain(order) + chain(order[::-1])


def _height(point: FloatArray, start: FloatArray, end: FloatArray) -> float:
    """How far a point lies to the right of a line, all in a plane."""
    along, arm = end - start, point - start
    length = float(np.hypot(*along))
    return float(arm[0] * along[1] - arm[1] * along[0]) / length if length > 0.0 else 0.0


def _triangles(points: FloatArray, scaled: FloatArray, simplex: list[int]) -> list[_Triangle]:
    """Return the triangles of the hull, counter-clockwise seen from outside (Barber, Dobkin and Huhdanpaa's quickhull).

    Each point that is still outside waits at one triangle that it sees; the farthest there comes next. All triangles
    that it sees hang together, and make way for new ones to their outline. What waited there sees one of these, or lies
    inside: a new triangle's plane leads through an edge between one that was seen and one that was not.
    """
    whole = _whole_numbers(points)
    a, b, c, d = simplex
    if _side(whole, (a, b, c), d) > 0:
        b, c = c, b
    outside = _Outside(scaled, whole)
    across: dict[tuple[int, int], _Triangle] = {}  # by its sides

    def add(new: list[_Triangle], waiting: NDArray[np.int64]) -> None:
        across.update({side: triangle for triangle in new for side in _sides(triangle)})
        outside.add(new, waiting)

    add([(a, b, c), (a, d, b), (b, d, c), (c, d, a)], np.setdiff1d(np.arange(len(scaled)), simplex))
    while (found := outside.farthest()) is not None:
        point, seed = found
        seen, reached, horizon = {seed}, [seed], []
        for triangle in reached:
            for start, end in _sides(triangle):
                beside = across[end, start]
                if beside in seen:
                    continue
                if outside.sees(beside, point):
                    seen.add(beside)
                    reached.append(beside)
                else:
                    horizon.append((start, end))
        waiting = outside.leave(reached)
        for triangle in reached:
            for side in _sides(triangle):
                del across[side]
        add([(start, end, point) for start, end in horizon], waiting[waiting != point])
    return list(dict.fromkeys(across.values()))


class _Outside:
    """The points outside of a hull that grows, each with a triangle that it sees."""

    def __init__(self, scaled: FloatArray, whole: list[tuple[int, int, int]]) -> None:
        self._scaled, self._whole = scaled, whole
        self._plane: dict[_Triangle, tuple[Vector, Vector]] = {}
        self._waiting: dict[_Triangle, tuple[NDArray[np.int64], int]] = {}

    def add(self, triangles: list[_Triangle], points: NDArray[np.int64]) -> None:
        """Add triangles, and let points wait where they see one; others lie inside."""
        corners = self._scaled[np.array(triangles)]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        starts = corners[:, 0]
        self._plane.update(zip(triangles, zip(starts.tolist(), normals.tolist(), strict=True), strict=True))
        for triangle, start, normal in zip(triangles, starts, normals, strict=True):
            if len(points) == 0:
                return
            heights = (self._scaled[points] - start) @ normal
            sees = heights > DECIDED
            for index in np.flatnonzero(np.abs(heights) <= DECIDED).tolist():
                sees[index] = _side(self._whole, triangle, int(points[index])) > 0
            if sees.any():
                here = points[sees]
                self._waiting[triangle] = here, int(here[np.argmax(heights[sees])])
                points = points[~sees]

    def farthest(self) -> tuple[int, _Triangle] | None:
        """Return a triangle at which points wait, and the farthest of these before it; None: all are inside."""
        triangle = next(iter(self._waiting), None)
        return None if triangle is None else (self._waiting[triangle][1], triangle)

    def sees(self, triangle: _Triangle, point: int) -> bool:
        """Whether a point lies outside of a triangle's plane, exactly."""
        start, normal = self._plane[triangle]
        x, y, z = self._scaled[point].tolist()
        height = (x - start[0]) * normal[0] + (y - start[1]) * normal[1] + (z - start[2]) * normal[2]
        return height > DECIDED or (height > -DECIDED and _side(self._whole, triangle, point) > 0)

    def leave(self, triangles: list[_Triangle]) -> NDArray[np.int64]:
        """Take triangles away; return the points that waited there."""
        for triangle in triangles:
            del self._plane[triangle]
        waiting = [self._waiting.pop(triangle)[0] for triangle in triangles if triangle in self._waiting]
        return np.sort(np.concatenate(waiting))


def _sides(triangle: _Triangle) -> list[tuple[int, int]]:
    return list(pairwise((*triangle, triangle[0])))


def _normal(points: FloatArray, triangle: _Triangle) -> FloatArray:
    a, b, c = points[list(triangle)]
    normal: FloatArray = np.cross(b - a, c - a)
    return normal


def _whole_numbers(points: FloatArray) -> list[tuple[int, int, int]]:
    """Return the points times one power of two that makes all their coordinates whole numbers."""
    ratios = [[float(value).as_integer_ratio() for value in point] for point in points]
    common = max(denominator for point in ratios for _, denominator in point)
    return [(*(top * (common // bottom) for top, bottom in point),) for point in ratios]  # type: ignore[misc]


def _side(whole: list[tuple[int, int, int]], triangle: _Triangle, point: int) -> int:
    """Return a number above zero where a point lies outside of a triangle's plane, exactly."""
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (whole[corner] for corner in triangle)
    px, py, pz = whole[point]
    ux, uy, uz, vx, vy, vz = bx - ax, by - ay, bz - az, cx - ax, cy - ay, cz - az
    return (uy * vz - uz * vy) * (px - ax) + (uz * vx - ux * vz) * (py - ay) + (ux * vy - uy * vx) * (pz - az)


def _merged(points: FloatArray, triangles: list[_Triangle], tolerance: float) -> list[list[int]]:
    """Make triangles that lie in one plane one face, and leave out what then is no corner."""
    normals = np.array([_normal(points, triangle) for triangle in triangles])
    areas = np.linalg.norm(normals, axis=1)
    across = {side: index for index, triangle in enumerate(triangles) for side in _sides(triangle)}
    face_of: dict[int, int] = {}
    n_faces = 0
    for seed in np.argsort(-areas, kind="stable").tolist():  # the greatest first: it tells its plane best
        if seed in face_of:
            continue
        face_of[seed] = n_faces
        origin, normal = points[triangles[seed][0]], normals[seed] / areas[seed]
        reached = [seed]
        for index in reached:
            for start, end in _sides(triangles[index]):
                beside = across[end, start]
                if beside in face_of:
                    continue
                if float(np.abs((points[list(triangles[beside])] - origin) @ normal).max()) <= tolerance:
                    face_of[beside] = n_faces
                    reached.append(beside)
        n_faces += 1
    faces_at: dict[int, set[int]] = {}
    following: list[dict[int, int]] = [{} for _ in range(n_faces)]
    for index, triangle in enumerate(triangles):
        for start, end in _sides(triangle):
            faces_at.setdefault(start, set()).add(face_of[index])
            if face_of[across[end, start]] != face_of[index]:
                following[face_of[index]][start] = end
    loops = []
    for outline in following:
        loop = [next(iter(outline))]
        while len(loop) <= len(outline) and (corner := outline[loop[-1]]) != loop[0]:
            loop.append(corner)
        is_closed = len(loop) <= len(outline)  # the outline of a face that is as thin as what is flat may cross itself
        corners = [corner for corner in loop if len(faces_at[corner]) > 2] if is_closed else []
        loops.append(corners or loop[:1])
    return loops


def _normals(areas: FloatArray) -> FloatArray:
    """Return unit vectors along those given, (n, 3); of a face without an area, zero."""
    normals, has_area = np.zeros_like(areas), areas.any(axis=1)
    if has_area.any():
        normals[has_area] = unit_rows(areas[has_area])
    return normals


def _area_vector(loop: FloatArray) -> FloatArray:
    """Return twice the area of a flat loop, along its normal."""
    arms = loop[1:] - loop[0]
    total: FloatArray = np.cross(arms[:-1], arms[1:]).sum(axis=0)
    return total
