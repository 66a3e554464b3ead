"""Which of many things hang together, by pairs that do: `joined`."""

from __future__ import annotations

import numpy as np

from cagepose.model.sides import IntArray


def joined(n_things: int, pairs: IntArray) -> IntArray:
    """Return the least index of those that each thing hangs together with, (n,); ``pairs`` is (m, 2)."""
    least = np.arange(n_things)
    while True:
        one, other = least[pairs[:, 0]], least[pairs[:, 1]]
        if (is_same := one == other).all():
            return least
        pairs = pairs[~is_same]
        one, other = one[~is_same], other[~is_same]
        np.minimum.at(least, np.maximum(one, other), np.minimum(one, other))
        while ((further := least[least]) != least).any():
            least = further
