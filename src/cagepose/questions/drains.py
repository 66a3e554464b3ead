"""Which faces that stand for something round are rests, and to which of these the others lead: `drained`.

The hull of points on something round has faces on which it would rest, all along its slopes. Where the way from one to
the next has no higher place, the round part goes on to the lower of both. On a ridge it goes on to both sides: the
orientations that lead to such a face are shared between these as the ridge divides the way across it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from cagepose.model.checks import FloatArray, unit_rows

N_ON_WAY = 33
"""Places on the way across a face at which the ridge is looked for."""


class Pass(NamedTuple):
    """An edge over which the part goes from one rest to another one (their numbers), where down points at the highest
    place of the way, which may be one of its ends, and how high the centre of gravity stands then.
    """

    between: tuple[int, int]
    down: FloatArray
    height_m: float


Shares = dict[int, dict[int, float]]
"""For each face the rests to which its orientations lead, each with its part of them."""


class _Lower(NamedTuple):
    """What is beside a face and lower, the top of the way there, and how steep it is."""

    face: int
    top: FloatArray
    slope: float


def drained(
    normals: FloatArray, tops: list[Pass], heights_of: Callable[[FloatArray], FloatArray], level_m: float
) -> tuple[Shares, list[Pass]]:
    """Return to which faces others lead, and the ways to tip from one of those to another.

    Parameters
    ----------
    normals
        Of all faces, (n, 3).
    tops
        Of the ways between faces on which the hull rests, no two of which are level with all between them.
    heights_of
        How high the centre of gravity stands while unit vectors (n, 3) point down, (n,), metres.
    level_m
        Heights that differ by no more are the same.
    """
    faces = sorted({face for top in tops for face in top.between})
    heights = dict(zip(faces, heights_of(normals[faces]).tolist(), strict=True))
    by_height = sorted(faces, key=heights.__getitem__)
    rank = {face: number for number, face in enumerate(by_height)}
    lower: dict[int, list[_Lower]] = {face: [] for face in faces}
    for (one, other), top, height_m in tops:
        low, high = sorted((one, other), key=rank.__getitem__)
        if height_m <= heights[high] + level_m:
            way = float(np.arccos(np.clip(normals[high] @ normals[low], -1.0, 1.0)))
            lower[high].append(_Lower(low, top, (heights[high] - heights[low]) / way))
    shares, ridges = Shares(), dict[int, tuple[FloatArray, float]]()
    for face in by_height:
        ridges[face] = normals[face], heights[face]
        shares[face] = {face: 1.0}
        if lower[face]:
            steepest = max(lower[face], key=lambda beside: beside.slope)
            shares[face] = shares[steepest.face]
            if across := _across(normals[face], steepest, lower[face], shares):
                share, down, top_m = _ridge(np.array([steepest.top, normals[face], across.top]), heights_of)
                ridges[face] = down, top_m
                shares[face] = _mixed(shares[steepest.face], shares[across.face], share)
    passes = []
    for (one, other), top, height_m in tops:
        high = max(one, other, key=rank.__getitem__)
        at, top_m = (top, height_m) if height_m > heights[high] + level_m else ridges[high]
        passes += [Pass((first, last), at, top_m) for first in shares[one] for last in shares[other] if first != last]
    return shares, passes


def _across(normal: FloatArray, steepest: _Lower, lower: list[_Lower], shares: Shares) -> _Lower | None:
    """Return the steepest way down from a face on the other side that leads elsewhere."""
    away = steepest.top - normal
    other = [
        beside
        for beside in lower
        if shares[beside.face] != shares[steepest.face] and float((beside.top - normal) @ away) < 0.0
    ]
    return max(other, key=lambda beside: beside.slope, default=None)


def _ridge(way: FloatArray, heights_of: Callable[[FloatArray], FloatArray]) -> tuple[float, FloatArray, float]:
    """Return where the way between three downs is highest: after which share of it, the down and the height there."""
    steps = np.linspace(0.0, 1.0, N_ON_WAY)[:, None]
    downs = unit_rows(np.concatenate([way[0] + steps * (way[1] - way[0]), way[1] + steps[1:] * (way[2] - way[1])]))
    lengths = np.insert(np.cumsum(np.linalg.norm(np.diff(downs, axis=0), axis=1)), 0, 0.0)
    heights = heights_of(downs)
    top = int(np.argmax(heights))
    return float(lengths[top] / lengths[-1]), downs[top], float(heights[top])


def _mixed(one: dict[int, float], other: dict[int, float], share: float) -> dict[int, float]:
    mixed = {face: share * part for face, part in one.items()}
    for face, part in other.items():
        mixed[face] = mixed.get(face, 0.0) + (1.0 - share) * part
    return mixed
