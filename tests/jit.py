"""Running kernels from tests, compiled or not."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba

from cagepose.kernels.native.jit import JIT_IS_OFF


def callable_kernel(kernel: Callable[..., Any]) -> Callable[..., Any]:
    """The machine code of a kernel, which is plain Python when Python calls it."""
    if JIT_IS_OFF:
        return kernel

    @numba.njit
    def call(*arguments):
        return kernel(*arguments)

    return call


def cases(n_compiled: int) -> int:
    """How many random cases to run: interpreted kernels are about a hundred times slower."""
    return max(10, n_compiled // 20) if JIT_IS_OFF else n_compiled
