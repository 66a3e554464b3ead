"""Features of a body as they are collected: blocks of rows with their bounds, and boxes around them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.record import dtype_of
from cagepose.kernels.boundary.features import FACE, OUTSIDE, Bound, Feature
from cagepose.model.checks import FloatArray
from cagepose.model.hole import Hole

NOWHERE = np.zeros(3)


class Row(NamedTuple):
    """A feature, its bounds apart, and a box around it: lowest and highest coordinates."""

    kind: int
    part: int
    point: FloatArray
    direction: FloatArray
    toward: FloatArray
    length: float
    radius: float
    taper: float
    low: float
    high: float
    start: float
    width: float
    bounds: list[tuple[int, FloatArray, FloatArray, float]]
    least: float
    box: FloatArray


class Block(NamedTuple):
    """Features that the same parts do not cover.

    Attributes
    ----------
    features
        Rows of `kernels.boundary.features.Feature`, whose bounds are numbered within the block, one after the other.
    bounds
        Theirs.
    boxes
        Around each of them, lowest and highest coordinates, (n, 2, 3), metres.
    apart_from
        Numbers of the parts that do not cover them.
    """

    features: NDArray[np.void]
    bounds: NDArray[np.void]
    boxes: FloatArray
    apart_from: frozenset[int]


def block_of(rows: Sequence[Row], apart_from: frozenset[int]) -> Block:
    """Return rows as a block."""
    features, bounds = list[tuple[object, ...]](), list[tuple[int, FloatArray, FloatArray, float]]()
    for row in rows:
        numbers = row[: Row._fields.index("bounds")]
        features.append((*numbers, len(bounds), len(bounds) + len(row.bounds), row.least, 0, 0))
        bounds += row.bounds
    boxes = np.array([row.box for row in rows]).reshape(-1, 2, 3)
    return Block(np.array(features, dtype_of(Feature)), np.array(bounds, dtype_of(Bound)), boxes, apart_from)


def pierced(block: Block, hole: Hole, parts: frozenset[int]) -> Block:
    """Return a block in which faces of some parts are without what a hole cuts out of them."""
    found, circles = list[int](), list[tuple[int, FloatArray, FloatArray, float]]()
    features = block.features
    is_asked = (
        (features["kind"] == FACE) & np.isin(features["part"], list(parts)) & hole.is_across(features["direction"])
    )
    for index in np.flatnonzero(is_asked).tolist():
        point, normal = np.array(features["point"][index]), np.array(features["direction"][index])
        circle = hole.circle_in(point + features["radius"][index] * normal, normal)
        if circle is not None:
            center, wide = circle
            seen = center - point
            found.append(index)
            circles.append((OUTSIDE, seen - (seen @ normal) * normal, NOWHERE, wide))
    if not found:
        return block
    changed: Any = features.copy()
    bounds = np.insert(block.bounds, features["last_bound"][found], np.array(circles, dtype_of(Bound)))
    n_more = np.zeros(len(features), np.int64)
    n_more[found] = 1
    before = np.cumsum(n_more)
    changed["first_bound"] += before - n_more
    changed["last_bound"] += before
    return block._replace(features=changed, bounds=bounds)
