"""Running kernels from tests, as machine code or not."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cagepose.kernels.native.library import kernel_library

JIT_IS_OFF = kernel_library() is None


def callable_kernel(kernel: Callable[..., Any]) -> Callable[..., Any]:
    return kernel


def cases(n_compiled: int) -> int:
    """How many random cases to run: interpreted kernels are about a hundred times slower."""
    return max(10, n_compiled // 20) if JIT_IS_OFF else n_compiled
