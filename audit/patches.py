"""The surface of a body as patches with two coordinates, each from 0 to 1: places on it as densely as one likes.

A patch is flat, with four corners of which some may coincide, or a line or an arc that turns about an axis. All places
lie on the surfaces of the shapes; those within another shape are places of the body, those in a hole are none.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise, product

import numpy as np
from numpy.typing import NDArray

from audit.case import FloatArray
from audit.solids import hull_facets, profile_of, rotation_of
from cagepose import Box, Capsule, Convex, Hole, Sphere
from cagepose.model.shapes import Shape

IntArray = NDArray[np.int64]
Ring = tuple[float, float, float, float, float, float, float]
"""Height and distance from the axis where the line begins, and how they grow along it; radius of an arc about them,
angle where it begins (zero: away from the axis) and how it grows.
"""
LEAST_CELLS, MOST_FLAT, MOST_ALONG, LEAST_AROUND, MOST_AROUND = 2, 24, 10, 16, 64
"""Of the coarse sampling: along a patch, and around an axis."""


class Patches:
    """The patches of a body, in its frame."""

    def __init__(self, solids: Sequence[Shape], holes: Sequence[Hole], points: FloatArray) -> None:
        """
        Raises
        ------
        NotImplementedError
            A flat polygon with a radius.
        """
        self.corners: list[FloatArray] = [np.tile(point, (4, 1)) for point in points]
        self.rings: list[Ring] = []
        self.rotations: list[FloatArray] = []
        self.centers: list[FloatArray] = []
        for shape in (*solids, *holes):
            self._add(shape)
        corners = np.array(self.corners).reshape(-1, 4, 3)
        self.flat = corners
        self.turned = np.array(self.rings).reshape(-1, 7)
        self.axes = np.array(self.rotations).reshape(-1, 3, 3)
        self.origins = np.array(self.centers).reshape(-1, 3)

    def _add(self, shape: Shape) -> None:
        rotation, position = rotation_of(shape.pose_body_shape), shape.pose_body_shape.position_m
        if isinstance(shape, Box):
            self.corners += [faces @ rotation.T + position for faces in _box_faces(shape.size_m / 2.0)]
        elif isinstance(shape, Sphere | Capsule):
            self._add_bar(
                shape.radius_m, shape.length_m / 2.0 if isinstance(shape, Capsule) else 0.0, rotation, position
            )
        elif isinstance(shape, Convex):
            self._add_hull(shape, rotation, position)
        else:
            profile = profile_of(shape)
            is_alone = isinstance(shape, Hole) and not shape.in_
            low, high = profile[0], profile[-1]
            ends = [] if is_alone else [((low[0], 0.0), low)]
            if not isinstance(shape, Hole):
                ends.append((high, (high[0], 0.0)))
            for (height, radius), (next_height, next_radius) in (*ends, *pairwise(profile)):
                line = (height, radius, next_height - height, next_radius - radius, 0.0, 0.0, 0.0)
                self._turn(line, rotation, position)

    def _add_bar(self, radius: float, half: float, rotation: FloatArray, position: FloatArray) -> None:
        for height, start in ((-half, -math.pi / 2), (half, 0.0)):
            self._turn((height, 0.0, 0.0, 0.0, radius, start, math.pi / 2), rotation, position)
        if half > 0.0:
            self._turn((-half, radius, 2.0 * half, 0.0, 0.0, 0.0, 0.0), rotation, position)

    def _add_hull(self, shape: Convex, rotation: FloatArray, position: FloatArray) -> None:
        triangles, normals = hull_facets(shape)
        outer = triangles + shape.radius_m * normals[:, None]
        self.corners += [corners @ rotation.T + position for corners in outer[:, [0, 1, 2, 0]]]
        if shape.radius_m > 0.0:
            sides = {tuple(sorted(map(tuple, side))) for one in triangles for side in (one[:2], one[1:], one[::2])}
            for one, other in sorted(sides):
                start, end = np.array(one), np.array(other)
                frame = rotation @ _frame_along(end - start)
                middle = rotation @ ((start + end) / 2.0) + position
                self._add_bar(shape.radius_m, float(np.linalg.norm(end - start)) / 2.0, frame, middle)

    def _turn(self, ring: Ring, rotation: FloatArray, position: FloatArray) -> None:
        if not any(ring[2:5]):
            return  # the end of a cone with a tip
        self.rings.append(ring)
        self.rotations.append(rotation)
        self.centers.append(position)

    def places(self, patch: IntArray, u: FloatArray, v: FloatArray) -> FloatArray:
        """Return the places (n, 3) at coordinates of patches, each (n,): metres, in the body's frame."""
        found = np.empty((len(patch), 3))
        is_flat = patch < len(self.flat)
        flat, s, t = patch[is_flat], u[is_flat, None], v[is_flat, None]
        a, b, c, d = np.moveaxis(self.flat[flat], 1, 0)
        found[is_flat] = (1 - t) * ((1 - s) * a + s * b) + t * ((1 - s) * d + s * c)
        ring = patch[~is_flat] - len(self.flat)
        around, along = 2.0 * math.pi * u[~is_flat], v[~is_flat]
        height, out, rise, widening, radius, start, turn = self.turned[ring].T
        out = out + widening * along + radius * np.cos(start + turn * along)
        height = height + rise * along + radius * np.sin(start + turn * along)
        own = np.stack([out * np.cos(around), out * np.sin(around), height], axis=1)
        found[~is_flat] = np.einsum("nij,nj->ni", self.axes[ring], own) + self.origins[ring]
        return found

    def samples(self, spacing_m: float) -> Samples:
        """Return coordinates throughout all patches, their borders among them: ``spacing_m`` apart, or more where a
        patch is longer than the most of these.
        """
        found = []
        for number, corners in enumerate(self.flat):
            sides = np.linalg.norm(np.diff(corners[[0, 1, 2, 3, 0]], axis=0), axis=1)
            counts = [_cells(max(pair), spacing_m, MOST_FLAT) for pair in (sides[::2], sides[1::2])]
            found.append((number, *counts, max(sides.reshape(2, 2).max(axis=0) / np.maximum(counts, 1))))
        for number, ring in enumerate(self.turned, start=len(self.flat)):
            length = math.hypot(ring[2], ring[3]) + ring[4] * ring[6]
            girth = 2.0 * math.pi * (max(ring[1], ring[1] + ring[3]) + ring[4])
            along = _cells(length, spacing_m, MOST_ALONG)
            around = int(np.clip(math.ceil(girth / spacing_m), LEAST_AROUND, MOST_AROUND))
            found.append((number, around, along, max(length / along, girth / around)))
        rows = [
            (number, j / max(across, 1), k / max(along, 1), 1.0 / max(across, 1), 1.0 / max(along, 1), spacing)
            for number, across, along, spacing in found
            for j, k in product(range(across + 1), range(along + 1))
        ]
        patch, *others = np.array(rows).T
        return Samples(self, patch.astype(np.int64), *others)


