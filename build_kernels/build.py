"""The build as a whole: `build`."""

from __future__ import annotations

import os
from pathlib import Path

from cagepose.errors import KernelsError
from cagepose.kernels.native import library


def build(target: Path = library.LIBRARY) -> Path:
    """Compile all kernels and write the library; return where."""
    # Numba shall neither optimise what LLVM optimises as a whole later, nor call Intel's library.
    os.environ.update(NUMBA_OPT="0", NUMBA_DISABLE_INTEL_SVML="1")
    from build_kernels.compile import module_of, take_over
    from build_kernels.link import link

    take_over()
    from build_kernels.entries import entries  # the first import of a kernel

    link(module_of(entries()), library.sources_hash(), target)
    return target


def is_built() -> bool:
    """Whether the library is there and was made of the kernels as they are."""
    try:
        return library.Library(library.LIBRARY).sources_hash == library.sources_hash()
    except KernelsError:
        return False
