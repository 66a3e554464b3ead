"""Volume, centroid and second moments of one shape, in closed form.

A rounded hull is cut into what lies above each of its features (Steiner): the hull itself, a prism on each face, a
sector of a round bar along each edge, a sector of a ball on each corner. Over the directions of such sectors the means
of n and n n^T are needed, n a unit vector. On a sphere both follow from the sector's outline, as n and n n^T - 1/3 are
harmonic: by the divergence theorem, the integral of a harmonic f of degree k is minus that of its slope across the
outline by k (k + 1).
"""

from __future__ import annotations

import math
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from cagepose.model.box import Box
from cagepose.model.checks import FloatArray, unit_rows
from cagepose.model.facets import Facets
from cagepose.model.finer import beside_round, finer
from cagepose.model.hull import Hull
from cagepose.model.shapes import Convex, Rounded, Shape, Turned
from cagepose.model.surface import LEAST_SEGMENTS, Mesh, mesh_in_own_frame
from cagepose.model.volume import VolumeMoments

MOST_HALVINGS, MOST_TRIANGLES = 3, 250_000
"""Of the sides of triangles that stand for what is round, as long as there are no more triangles then."""


class Sums(NamedTuple):
    """Integrals over a body: of 1, of x, (3,), and of x x^T, (3, 3); x is seen from a point that all sums share."""

    volume: float
    first: FloatArray
    second: FloatArray

    def __add__(self, other: Sums) -> Sums:  # type: ignore[override]
        return Sums(self.volume + other.volume, self.first + other.first, self.second + other.second)

    def times(self, factor: float) -> Sums:
        return Sums(factor * self.volume, factor * self.first, factor * self.second)

    def moments(self, origin: FloatArray) -> VolumeMoments:
        """Return the moments of the body, ``origin`` being the point that x is seen from."""
        middle = self.first / self.volume
        second = self.second / self.volume - np.outer(middle, middle)
        return VolumeMoments(self.volume, origin + middle, (second + second.T) / 2.0)


NOTHING = Sums(0.0, np.zeros(3), np.zeros((3, 3)))


def sums_of(moments: VolumeMoments, origin: FloatArray) -> Sums:
    """Return the integrals of a body whose moments are known, seen from ``origin``."""
    arm = moments.centroid_m - origin
    volume = moments.volume_m3
    return Sums(volume, volume * arm, volume * (moments.second_moment_m2 + np.outer(arm, arm)))


def shape_moments(shape: Shape) -> VolumeMoments:
    """Return the moments of a shape in its body's frame, exact but for rounding.

    Of a disc all are zero, but for its middle.
    """
    if isinstance(shape, Box):
        own = VolumeMoments(float(shape.size_m.prod()), np.zeros(3), np.diag(shape.size_m**2 / 12.0))
    elif isinstance(shape, Facets):
        own = _facets_moments(shape)
    elif isinstance(shape, Turned):
        own = _turned_moments(shape)
    elif isinstance(shape, Convex) and shape.hull.dimension > 1:
        own = _rounded_moments(shape.hull, shape.radius_m)
    elif isinstance(shape, Rounded):
        own = _capsule_moments(shape.core(), shape.radius_m)
    else:
        raise TypeError(f"{type(shape).__name__} has no volume")
    pose = shape.pose_body_shape
    turn = pose.rotation
    return VolumeMoments(own.volume_m3, pose.transform(own.centroid_m), turn @ own.second_moment_m2 @ turn.T)


def mesh_sums(mesh: Mesh, origin: FloatArray) -> Sums:
    """Return the integrals over the body within a mesh, seen from ``origin``: of tetrahedra over its triangles."""
    a, b, c = np.moveaxis(mesh.vertices_m[mesh.triangles] - origin, 1, 0)
    volumes = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0
    total = a + b + c
    second = sum(np.einsum("i,ij,ik->jk", volumes, point, point) for point in (a, b, c, total)) / 20.0
    return Sums(float(volumes.sum()), volumes @ total / 4.0, second)


