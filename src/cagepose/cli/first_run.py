"""Say so when kernels are about to be compiled: it takes a while, once."""

from __future__ import annotations

import sys

FIRST_RUN = "cagepose: compiling for the first time on this machine: 10 s to a minute, only once\n"
EVERY_RUN = (
    "cagepose: compiling, 10 s to a minute, at each start: no folder for machine code can be written;"
    " let NUMBA_CACHE_DIR name one that can\n"
)


def announce_compilation() -> None:
    """From now on, write a line to standard error when something is compiled for the first time."""
    from cagepose.kernels.native import cache

    cache.before_compiling[:] = [_say_so]


def _say_so() -> None:
    from cagepose.kernels.native.cache import is_writable

    sys.stderr.write(FIRST_RUN if is_writable() else EVERY_RUN)
    sys.stderr.flush()
