"""Say so when kernels are about to be compiled: it takes a while, once."""

from __future__ import annotations

import sys
from collections.abc import Iterable

FIRST_RUN = "cagepose: compiling the kernels for the first time on this machine; about a minute, only once\n"
EVERY_RUN = (
    "cagepose: compiling the kernels, about a minute, at each start: no folder for machine code can be written;"
    " let NUMBA_CACHE_DIR name one that can\n"
)


def announce_compilation(methods: Iterable[str]) -> None:
    """Write a line to standard error if the first run by one of ``methods`` will compile."""
    from cagepose.runs.solve import kernels_are_compiled

    announce_kernels(all(kernels_are_compiled(method) for method in methods))


def announce_kernels(are_compiled: bool) -> None:
    """Write that line unless the kernels that are needed are compiled."""
    from cagepose.kernels.cache import cache_folder

    if not are_compiled:
        sys.stderr.write(EVERY_RUN if cache_folder() is None else FIRST_RUN)
        sys.stderr.flush()
