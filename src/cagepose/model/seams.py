"""Bridges over the seams of an object: boxes that belong to the object where two of its boxes meet flush.

The plane between two flush boxes lies inside the object but inside neither (open) box. A cage point that runs exactly
in it, such as one sliding over a plate towards the foot of a block that stands on the plate, would pass between them. A
bridge is a box from within the one to within the other over their common area: it closes the seam and adds nothing to
the object.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from cagepose.model.checks import FloatArray
from cagepose.model.near_pairs import IntArray, near_pairs

GREATEST_TILT = 1e-6
"""Faces parallel within this angle (radians) can be flush: Euler angles are often written with six decimals."""
WITHIN = 1e-12
"""A corner this far out (as a fraction of a box's edges) still lies within: rounding."""


class PlacedBox(NamedTuple):
    """A box in the object's frame: half edge lengths, centre (metres), rotation matrix."""

    half_size: FloatArray
    position: FloatArray
    rotation: FloatArray


class Seams(NamedTuple):
    """What closes the seams, and which pairs of boxes (by index) have a seam that nothing closes."""

    bridges: list[PlacedBox]
    open_pairs: list[tuple[int, int]]


def close_seams(boxes: Sequence[PlacedBox], touch_m: float) -> Seams:
    """Return a bridge for each pair of boxes that meet flush within ``touch_m``, and for each pair of bridges that do.

    The latter close the lines in which three or four boxes meet. Boxes turned against each other about the seam's
    normal are bridged if the face of one lies within the face of the other; if their outlines cross, the pair is told.
    """
    seams = _between_pairs(boxes, touch_m)
    over_lines = _between_pairs(seams.bridges, touch_m).bridges
    return Seams(_needed([*seams.bridges, *over_lines], boxes), seams.open_pairs)


def _between_pairs(boxes: Sequence[PlacedBox], touch_m: float) -> Seams:
    seams = Seams([], [])
    low, high = _limits(boxes)
    room = touch_m + 2.0 * GREATEST_TILT * float((high - low).max(initial=0.0))
    for first, second in near_pairs(low - room, high + room).tolist():
        one, other = boxes[first], boxes[second]
        bridge = _bridge(one, other, touch_m) or _bridge(other, one, touch_m)
        if bridge is not None:
            seams.bridges.append(bridge)
        elif _meet_flush(one, other, touch_m):
            seams.open_pairs.append((first, second))
    return seams


def _limits(boxes: Sequence[PlacedBox]) -> tuple[FloatArray, FloatArray]:
    """Return the least and the greatest coordinates of each box, (n, 3) both."""
    positions = np.array([box.position for box in boxes]).reshape(-1, 3)
    reach = np.array([np.abs(box.rotation) @ box.half_size for box in boxes]).reshape(-1, 3)
    return positions - reach, positions + reach


def _needed(bridges: list[PlacedBox], boxes: Sequence[PlacedBox]) -> list[PlacedBox]:
    """Drop each bridge that lies within a box or within another bridge: many pairs close the same line."""
    every = [*sorted(bridges, key=lambda box: -float(np.prod(box.half_size))), *boxes]
    low, high = _limits(every)
    room = WITHIN * float((high - low).max(initial=0.0))
    is_kept = [True] * len(every)
    for bridge, beside in _neighbours(near_pairs(low - room, high + room), len(bridges)):
        is_kept[bridge] = not any(is_kept[outer] and _contains(every[outer], every[bridge]) for outer in beside)
    return [bridge for bridge, kept in zip(every[: len(bridges)], is_kept, strict=False) if kept]


def _neighbours(pairs: IntArray, n_bridges: int) -> Iterator[tuple[int, list[int]]]:
    """Yield each bridge, the greatest first, with the greater ones and the boxes that are near it."""
    near: list[list[int]] = [[] for _ in range(n_bridges)]
    for first, second in pairs.tolist():
        if second < n_bridges:
            near[second].append(first)
        elif first < n_bridges:
            near[first].append(second)
    yield from enumerate(near)


def _contains(outer: PlacedBox, inner: PlacedBox) -> bool:
    relative = outer.rotation.T @ inner.rotation
    offset = outer.rotation.T @ (inner.position - outer.position)
    reach = np.abs(offset) + np.abs(relative) @ inner.half_size
    return bool((reach <= outer.half_size + WITHIN * outer.half_size.max()).all())


def _flush_axes(small: PlacedBox, large: PlacedBox, touch_m: float) -> list[tuple[int, int, float]]:
    """Return (axis of small, axis of large, distance apart) of the faces that lie against each other."""
    relative = small.rotation.T @ large.rotation
    offset = small.rotation.T @ (large.position - small.position)
    found = []
    for axis, large_axis in np.argwhere(np.abs(relative) > 0.5):
        tilt = float(np.linalg.norm(np.delete(relative[axis], large_axis)))
        apart = float(abs(offset[axis]) - small.half_size[axis] - large.half_size[large_axis])
        if tilt <= GREATEST_TILT and abs(apart) <= touch_m + tilt * float(small.half_size.sum()):
            found.append((int(axis), int(large_axis), apart))
    return found


def _bridge(small: PlacedBox, large: PlacedBox, touch_m: float) -> PlacedBox | None:
    """Return the bridge over the part of a face of ``small`` that lies on ``large``, in the axes of ``small``."""
    relative = small.rotation.T @ large.rotation
    offset = small.rotation.T @ (large.position - small.position)
    aligned = np.abs(relative).max(axis=1).min() >= 1.0 - GREATEST_TILT**2
    # How far the sides of boxes that are almost aligned drift apart: the bridge stays that far within both.
    drift = float(np.where(np.abs(relative) > 0.5, 0.0, np.abs(relative)).max()) if aligned else 0.0
    for axis, large_axis, apart in _flush_axes(small, large, touch_m):
        tilt = float(np.linalg.norm(np.delete(relative[axis], large_axis)))
        margin = 2.0 * max(drift, tilt) * float(small.half_size.sum() + large.half_size.sum())
        low, high = margin - small.half_size, small.half_size - margin
        across = [k for k in range(3) if k != axis]
        if aligned:  # the common area is a rectangle
            large_half = np.abs(relative) @ large.half_size - margin
            low[across] = np.maximum(low, offset - large_half)[across]
            high[across] = np.minimum(high, offset + large_half)[across]
        elif not _lies_within(small, large, axis, large_axis):
            continue
        if (high - low)[across].min() <= touch_m:
            continue
        seam = np.sign(offset[axis]) * (small.half_size[axis] + apart / 2.0)
        depth = min(small.half_size[axis], large.half_size[large_axis])
        low[axis], high[axis] = seam - depth, seam + depth
        center = small.position + small.rotation @ ((low + high) / 2.0)
        return PlacedBox((high - low) / 2.0, center, small.rotation)
    return None


def _lies_within(small: PlacedBox, large: PlacedBox, axis: int, large_axis: int) -> bool:
    """Whether the outline of ``small`` across ``axis`` lies within that of ``large`` across ``large_axis``."""
    relative = large.rotation.T @ small.rotation
    offset = large.rotation.T @ (small.position - large.position)
    outline = np.where(np.arange(3) == axis, 0.0, small.half_size)
    reach = np.abs(offset) + np.abs(relative) @ outline
    beyond = reach - large.half_size * (1.0 + WITHIN)
    return bool(np.delete(beyond, large_axis).max() <= 0.0)


def _meet_flush(one: PlacedBox, other: PlacedBox, touch_m: float) -> bool:
    """Whether two faces lie against each other over some area (separating axes of their outlines)."""
    for axis, other_axis, _ in _flush_axes(one, other, touch_m):
        normals = [one.rotation[:, k] for k in range(3) if k != axis]
        normals += [other.rotation[:, k] for k in range(3) if k != other_axis]
        offset = other.position - one.position
        apart = [
            abs(normal @ offset)
            - np.abs(one.rotation.T @ normal) @ one.half_size
            - np.abs(other.rotation.T @ normal) @ other.half_size
            for normal in normals
        ]
        if max(apart) < -touch_m:
            return True
    return False
