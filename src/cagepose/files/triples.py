"""Rows of three numbers as one text, as lists of thousands take YAML minutes: `triples`, `whole_triples`, `text_of`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cagepose.errors import Problem, SceneError
from cagepose.model.checks import FloatArray
from cagepose.model.wording import number_of


def triples(text: str, key: str) -> FloatArray:
    """Return the numbers of a text with commas between rows, (n, 3).

    Raises
    ------
    SceneError
        Something is no number, or a row has not three; ``key`` is where the text stands.
    """
    rows = [row.split() for row in text.split(",")]
    wrong = next((index for index, row in enumerate(rows) if len(row) != 3), None)
    if wrong is not None:
        found = f"has {number_of(len(rows[wrong]), 'number')} in row {wrong + 1}"
        raise _refused(key, f"{found}; give three, and a comma after each row")
    try:
        return np.array([[float(number) for number in row] for row in rows])
    except ValueError as error:
        raise _refused(key, f"holds what is no number ({error}); give numbers alone") from None


def whole_triples(text: str, key: str) -> NDArray[np.int64]:
    """As `triples`, for whole numbers.

    Raises
    ------
    SceneError
        A number is not whole, too.
    """
    found = triples(text, key)
    if not (np.isfinite(found).all() and (np.abs(found) < 2.0**53).all() and (found == np.floor(found)).all()):
        raise _refused(key, "holds numbers that are not whole; give indices alone")
    return found.astype(np.int64)


def whole_numbers(text: str, key: str) -> NDArray[np.int64]:
    """Return the whole numbers of a text, (n,); raises `SceneError` as `whole_triples`."""
    try:
        return np.array([int(number) for number in text.split()], np.int64)
    except (ValueError, OverflowError) as error:
        raise _refused(key, f"holds what is no whole number ({error}); give indices alone") from None


def text_of(rows: Sequence[Sequence[float]]) -> str:
    """Return rows of numbers as one text, from which the same numbers are read."""
    return ", ".join(" ".join(repr(number) for number in row) for row in rows)


def _refused(key: str, message: str) -> SceneError:
    return SceneError([Problem((key,), message)])
