"""One answer from all kernels: machine code of each level, and plain Python."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from cagepose.kernels.native.library import LIBRARY, Library, kernel_library
from kernels.native.answers import asked

LEVELS = ("x86-64-v2", "x86-64-v3")
NATIVE = kernel_library()


@pytest.mark.skipif(
    NATIVE is None or NATIVE.levels != list(LEVELS) or Library(LIBRARY).level != LEVELS[-1],
    reason="needs both levels (python -m build_kernels --all-levels), and a processor that runs them",
)
def test_both_levels_give_the_same_digits(cases):
    """All our scenes, and random ones with and without friction, by both methods: not a bit differs."""
    older, newer = (asked(level, cases(150, 1000)) for level in LEVELS)
    assert list(older) == list(newer)
    assert [name for name in older if older[name] != newer[name]] == []


def numbers(answer: Any) -> np.ndarray:
    """All numbers of an answer, however deep."""
    if isinstance(answer, list):
        return np.concatenate([numbers(part) for part in answer]) if answer else np.zeros(0)
    return np.array([answer] if isinstance(answer, float) else [])


def words(answer: Any) -> Any:
    """An answer without its numbers, and all else as it was: verdicts, points, how many events."""
    if isinstance(answer, list):
        return [words(part) for part in answer]
    return None if isinstance(answer, float) else answer


@pytest.mark.skipif(NATIVE is None, reason="plain Python cannot be compared with itself")
def test_plain_python_gives_the_same_answers(cases):
    """To 1e-12 m, and of a turn and a force: some processors round a sum of products once, and Python twice."""
    n_random = cases(2, 30)
    plain, native = asked(None, n_random), asked(NATIVE.level, n_random)
    assert len(plain) > 2 * n_random
    for name, answer in plain.items():
        assert words(answer) == words(native[name]), name
        assert numbers(answer) == pytest.approx(numbers(native[name]), abs=1e-12), name