def _facets_moments(shape: Facets) -> VolumeMoments:
    """Of triangles that stand for what is round, by halving their sides, and extrapolating to where these are zero:
    what is left out falls with the square of their length (Richardson; Romberg).
    """
    origin = shape.vertices_m.mean(axis=0)
    mesh, on = mesh_in_own_frame(shape, LEAST_SEGMENTS), shape.on
    is_curved = beside_round(mesh.triangles, shape.surfaces, on)
    flat = mesh_sums(Mesh(mesh.vertices_m, mesh.triangles[~is_curved]), origin)
    mesh, on = Mesh(mesh.vertices_m, mesh.triangles[is_curved]), on[is_curved]
    rows = [mesh_sums(mesh, origin)]
    while rows[-1].volume != 0.0 and len(rows) <= MOST_HALVINGS and 4 * len(mesh.triangles) <= MOST_TRIANGLES:
        vertices, triangles, on = finer(mesh.vertices_m, mesh.triangles, shape.surfaces, on)
        mesh = Mesh(vertices, triangles)
        rows.append(mesh_sums(mesh, origin))
    for order in range(1, len(rows)):
        share = 1.0 / (4.0**order - 1.0)
        rows = [fine.times(1.0 + share) + coarse.times(-share) for coarse, fine in pairwise(rows)]
    return (flat + rows[0]).moments(origin)


def _turned_moments(shape: Turned) -> VolumeMoments:
    if len(shape.rims) == 1:
        return VolumeMoments(0.0, np.zeros(3), np.zeros((3, 3)))
    frusta = [_frustum_moments(*rims) for rims in pairwise(shape.rims)]
    if len(frusta) == 1:
        return frusta[0]
    origin = frusta[0].centroid_m
    return sum((sums_of(frustum, origin) for frustum in frusta), start=NOTHING).moments(origin)


def _frustum_moments(bottom: tuple[float, float], top: tuple[float, float]) -> VolumeMoments:
    """Integrals of powers of a radius that changes linearly from a to b."""
    (low, a), (high, b) = bottom, top
    length = high - low
    area = (a * a + a * b + b * b) / 3.0  # the mean of the square of the radius
    middle = (a * a + 2.0 * a * b + 3.0 * b * b) / 12.0 / area  # as a fraction of the length
    along = (a * a + 3.0 * a * b + 6.0 * b * b) / 30.0 / area - middle * middle
    across = (a**4 + a**3 * b + a * a * b * b + a * b**3 + b**4) / 20.0 / area
    return VolumeMoments(
        math.pi * area * length,
        np.array((0.0, 0.0, low + middle * length)),
        np.diag((across, across, along * length * length)),
    )


def _capsule_moments(core: FloatArray, radius: float) -> VolumeMoments:
    """A sphere about one point, or a capsule between two."""
    span = core[-1] - core[0]
    length = float(np.linalg.norm(span))
    axis = span / length if length > 0.0 else np.array((0.0, 0.0, 1.0))
    bar, ball = math.pi * radius**2 * length, 4.0 / 3.0 * math.pi * radius**3
    across = bar * radius**2 / 4.0 + ball * radius**2 / 5.0
    # Each half of the ball has its middle 3/8 of the radius beyond an end of the bar.
    along = bar * length**2 / 12.0 + ball * (radius**2 / 5.0 + length**2 / 4.0 + 3.0 / 8.0 * length * radius)
    second = across * np.eye(3) + (along - across) * np.outer(axis, axis)
    return VolumeMoments(bar + ball, core.mean(axis=0), second / (bar + ball))