class Samples:
    """Places on patches, and how far apart they are: coordinates ``u`` and ``v``, steps of these, and metres."""

    def __init__(
        self,
        patches: Patches,
        patch: IntArray,
        u: FloatArray,
        v: FloatArray,
        step_u: FloatArray,
        step_v: FloatArray,
        spacing_m: FloatArray,
    ) -> None:
        self.patches, self.patch, self.u, self.v = patches, patch, u, v
        self.step_u, self.step_v, self.spacing_m = step_u, step_v, spacing_m
        self.places = patches.places(patch, u, v)

    def chosen(self, which: NDArray[np.bool_]) -> Samples:
        """Return some of them."""
        others = (self.u, self.v, self.step_u, self.step_v, self.spacing_m)
        return Samples(self.patches, self.patch[which], *(column[which] for column in others))


def _cells(length: float, spacing_m: float, most: int) -> int:
    return 0 if length == 0.0 else int(np.clip(math.ceil(length / spacing_m), LEAST_CELLS, most))


def _box_faces(half: FloatArray) -> list[FloatArray]:
    faces = []
    for axis, side in product(range(3), (-1.0, 1.0)):
        corners = np.empty((4, 3))
        corners[:, axis] = side
        corners[:, (axis + 1) % 3] = (-1.0, 1.0, 1.0, -1.0)
        corners[:, (axis + 2) % 3] = (-1.0, -1.0, 1.0, 1.0)
        faces.append(corners * half)
    return faces


def _frame_along(axis: FloatArray) -> FloatArray:
    """Return a rotation whose z axis has this direction."""
    z = axis / np.linalg.norm(axis)
    x = np.cross(z, np.eye(3)[np.abs(z).argmin()])
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z], axis=1)
