"""A closed surface of triangles as a shape: `Facets`. The body within need not be convex."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from hashlib import sha256
from typing import Annotated, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cagepose.errors import Key
from cagepose.model.checks import FloatArray, ProblemList, finite_array
from cagepose.model.near_pairs import near_pairs
from cagepose.model.pose import Pose
from cagepose.model.shapes import Shape, set_lengths, worked_out_once
from cagepose.model.sides import IntArray, open_sides
from cagepose.model.surfaces import Surface, check_on_surfaces, checked_surfaces
from cagepose.model.tolerances import DISTANCE_OUTSIDE

FLAT = 1e-9
"""Fraction of the size. Corners this near to a plane lie in it, where nothing else is told."""
FLATTEST = 1e-3
"""Fraction of the size. What is flat may not be told as more."""
AWAY = np.array((0.4127, 0.5309, 0.7401))
"""A direction along which few sides and edges of ordinary parts lie: rays lead there."""
ON_SIDE = 1e-9
"""Of the size of a triangle. A line that is as near to its sides meets it."""


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Facets(Shape):
    """A body within a closed surface of triangles; it need not be convex, or hang together.

    Triangles that lie in one plane are one face of it. It touches as it is, but for those triangles that are told to
    stand for a plane, a cylinder, a cone, a sphere or a torus: there it touches as that does, and its edges are the
    curves in which such surfaces meet.

    Attributes
    ----------
    vertices_m
        Corners in the shape's own frame, (n, 3), metres.
    triangles
        Indices of the corners of each triangle, counter-clockwise seen from outside, (m, 3).
    flat_m
        Corners this near to the plane of a face, or to a surface, lie in it, metres.
    surfaces
        That triangles stand for.
    on
        Which of the surfaces each triangle stands for, (m,); -1: none.
    """

    kind: ClassVar[str] = "facets"
    is_convex: ClassVar[bool] = False
    vertices_m: Annotated[FloatArray, (-1, 3)]
    triangles: Annotated[IntArray, (-1, 3)]
    flat_m: float
    surfaces: tuple[Surface, ...]
    on: Annotated[IntArray, (-1,)]

    def __init__(
        self,
        vertices_m: ArrayLike,
        triangles: ArrayLike,
        flat_m: float | None = None,
        pose_body_shape: Pose | None = None,
        name: str | None = None,
        surfaces: Sequence[Surface] = (),
        on: ArrayLike = (),
    ) -> None:
        """
        Parameters
        ----------
        flat_m
            None: a thousand-millionth of the size.
        on
            Without surfaces it need not be given.

        Raises
        ------
        SceneError
            Vertices that are not n x 3 finite numbers, triangles that are not m x 3 of their indices or do not close up
            around a volume, or a length that is not below a thousandth of the size.
        """
        problems = ProblemList()
        vertices = finite_array(vertices_m, (-1, 3), "vertices") + 0.0  # no zero below zero
        vertices.setflags(write=False)
        corners = _indices(triangles, len(vertices), problems)
        size = float(np.ptp(vertices, axis=0).max(initial=0.0))
        set_lengths(self, problems, flat=FLAT * size if flat_m is None else flat_m)
        if not problems.problems:
            _check_closed(vertices, corners, problems)
            if self.flat_m > FLATTEST * size:
                found = f"is {self.flat_m:.3g} m, more than a thousandth of the size"
                problems.add(("flat",), f"{found}; give how far corners are off the planes of their faces")
        object.__setattr__(self, "surfaces", ())
        if not problems.problems:
            known, of = checked_surfaces(surfaces, on, len(corners), problems)
            if not problems.problems:
                check_on_surfaces(vertices[corners], known, of, self.flat_m, problems)
            object.__setattr__(self, "surfaces", known)
            object.__setattr__(self, "on", of)
        object.__setattr__(self, "vertices_m", vertices)
        object.__setattr__(self, "triangles", corners)
        self._place(pose_body_shape, name, problems)

    def _measures(self) -> str:
        return f"{len(self.triangles)} triangles"

    @property
    def form(self) -> tuple[object, ...]:
        return self.kind, self._digest, self.flat_m, self.surfaces, self.on.tobytes()

    @cached_property
    def _digest(self) -> bytes:
        return sha256(self.vertices_m.tobytes() + self.triangles.tobytes()).digest()

    @property
    def is_round(self) -> bool:
        """Whether some triangles stand for what is round."""
        return any(surface.is_round for surface in self.surfaces)

    @worked_out_once
    def nodes_body(self) -> FloatArray:
        return self.pose_body_shape.transform(self.vertices_m)

    def farthest_m(self, point_body: FloatArray) -> float:
        return float(np.linalg.norm(self.nodes_body() - point_body, axis=1).max())

    def reach_m(self, point_body: FloatArray, direction_body: FloatArray) -> float:
        """Return how far it is from a point of the body's frame, on the surface or within, along a unit vector to where
        that leaves the body, metres; zero: it does not go in there.
        """
        point = self.pose_body_shape.inverse_transform(point_body)
        way = self.pose_body_shape.rotation.T @ direction_body
        met = _crossed(point[None], way, self.vertices_m[self.triangles], ON_SIDE)
        leaves = (met.slopes > 0.0) & met.is_met & (met.ahead_m > ON_SIDE * float(np.ptp(self.vertices_m)))
        return float(met.ahead_m[leaves].min(initial=np.inf)) if leaves.any() else 0.0

    def holds(self, points_body: FloatArray) -> NDArray[np.bool_]:
        points = self.pose_body_shape.inverse_transform(points_body)
        corners = self.vertices_m[self.triangles]
        slack = DISTANCE_OUTSIDE * float(np.ptp(self.vertices_m, axis=0).max())
        across = np.linalg.svd(AWAY[None])[2][1:].T  # seen along rays, few triangles are where a point is
        seen, seen_corners = (np.insert(places @ across, 2, 0.0, axis=-1) for places in (points, corners))
        point, triangle = _pairs(seen, seen_corners, 0.0)
        met = _crossed(points[point], AWAY, corners[triangle], 0.0)
        n_left = np.bincount(point, np.where(met.is_met & (met.ahead_m > 0.0), np.sign(met.slopes), 0.0), len(points))
        within: NDArray[np.bool_] = n_left > 0.5
        point, triangle = _pairs(points, corners, slack)
        within[point[_distances(points[point], corners[triangle]) <= slack]] = True
        return within

    def thickness(self) -> list[tuple[tuple[Key, ...], float]]:
        return [(("vertices",), float(np.ptp(self.vertices_m, axis=0).min()))]


def _indices(triangles: ArrayLike, n_vertices: int, problems: ProblemList) -> IntArray:
    """Return triangles as an array that cannot be written to; note what are none."""
    given = np.asarray(triangles)
    if given.ndim != 2 or given.shape[1] != 3 or len(given) == 0 or given.dtype.kind not in "iu":
        problems.add(("triangles",), "is no list of three indices each; give those of the corners of each triangle")
        return np.zeros((0, 3), np.int64)
    found = np.array(given, np.int64)
    if found.min() < 0 or found.max() >= n_vertices:
        problems.add(("triangles",), f"has indices that are not 0 to {n_vertices - 1}; give those of vertices alone")
    elif (found == np.roll(found, 1, axis=1)).any():
        problems.add(("triangles",), "has a triangle with the same corner twice; leave it out")
    found.setflags(write=False)
    return found


def _check_closed(vertices: FloatArray, triangles: IntArray, problems: ProblemList) -> None:
    """Note a surface that is open, or inside out."""
    if n_open := len(open_sides(triangles)):
        found = f"do not close up: {n_open} of their sides have no triangle beyond them"
        problems.add(("triangles",), f"{found}; give a closed surface")
        return
    a, b, c = np.moveaxis(vertices[triangles] - vertices[0], 1, 0)
    if float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum()) <= 0.0:
        problems.add(("triangles",), "enclose no volume, or face inwards; give corners counter-clockwise from outside")


def _pairs(points: FloatArray, corners: FloatArray, within_m: float) -> tuple[IntArray, IntArray]:
    """Return which points are near the boxes around which triangles."""
    low, high = corners.min(axis=1) - within_m, corners.max(axis=1) + within_m
    boxes = np.concatenate([points, low]), np.concatenate([points, high])
    pairs = near_pairs(*boxes, between=len(points)).astype(np.int64)
    return pairs[:, 0], pairs[:, 1] - len(points)


class _Crossed(NamedTuple):
    """Whether rays cross triangles, how far ahead, and a number above zero where they leave the body there, (n,)."""

    is_met: NDArray[np.bool_]
    ahead_m: FloatArray
    slopes: FloatArray


def _crossed(points: FloatArray, way: FloatArray, corners: FloatArray, beside: float) -> _Crossed:
    """Ask rays along a vector, each of one triangle; it is met, too, by as much of its size beside it (Moeller and
    Trumbore).
    """
    arms, one, other = points - corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    across = np.cross(way, other)
    volumes = np.einsum("ij,ij->i", one, across)
    with np.errstate(divide="ignore", invalid="ignore"):
        first = np.einsum("ij,ij->i", arms, across) / volumes
        turned = np.cross(arms, one)
        second, ahead_m = turned @ way / volumes, np.einsum("ij,ij->i", turned, other) / volumes
        is_met = (first >= -beside) & (second >= -beside) & (first + second <= 1.0 + beside)
    return _Crossed(is_met, ahead_m, -volumes)


def _distances(points: FloatArray, corners: FloatArray) -> FloatArray:
    """Return how far points are from triangles, one each: of those over it, above its plane; of others, from its sides;
    (n,), metres.
    """
    arms, one, other = points - corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normals = np.cross(one, other)
    squares = np.maximum(np.einsum("ij,ij->i", normals, normals), np.finfo(float).tiny)
    first = np.einsum("ij,ij->i", np.cross(arms, other), normals) / squares
    second = np.einsum("ij,ij->i", np.cross(one, arms), normals) / squares
    is_over = (first >= 0.0) & (second >= 0.0) & (first + second <= 1.0)
    above = np.abs(np.einsum("ij,ij->i", arms, normals)) / np.sqrt(squares)
    sides = np.full(len(arms), np.inf)
    for start, way in ((np.zeros_like(one), one), (np.zeros_like(one), other), (one, other - one)):
        seen = arms - start
        share = np.einsum("ij,ij->i", seen, way) / np.maximum(np.einsum("ij,ij->i", way, way), np.finfo(float).tiny)
        sides = np.minimum(sides, np.linalg.norm(seen - np.clip(share, 0.0, 1.0)[:, None] * way, axis=1))
    distances: FloatArray = np.where(is_over, above, sides)
    return distances
