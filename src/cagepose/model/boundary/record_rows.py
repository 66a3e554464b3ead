"""Rows of records put together and chosen as memory: field by field, as NumPy does it, takes ten times as long."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray


def one_behind_the_other(rows: Sequence[NDArray[np.void]]) -> Any:
    """Return arrays of one kind of records as one array, (n,)."""
    kind = rows[0].dtype
    return np.concatenate([_memory(each) for each in rows]).view(kind)


def chosen(rows: NDArray[np.void], which: NDArray[np.int64]) -> Any:
    """Return the records at some places, (n,), as an array of their own."""
    return _memory(rows)[which].view(rows.dtype)


def _memory(rows: NDArray[np.void]) -> NDArray[np.void]:
    return rows.view(np.dtype((np.void, rows.dtype.itemsize)))
