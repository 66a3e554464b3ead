"""Which of many things may touch, by the boxes around them: few pairs of many, in time that grows with what is found.

Things are halved across their longest extent until few are left, and halves whose boxes are apart are not compared.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cagepose.model.checks import FloatArray

IntArray = NDArray[np.intp]

FEW = 64
"""So many things are all compared with each other: quicker than to halve them."""


def near_pairs(low: FloatArray, high: FloatArray, most: float = math.inf, *, between: int | None = None) -> IntArray:
    """Return the pairs of boxes along the axes that overlap or touch, by their indices. The search stops once it has
    more than ``most``; ``between``: one of each pair is among so many first ones, the other is not.

    Parameters
    ----------
    low, high
        The boxes' least and greatest coordinates, (n, 3) both.

    Returns
    -------
    IntArray
        (n_pairs, 2), the lower index first, in the order of `itertools.combinations`.
    """
    found = [np.zeros((0, 2), np.intp)]
    todo: list[tuple[IntArray, IntArray | None]] = [(np.arange(len(low)), None)]
    if between is not None:
        todo = [(np.arange(between), np.arange(between, len(low)))] if 0 < between < len(low) else []
    n_found = 0
    while todo and n_found <= most:
        one, other = todo.pop()
        if other is None:
            if len(one) <= FEW:
                pairs = _compared(low, high, one, one)
                found.append(pairs[pairs[:, 0] < pairs[:, 1]])
                n_found += len(found[-1])
            else:
                left, right = _halves(low, high, one)
                todo += [(left, None), (right, None), (left, right)]
            continue
        one = one[_meet(low[one], high[one], low[other].min(axis=0), high[other].max(axis=0))]
        if len(one) == 0:
            continue
        other = other[_meet(low[other], high[other], low[one].min(axis=0), high[one].max(axis=0))]
        if len(other) == 0:
            continue
        if len(one) * len(other) <= FEW * FEW:
            found.append(_compared(low, high, one, other))
            n_found += len(found[-1])
        else:
            shorter, longer = sorted((one, other), key=len)
            todo += [(shorter, half) for half in _halves(low, high, longer)]
    pairs = np.sort(np.concatenate(found), axis=1)
    return pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]


def _meet(low: FloatArray, high: FloatArray, other_low: FloatArray, other_high: FloatArray) -> NDArray[np.bool_]:
    meet = (low <= other_high) & (other_low <= high)
    return np.asarray(meet.all(axis=-1))


def _compared(low: FloatArray, high: FloatArray, one: IntArray, other: IntArray) -> IntArray:
    rows, columns = np.nonzero(_meet(low[one][:, None], high[one][:, None], low[other], high[other]))
    return np.stack([one[rows], other[columns]], axis=1)


def _halves(low: FloatArray, high: FloatArray, of: IntArray) -> tuple[IntArray, IntArray]:
    middles = low[of] + high[of]
    order = np.argsort(middles[:, int(np.argmax(np.ptp(middles, axis=0)))], kind="stable")
    return of[order[: len(of) // 2]], of[order[len(of) // 2 :]]
