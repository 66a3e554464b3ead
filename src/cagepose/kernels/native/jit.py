"""The decorators of all kernels, and how Python calls them.

Machine code comes from the disk if it lies there (`cagepose.kernels.native.cache`), without Numba,
whose import takes longer than a whole run. Numba is imported when there is something to compile, and that is put off
where it would not pay.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import cached_property, update_wrapper
from threading import Lock, RLock, get_ident
from time import perf_counter
from typing import Any, ParamSpec, TypeVar

import numpy as np

from cagepose.kernels.native.arguments import Arguments, Kind

F = TypeVar("F", bound=Callable[..., object])
P = ParamSpec("P")
R = TypeVar("R")

JIT_IS_OFF = os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0")
"""Numba's own switch, read without Numba: kernels are plain Python then."""

PATIENCE_S = 1.0
"""For how long, in a process, a rare kernel is plain Python before it is compiled."""


class OutOfPatienceError(Exception):
    """A rare kernel takes too long as plain Python."""


class _Trial:
    """The call of a rare kernel that is being tried as plain Python: by which thread, and until when."""

    def __init__(self) -> None:
        self.lock = Lock()
        self.thread = 0
        self.until = float("inf")


_TRIAL = _Trial()


class Kernel:
    """A function that other kernels call, as a part of them.

    From Python it is plain Python: for a handful of numbers that is faster than to hand them over.
    """

    def __init__(self, function: Callable[..., object]) -> None:
        update_wrapper(self, function)
        self._function = function
        self.name = function.__name__

    def __call__(self, *arguments: Any) -> Any:
        if perf_counter() > _TRIAL.until and get_ident() == _TRIAL.thread:
            raise OutOfPatienceError
        return self._function(*arguments)

    @cached_property
    def dispatcher(self) -> Any:
        """What Numba compiles where a kernel calls this one."""
        from cagepose.kernels.native import linking  # here, as it imports Numba

        return linking.dispatcher_of(self._function, is_entry=isinstance(self, Entry))

    @property
    def _numba_type_(self) -> Any:
        """Numba asks what it does not know for this."""
        return self.dispatcher._numba_type_


class Entry(Kernel):
    """A kernel that is machine code for Python too."""

    def __init__(self, function: Callable[..., object]) -> None:
        super().__init__(function)
        self.loaded = dict[tuple[Kind, ...], Any]()
        """Machine code for each kind of arguments that it was called with."""

    def __call__(self, *arguments: Any) -> Any:
        if get_ident() == _TRIAL.thread:  # as a part of a rare kernel
            return super().__call__(*arguments)
        return self.bound(*arguments)()

    def bound(self, *arguments: Any) -> Callable[..., Any]:
        """See `bound`."""
        taken = Arguments(arguments)
        if taken.kinds not in self.loaded:
            with _LOADING:
                if taken.kinds not in self.loaded:
                    self.loaded[taken.kinds] = self._load(taken.kinds)
        code = self.loaded[taken.kinds]
        return _bound_in_python(self.dispatcher, arguments) if code is None else code.bound(taken, arguments)

    def _load(self, kinds: tuple[Kind, ...]) -> Any:
        from cagepose.kernels.native.cache import load_machine_code  # here, as LLVM takes a while too

        return load_machine_code(self, kinds)


class RareEntry(Entry):
    """An entry that is compiled when it has taken `PATIENCE_S` as plain Python: see `rare_kernel`."""

    def __init__(self, function: Callable[..., object]) -> None:
        super().__init__(function)
        self.patience_s = PATIENCE_S
        self._may_be_kept = True

    def __call__(self, *arguments: Any) -> Any:
        is_part = get_ident() == _TRIAL.thread
        if not is_part and self.patience_s > 0.0 and not self.loaded and not self._is_kept(arguments):
            with _TRIAL.lock:  # one at a time: `until` is one thread's; others wait for no more than their patience
                try:
                    return self._try_in_python(arguments)
                except (OutOfPatienceError, ArithmeticError, ValueError):  # machine code knows infinities and NaN
                    self.patience_s = 0.0
        return super().__call__(*arguments)

    def _is_kept(self, arguments: tuple[Any, ...]) -> bool:
        if not self._may_be_kept:  # a look at the disk takes longer than many a call
            return False
        from cagepose.kernels.native.cache import is_kept

        self._may_be_kept = is_kept(self, Arguments(arguments).kinds)
        return self._may_be_kept

    def _try_in_python(self, arguments: tuple[Any, ...]) -> Any:
        began = perf_counter()
        _TRIAL.thread, _TRIAL.until = get_ident(), began + self.patience_s
        try:
            with np.errstate(all="ignore"):
                return self._function(*arguments)
        finally:
            _TRIAL.thread, _TRIAL.until = 0, float("inf")
            self.patience_s -= perf_counter() - began


_LOADING = RLock()


def kernel(function: F) -> F:
    """Compile a function where other kernels call it, as a part of them."""
    return function if JIT_IS_OFF else Kernel(function)  # type: ignore[return-value]


def entry_kernel(function: F) -> F:
    """Compile a function for Python too, and keep it on disk."""
    return function if JIT_IS_OFF else Entry(function)  # type: ignore[return-value]


def rare_kernel(function: F) -> F:
    """Compile a function for Python too, but not before it has taken a second as plain Python in this process.

    It is for what is called once or twice for each answer: to compile it takes as long as a thousand calls. It must
    not read what it has written before, as a call that takes too long is made again.
    """
    return function if JIT_IS_OFF else RareEntry(function)  # type: ignore[return-value]


def bound(entry: Callable[P, R], *arguments: P.args, **_: P.kwargs) -> Callable[..., R]:
    """Return a call of a kernel with these arguments, its machine code loaded; for one thread at a time.

    To take thirty arrays apart takes as long as a run, so that is done here once. The call takes the first of the
    arguments anew, if they are numbers.
    """
    if isinstance(entry, Entry):
        return entry.bound(*arguments)
    return _bound_in_python(entry, arguments)


def _bound_in_python(function: Callable[..., R], arguments: tuple[Any, ...]) -> Callable[..., R]:
    return lambda *first: function(*first, *arguments[len(first) :])
