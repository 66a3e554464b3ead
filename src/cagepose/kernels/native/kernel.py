"""The two decorators of all kernels.

Kernels are plain Python, and other kernels call them as such. What the rest of the program calls is an `Entry`: it runs
as machine code from the library that was built with the program (``build_kernels``).
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from ctypes import create_string_buffer
from functools import cached_property, update_wrapper
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.native.interrupt import is_heard_here
from cagepose.kernels.native.library import STATUS_STOPPED, Library, Machine, kernel_library
from cagepose.kernels.native.slots import Slots

F = TypeVar("F", bound=Callable[..., object])
R = TypeVar("R")

compiler: Callable[[Callable[..., Any]], Any] | None = None
"""What the build puts in the place of both decorators; it must do so before the first kernel is imported."""


class Entry(Generic[R]):
    """A kernel that the rest of the program calls.

    An argument is a number, a tuple or an array, or `Slots` that were made of one beforehand: taking apart a scene
    takes as long as running it.
    """

    def __init__(self, function: Callable[..., R]) -> None:
        update_wrapper(self, function)
        self.python = function
        """The kernel as plain Python."""
        self.name = function.__name__
        self.library: Library | None = kernel_library()
        """Where its machine code is; None: it is plain Python."""

    @cached_property
    def _native(self) -> tuple[Machine, str, struct.Struct]:
        assert self.library is not None
        takes, gives = self.library.signatures[self.name]
        return self.library.function(self.name), takes, struct.Struct("=" + gives)

    def __call__(self, *arguments: Any) -> R:
        return self.until(None, *arguments)

    def until(self, stop: NDArray[np.int64] | None, *arguments: Any) -> R:
        """Call the kernel, from any thread, until it ends or ``stop``, (1,), is not zero.

        Without ``stop`` a call from the main thread ends with Ctrl-C.

        Raises
        ------
        KeyboardInterrupt
            It was stopped. What it was to fill is half filled.
        TypeError
            Arguments that it does not take.
        """
        if self.library is None:
            return self.python(*[part.value if type(part) is Slots else part for part in arguments])
        function, takes, gives = self._native
        taken = [part if type(part) is Slots else Slots(part) for part in arguments]
        kinds = "".join([part.kinds for part in taken])
        if kinds != takes:
            raise TypeError(f"the kernel {self.name} takes {takes}, and was given {kinds}")
        packed = b"".join([part.packed for part in taken])
        memory = create_string_buffer(packed, len(packed) + gives.size)
        if stop is not None:
            status = self.library.call_until(stop.ctypes.data, function, memory)
        elif is_heard_here():
            status = self.library.call_until_interrupt(function, memory)
        else:
            status = function(memory, memory)
        if status == STATUS_STOPPED:
            raise KeyboardInterrupt
        if status:
            raise RuntimeError(f"the kernel {self.name} failed: it raised an exception")
        found = gives.unpack_from(memory, len(packed))
        return found[0] if len(found) == 1 else found or None  # type: ignore[return-value]


def kernel(function: F) -> F:
    """Mark a function that other kernels call."""
    return function if compiler is None else compiler(function)


def entry(function: Callable[..., R]) -> Entry[R]:
    """Mark a kernel that the rest of the program calls too."""
    return Entry(function) if compiler is None else compiler(function)
