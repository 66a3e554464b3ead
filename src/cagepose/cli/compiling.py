"""What is said while the kernels compile."""

from __future__ import annotations

import sys

FIRST_RUN = "cagepose: compiling the kernels for the first time on this machine; about half a minute, only once\n"
EVERY_RUN = (
    "cagepose: compiling the kernels, about half a minute, at each start: no folder for machine code can be written;"
    " let NUMBA_CACHE_DIR name one that can\n"
)


def say_if_compiling(method: str) -> None:
    """Tell on standard error why a first run takes long."""
    from cagepose.kernels.jit import CACHE_FOLDER
    from cagepose.runs.solve import kernels_are_compiled

    if not kernels_are_compiled(method):
        sys.stderr.write(EVERY_RUN if CACHE_FOLDER is None else FIRST_RUN)
        sys.stderr.flush()
