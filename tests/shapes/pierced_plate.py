"""How far a part is from a plate with a round hole, searched along lines: an oracle.

Within the hole and above the plate, how far a point is from the plate is a concave function where no rim of the plate
is near, so the least over a convex part is at its ends: on its rims, its edges, or a radius from its axis. And how far
the part is from a rim of the plate is asked all along that rim. So all is a search along circles and segments: on a
grid, and around its least values on ever smaller ones.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from cagepose import Box, Pose
from cagepose.model.hole import Hole
from cagepose.model.shapes import Rounded, Shape, Turned

N_GRID, N_BEST, N_CLOSER = 180, 4, 16
CLOSER = np.linspace(-1.0, 1.0, 33)
"""Around each of the best places: from twice as far as they are apart here the next ones come, an eighth as far."""
FAR = 1e-3
"""In sizes of a plate. From so far the way to it is known."""
CORNERS = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
EDGES = [(i, j) for i in range(8) for j in range(i) if np.count_nonzero(CORNERS[i] != CORNERS[j]) == 1]


@dataclass(frozen=True, eq=False)
class PiercedPlate:
    """A plate with a hole along z, its top at z = 0.

    Attributes
    ----------
    line
        Radius and height of the corners of its section, from below to the top and outwards, (n, 2).
    sharp
        Indices of the corners that are rims which stand out.
    """

    line: np.ndarray
    sharp: list[int]

    @property
    def size(self) -> float:
        return float(self.line.max() - self.line.min())

    @cached_property
    def segments(self) -> tuple[np.ndarray, ...]:
        """Starts, directions and lengths of the sides of its section."""
        ways = np.diff(self.line, axis=0)
        lengths = np.linalg.norm(ways, axis=1)
        return self.line[:-1], ways / lengths[:, None], lengths

    def distance_of(self, points: np.ndarray) -> np.ndarray:
        """Return how far points (..., 3) are from the plate, below zero how deep in it."""
        starts, along, lengths = self.segments
        radii, heights = np.hypot(points[..., 0], points[..., 1]), points[..., 2]
        x, y = radii[..., None] - starts[:, 0], heights[..., None] - starts[:, 1]
        share = np.minimum(np.maximum(x * along[:, 0] + y * along[:, 1], 0.0), lengths)
        nearest = np.hypot(x - share * along[:, 0], y - share * along[:, 1]).min(axis=-1)
        (_, bottom), (narrowest, _) = self.line[:2]
        tops = np.interp(radii, *self.line[1:].T)
        is_in = (radii >= narrowest) & (heights < tops) & (heights > bottom)
        is_in |= (heights <= bottom) & (self.line[0, 0] == 0.0)
        return np.where(is_in, -nearest, nearest)


def plate_of(hole: Hole, is_open: bool, wide: float) -> PiercedPlate:
    """Return the plate of a hole, so wide, as an oracle: an open one has an underside."""
    corners = [(wide if is_open else 0.0, -hole.depth_m), (hole.radius_m, -hole.depth_m)]
    sharp = [1] if is_open else []
    if hole.chamfer is not None:
        corners.append((hole.radius_m, -hole.chamfer.width_m / np.tan(hole.chamfer.angle_rad)))
        sharp.append(2)
    wider = 0.0 if hole.chamfer is None else hole.chamfer.width_m
    corners.append((hole.radius_m + wider, 0.0))
    sharp.append(len(corners) - 1)
    return PiercedPlate(np.array([*corners, (wide, 0.0)]), sharp)


def distance_of(part: Shape, points: np.ndarray) -> np.ndarray:
    """Return how far points (n, 3) of a part's body are from it, below zero how deep in it."""
    if isinstance(part, Box):
        beyond = np.abs(part.pose_object_box.inverse_transform(points)) - part.size_m / 2.0
        distances: np.ndarray = np.linalg.norm(np.maximum(beyond, 0.0), axis=1) + np.minimum(beyond.max(axis=1), 0.0)
        return distances
    own = part.pose_body_shape.inverse_transform(points)
    if isinstance(part, Turned):
        return _of_turned(part, np.hypot(own[:, 0], own[:, 1]), own[:, 2])
    assert isinstance(part, Rounded)
    ends = part.core()[:, 2]
    away = own - np.column_stack([0.0 * own[:, :2], np.clip(own[:, 2], ends.min(), ends.max())])
    own_distances: np.ndarray = np.linalg.norm(away, axis=1) - part.radius_m
    return own_distances