@lru_cache(maxsize=64)
def _rounded_moments(hull: Hull, radius: float) -> VolumeMoments:
    """A volume or a polygon, blown up."""
    origin = hull.vertices_m.mean(axis=0)
    corners = hull.vertices_m - origin
    total = NOTHING
    corner_angles = np.zeros(len(corners))
    for loop, normal in zip(hull.faces, hull.normals, strict=True):
        face = corners[list(loop)]
        area, first, second = _polygon_sums(face, normal)
        if len(hull.faces) > 2:
            height = float(normal @ face[0])  # the cone between the face and the origin
            total += Sums(height * area / 3.0, height * first / 4.0, height * second / 5.0)
        mixed = np.outer(first, normal)
        total += Sums(
            area * radius,
            first * radius + area * normal * radius**2 / 2.0,
            second * radius + (mixed + mixed.T) * radius**2 / 2.0 + area * np.outer(normal, normal) * radius**3 / 3.0,
        )
        sides = unit_rows(np.roll(face, -1, axis=0) - face)
        cosines = -np.einsum("ij,ij->i", sides, np.roll(sides, 1, axis=0))
        sines = np.linalg.norm(np.cross(sides, np.roll(sides, 1, axis=0)), axis=1)
        np.add.at(corner_angles, list(loop), np.arctan2(sines, cosines))
    solid_angles = 2.0 * math.pi - corner_angles
    firsts = np.zeros((len(corners), 3))
    seconds = solid_angles[:, None, None] / 3.0 * np.eye(3)
    for edge in _edges(hull):
        total += edge.sums(corners, radius)
        for corner, outwards in ((edge.start, edge.along), (edge.end, -edge.along)):
            slope = np.outer(outwards, edge.mean)
            firsts[corner] -= edge.angle * outwards / 2.0
            seconds[corner] -= (slope + slope.T) / 6.0
    for corner, solid_angle, first, second in zip(corners, solid_angles.tolist(), firsts, seconds, strict=True):
        mixed = np.outer(corner, first)
        total += Sums(
            solid_angle * radius**3 / 3.0,
            solid_angle * radius**3 / 3.0 * corner + first * radius**4 / 4.0,
            solid_angle * radius**3 / 3.0 * np.outer(corner, corner)
            + (mixed + mixed.T) * radius**4 / 4.0
            + second * radius**5 / 5.0,
        )
    return total.moments(origin)


def _polygon_sums(loop: FloatArray, normal: FloatArray) -> tuple[float, FloatArray, FloatArray]:
    """Return the integrals of 1, x and x x^T over a flat polygon, from its triangles."""
    a, b, c = np.broadcast_to(loop[0], loop[2:].shape), loop[1:-1], loop[2:]
    areas = np.cross(b - a, c - a) @ normal / 2.0
    total = a + b + c
    second = sum(np.einsum("i,ij,ik->jk", areas, point, point) for point in (a, b, c, total)) / 12.0
    return float(areas.sum()), areas @ total / 3.0, second


class _Edge(NamedTuple):
    """An edge between two faces: ``normal`` of the one, ``outwards`` across the edge from it, the angle to the other,
    and the integral of the directions between the two.
    """

    start: int
    end: int
    along: FloatArray
    normal: FloatArray
    outwards: FloatArray
    angle: float
    mean: FloatArray

    def sums(self, corners: FloatArray, radius: float) -> Sums:
        """Return the integrals over the sector of a round bar along the edge."""
        start, end = corners[self.start], corners[self.end]
        length = float(np.linalg.norm(end - start))
        middle = (start + end) / 2.0
        spread = np.outer(middle, middle) + np.outer(end - start, end - start) / 12.0
        p, t, angle = self.normal, self.outwards, self.angle
        mixed, crossed = np.outer(middle, self.mean), np.outer(p, t)
        directions = (
            angle * (np.outer(p, p) + np.outer(t, t))
            + math.sin(2.0 * angle) / 2.0 * (np.outer(p, p) - np.outer(t, t))
            + math.sin(angle) ** 2 * (crossed + crossed.T)
        ) / 2.0
        return Sums(
            length * angle * radius**2 / 2.0,
            length * (angle * middle * radius**2 / 2.0 + self.mean * radius**3 / 3.0),
            length
            * (angle * spread * radius**2 / 2.0 + (mixed + mixed.T) * radius**3 / 3.0 + directions * radius**4 / 4.0),
        )


def _edges(hull: Hull) -> list[_Edge]:
    normal_at = {
        side: normal
        for loop, normal in zip(hull.faces, hull.normals, strict=True)
        for side in zip(loop, (*loop[1:], loop[0]), strict=True)
    }
    found = []
    for start, end in hull.edges.tolist():
        normal, other = normal_at[start, end], normal_at[end, start]
        along = unit_rows((hull.vertices_m[end] - hull.vertices_m[start])[None])[0]
        outwards = np.cross(along, normal)
        angle = math.atan2(float(other @ outwards), float(other @ normal))
        found.append(_Edge(start, end, along, normal, outwards, angle, outwards - np.cross(along, other)))
    return found
