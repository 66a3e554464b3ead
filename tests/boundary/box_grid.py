"""Unions of boxes on a grid of cells: their convex edges, vertices and faces by looking at cells, with no geometry."""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

Box = tuple[tuple[int, ...], tuple[int, ...]]
Cells = NDArray[np.bool_]
Place = tuple[int, ...]


def drawn_boxes(rng: np.random.Generator, n: int, size: int) -> list[Box]:
    lows = rng.integers(0, size - 1, (n, 3))
    highs = rng.integers(lows + 1, size + 1)
    return [(tuple(low), tuple(high)) for low, high in zip(lows.tolist(), highs.tolist(), strict=True)]


def cells_of(boxes: list[Box]) -> Cells:
    """Cell (i, j, k) reaches from i - 1 to i and so on: there is an empty layer all around."""
    cells = np.zeros(np.max([high for _, high in boxes], axis=0) + 2, np.bool_)
    for low, high in boxes:
        cells[tuple(slice(a + 1, b + 1) for a, b in zip(low, high, strict=True))] = True
    return cells


def edges_of(cells: Cells) -> set[tuple[Place, Place, Place, Place]]:
    """Start, end and both normals of each convex edge, as long as it goes on; the normals in order."""
    found = set()
    for axis in range(3):
        b, c = (axis + 1) % 3, (axis + 2) % 3
        turned = np.moveaxis(cells, (axis, b, c), (0, 1, 2))
        quarters = np.stack([turned[:, :-1, :-1], turned[:, :-1, 1:], turned[:, 1:, :-1], turned[:, 1:, 1:]])
        n_full = quarters.sum(axis=0)
        is_crossed = (n_full == 2) & (quarters[0] == quarters[3])
        for q, (above_b, above_c) in enumerate(product((0, 1), repeat=2)):
            is_edge = quarters[q] & ((n_full == 1) | is_crossed)
            normals = []
            for other, above in ((b, above_b), (c, above_c)):
                normals.append(tuple((1 - 2 * above) * int(k == other) for k in range(3)))
            for j, k in zip(*np.nonzero(is_edge.any(axis=0)), strict=True):
                steps = np.diff(is_edge[:, j, k].astype(int))
                for start, end in zip(np.flatnonzero(steps == 1), np.flatnonzero(steps == -1), strict=True):
                    ends = []
                    for at in (start, end):
                        place = [0, 0, 0]
                        place[axis], place[b], place[c] = int(at), int(j), int(k)
                        ends.append(tuple(place))
                    found.add((*ends, *sorted(normals)))
    return found


def vertices_of(cells: Cells) -> set[Place]:
    """Places where one of eight cells is full: else material lies along both senses of an axis."""
    spans = (slice(None, -1), slice(1, None))
    n_full = np.sum([cells[a, b, c] for a, b, c in product(spans, repeat=3)], axis=0)
    return {tuple(place) for place in np.argwhere(n_full == 1).tolist()}


def squares_of(cells: Cells) -> set[tuple[int, int, Place]]:
    """Axis, sense and cell of each square of the surface: that cell is full, and the next one is empty."""
    found = set()
    for axis, sense in product(range(3), (1, -1)):
        empty = ~np.roll(cells, -sense, axis=axis)
        found |= {(axis, sense, tuple(place)) for place in np.argwhere(cells & empty).tolist()}
    return found


def n_regions(squares: set[tuple[int, int, Place]]) -> int:
    """How many regions the squares make that share a side and lie in one plane."""
    left, n = set(squares), 0
    while left:
        n += 1
        reached = [left.pop()]
        for axis, sense, place in reached:
            for k, step in product(range(3), (1, -1)):
                beside = (axis, sense, tuple(value + step * (j == k) for j, value in enumerate(place)))
                if k != axis and beside in left:
                    left.remove(beside)
                    reached.append(beside)
    return n
