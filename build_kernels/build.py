"""The build as a whole: `build`."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from build_kernels.levels import LEVELS
from cagepose.errors import KernelsError
from cagepose.kernels.native import library


def build(target: Path = library.LIBRARY, *, all_levels: bool = False) -> Path:
    """Compile all kernels and write the library, for this machine's level of processors or for all; return where."""
    # Numba shall neither optimise what LLVM optimises as a whole later, nor call Intel's library.
    os.environ.update(NUMBA_OPT="0", NUMBA_DISABLE_INTEL_SVML="1")
    from build_kernels.c_functions import module_of
    from build_kernels.compile import take_over
    from build_kernels.kept import remove_unused
    from build_kernels.link import link, own_level

    began = time.perf_counter()

    def say(text: str) -> None:
        sys.stderr.write(f"  {time.perf_counter() - began:4.0f} s  {text}\n")
        sys.stderr.flush()

    take_over()
    from build_kernels.entries import entries  # the first import of a kernel

    module = module_of(entries(), lambda n_ready, n_kernels: say(f"{n_ready} of about {n_kernels} kernels are ready"))
    levels: Sequence[str] = LEVELS if all_levels else (own_level(),)
    say(f"optimising them as a whole for {' and '.join(levels)}")
    link(module, levels, library.sources_hash(), target)
    remove_unused()
    return target


def is_built(*, all_levels: bool = False) -> bool:
    """Whether the library is there and was made of the kernels as they are, for all levels of processors if asked."""
    try:
        found = library.Library(library.LIBRARY)
    except KernelsError:
        return False
    return found.sources_hash == library.sources_hash() and (not all_levels or found.levels == list(LEVELS))
