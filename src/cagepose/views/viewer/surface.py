"""Where the object's surface and the cage's points and shapes are nearest to each other."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.model.box import Box
from cagepose.model.checks import FloatArray
from cagepose.model.nearest import Core, core_of, nearest_points
from cagepose.model.parts import Object
from cagepose.model.pose import Pose
from cagepose.runs.driven_cage import CageAt


class Nearest(NamedTuple):
    """The places of the object and of each of n elements of the cage that are nearest to each other.

    Attributes
    ----------
    feet_world
        On the object, (n, 3), metres.
    places_world
        On the elements: points themselves, (n, 3), metres.
    normals_world
        Outward unit normals of the object at the feet, (n, 3).
    parts
        Indices of the object's parts, (n,).
    """

    feet_world: FloatArray
    places_world: FloatArray
    normals_world: FloatArray
    parts: NDArray[np.int64]


def nearest_on_object(held: Object, pose: Pose, at: CageAt, elements: Sequence[int] | None = None) -> Nearest:
    """Return what is nearest of the object, at ``pose``, to elements of the cage: its points and shapes, by index,
    points first, and no holes. Left out: all.

    Of a point inside boxes, the place is on the nearest face of the box in which it lies deepest.
    """
    cage, points = at.cage, at.points_world
    chosen = np.arange(len(points) + len(cage.shapes)) if elements is None else np.array(elements, dtype=np.int64)
    feet, places, normals = np.zeros((3, len(chosen), 3))
    found = Nearest(feet, places, normals, np.zeros(len(chosen), dtype=np.int64))
    is_point = chosen < len(points)
    gaps = np.full(len(chosen), np.inf)
    if held.boxes and is_point.any():
        gaps[is_point] = _write_nearest_of_boxes(held.boxes, pose, points[chosen[is_point]], is_point, found)
    rows = np.arange(len(chosen)) if held.shapes else np.nonzero(~is_point)[0]
    cores = [core_of(part, pose) for part in held.parts] if len(rows) else []
    for row in rows.tolist():
        element, gap = int(chosen[row]), float(gaps[row])
        if is_point[row]:
            point = core_of(points[element], cage.pose_world_cage)
            _write_nearest_part(cores, point, len(held.boxes), row, gap, found)
        else:
            which = element - len(points)
            shape = core_of(cage.shapes[which], at.pose_of_cage(which))
            _write_nearest_part(cores, shape, 0, row, gap, found)
    return found


def _write_nearest_part(cores: list[Core], other: Core, first: int, row: int, gap: float, found: Nearest) -> None:
    """Write the nearest of the object's parts from the one with index ``first``, where it is nearer than ``gap``."""
    way: FloatArray | None = None  # from the nearest part so far to the other
    for least_gap, part in sorted((core.least_gap(other), part) for part, core in enumerate(cores[first:], first)):
        if least_gap >= gap:
            break
        if way is not None and cores[part].gap_along(way, other) >= gap:
            continue
        foot, place = nearest_points(cores[part], other)
        between = place - foot
        outward = foot - cores[part].middle
        # Cores that touch have no distance with a direction; rounded bodies may be a little into each other.
        distance = float(np.copysign(np.linalg.norm(between), between @ outward))
        if distance < gap:
            gap = distance
            way = between if distance > 0.0 else -between if distance < 0.0 else outward
            way = way / (np.linalg.norm(way) or 1.0)
            found.feet_world[row], found.places_world[row], found.parts[row] = foot, place, part
            found.normals_world[row] = way


@lru_cache(maxsize=4)
def _measures_of(boxes: tuple[Box, ...]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return how n boxes are turned (n, 3, 3), their middles (n, 3) and halves of their edges (n, 1, 3), metres."""
    turns = np.array([box.pose_object_box.rotation for box in boxes])
    middles = np.array([box.pose_object_box.position_m for box in boxes])
    return turns, middles, np.array([box.size_m for box in boxes])[:, None, :] / 2.0


def _write_nearest_of_boxes(
    boxes: tuple[Box, ...], pose: Pose, points_world: FloatArray, rows: NDArray[np.bool_], found: Nearest
) -> FloatArray:
    """Write the nearest places of the boxes to points (n, 3) into rows; return the gaps, (n,), metres."""
    turns, middles, halves = _measures_of(boxes)
    points = (
        pose.inverse_transform(points_world) - middles[:, None, :]
    ) @ turns  # (n_boxes, n, 3), in each box's frame
    beyond = np.abs(points) - halves
    outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=2)
    gaps = np.where(outside > 0.0, outside, beyond.max(axis=2))
    parts, each = gaps.argmin(axis=0), np.arange(len(points_world))
    axes = beyond[parts, each].argmax(axis=1)
    sides = np.where(points[parts, each, axes] < 0.0, -1.0, 1.0)
    feet, normals = np.clip(points, -halves, halves)[parts, each], np.zeros((len(points_world), 3))
    feet[each, axes] = sides * halves[parts, 0, axes]
    normals[each, axes] = sides
    feet_object = np.einsum("nij,nj->ni", turns[parts], feet) + middles[parts]
    normals_object = np.einsum("nij,nj->ni", turns[parts], normals)
    found.feet_world[rows], found.places_world[rows] = pose.transform(feet_object), points_world
    found.normals_world[rows], found.parts[rows] = normals_object @ pose.rotation.T, parts
    nearest: FloatArray = gaps[parts, each]
    return nearest