def _of_turned(part: Turned, radii: np.ndarray, heights: np.ndarray) -> np.ndarray:
    (low, wide), (high, narrow) = part.rims
    corners = np.array([(0.0, low), (wide, low), (narrow, high), (0.0, high)])
    nearest, beyond = np.full_like(radii, np.inf), np.full_like(radii, -np.inf)
    for start, end in pairwise(corners):
        length = np.linalg.norm(end - start)
        if length == 0.0:
            continue
        along = (end - start) / length
        x, y = radii - start[0], heights - start[1]
        share = np.clip(along[0] * x + along[1] * y, 0.0, length)
        nearest = np.minimum(nearest, np.hypot(x - share * along[0], y - share * along[1]))
        beyond = np.maximum(beyond, along[1] * x - along[0] * y)
    return np.where(beyond > 0.0, nearest, -nearest)


def _circle(pose: Pose, height: float, radius: float):
    def at(share: np.ndarray) -> np.ndarray:
        angle = 2.0 * np.pi * share.ravel()
        ring = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.full(angle.shape, height)])
        return pose.transform(ring)

    return at


def _segment(start: np.ndarray, end: np.ndarray):
    return lambda share: start + np.clip(share.ravel(), 0.0, 1.0)[:, None] * (end - start)


def _lines_of(part: Shape, pose: Pose):
    """Yield the lines that a part ends in, at a pose, with the radius added there."""
    if isinstance(part, Turned):
        for height, radius in part.rims:
            yield _circle(pose @ part.pose_body_shape, height, radius), 0.0
    elif isinstance(part, Box):
        corners = (pose @ part.pose_object_box).transform(CORNERS * part.size_m)
        for i, j in EDGES:
            yield _segment(corners[i], corners[j]), 0.0
    elif isinstance(part, Rounded):
        core = pose.transform(part.nodes_body())
        yield _segment(core[0], core[-1]), part.radius_m


def _least(of_points, at) -> tuple[float, np.ndarray]:
    """Return the least value along a line, and where it is."""
    values = of_points(at(np.arange(N_GRID + 1) / N_GRID))
    beside = np.concatenate([[values[-2]], values, [values[1]]])
    is_least = (values <= beside[:-2]) & (values <= beside[2:])
    is_least[[0, -1]] = True
    best = np.flatnonzero(is_least)
    best = best[np.argsort(values[best])][:N_BEST]
    centers, spread = best / N_GRID, 1.0 / N_GRID
    for _ in range(N_CLOSER):
        tried = centers[:, None] + spread * CLOSER
        values = of_points(at(tried)).reshape(tried.shape)
        centers = np.take_along_axis(tried, values.argmin(axis=1)[:, None], axis=1)[:, 0]
        spread *= 0.125
    values = of_points(at(centers))
    which = int(values.argmin())
    return float(values[which]), at(centers[which : which + 1])[0]


def gap(part: Shape, pose: Pose, plate: PiercedPlate) -> tuple[float, np.ndarray]:
    """Return the gap of a part at a pose to a plate, and the unit vector there out of the part."""

    def from_part(points: np.ndarray) -> np.ndarray:
        return distance_of(part, pose.inverse_transform(points))

    step = 1e-6 * plate.size * np.eye(3)
    found = []
    for at, radius in _lines_of(part, pose):
        least, point = _least(plate.distance_of, at)
        found.append((least - radius, plate.distance_of(point - step) - plate.distance_of(point + step)))
    for corner in plate.sharp:
        radius, height = plate.line[corner]
        least, point = _least(from_part, _circle(Pose(), height, radius))
        found.append((least, from_part(point + step) - from_part(point - step)))
    least, out = min(found, key=lambda pair: pair[0])
    return least, out / max(float(np.linalg.norm(out)), 1e-300)


def brought_to(part: Shape, pose: Pose, plate: PiercedPlate, distance: float) -> Pose | None:
    """Return a pose along the way from another one, apart from the plate, with a gap of ``distance``; None: there is
    none, as something else comes nearer on the way.
    """
    start, normal = gap(part, pose, plate)
    if start < FAR * plate.size:
        return None
    for _ in range(4):
        apart, _ = gap(part, pose, plate)
        pose = Pose(pose.position_m + (apart - distance) * normal, pose.quaternion_wxyz)
    return pose if abs(gap(part, pose, plate)[0] - distance) <= 1e-13 * plate.size else None
