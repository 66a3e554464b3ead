"""The two decorators of all kernels, and where their machine code is kept.

Numba's own disk cache looks only at the file of the function it compiles: edit a callee in another file and stale code
runs. So the cache folder's name holds a hash of all kernel sources, and an edit anywhere starts an empty one. If no
folder can be written, kernels are compiled anew in each process; nothing else changes.
"""

from __future__ import annotations

import hashlib
import os
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numba

F = TypeVar("F", bound=Callable[..., object])


def _source_hash() -> str:
    digest = hashlib.sha256()
    digest.update(f"{sys.version_info[:2]} {numba.__version__}".encode())
    for source in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(source.name.encode() + b"\0" + source.read_bytes())
    return digest.hexdigest()[:16]


def _cache_folder() -> Path | None:
    """Return a folder that can be written, or None. `NUMBA_CACHE_DIR` and `XDG_CACHE_HOME` are respected."""
    chosen = os.environ.get("NUMBA_CACHE_DIR")
    if chosen:
        root = Path(chosen)
    elif sys.platform == "win32":
        root = Path(os.environ.get("LOCALAPPDATA", "~"))
    else:
        root = Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache")
    try:
        folder = root.expanduser() / "cagepose" / f"kernels-{_source_hash()}"
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except (OSError, RuntimeError):  # RuntimeError: no home folder to expand "~" to
        return None
    return folder


CACHE_FOLDER = None if numba.config.DISABLE_JIT else _cache_folder()


def kernel(function: F) -> F:
    """Compile a function that only other kernels call, as a part of them."""
    if numba.config.DISABLE_JIT:
        return function
    from cagepose.kernels.linking import LinkedCompiler, is_tried

    if is_tried():
        return _compiled(function, cache=False, pipeline_class=LinkedCompiler, no_cpython_wrapper=True)
    return _compiled(function, cache=CACHE_FOLDER is not None, no_cpython_wrapper=True)


def entry_kernel(function: F) -> F:
    """Compile a function that Python calls too, and keep it on disk."""
    if numba.config.DISABLE_JIT:
        return function
    from cagepose.kernels.linking import EntryCompiler, is_tried

    options = {"pipeline_class": EntryCompiler} if is_tried() else {}
    return _compiled(function, cache=CACHE_FOLDER is not None, **options)


def _compiled(function: F, **options: Any) -> F:
    """No Python objects, no GIL, IEEE arithmetic; no counting of references, since kernels make no arrays."""
    # Numba reads its setting when the decorator runs; ours must not leak to other users of Numba in this process.
    previous = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = "" if CACHE_FOLDER is None else str(CACHE_FOLDER)
    try:
        compiled: F = numba.njit(nogil=True, error_model="numpy", no_cfunc_wrapper=True, _nrt=False, **options)(
            function
        )
    finally:
        numba.config.CACHE_DIR = previous
    return compiled


def is_loaded(entry: Callable[..., object]) -> bool:
    """Whether calling a kernel runs at once, without compiling it or reading it from disk first."""
    return bool(getattr(entry, "signatures", True))


_MACHINE_CODE: dict[Callable[..., object], Any] = {}


def machine_code(entry: F) -> F:
    """Return a loaded kernel without the search for one that fits the types of its arguments.

    That search takes 20 us, half as long as a run. So whoever calls the machine code gives the same types each time.
    """
    overloads = getattr(entry, "overloads", {})
    if len(overloads) != 1:
        return entry
    if entry not in _MACHINE_CODE:  # to look into ``overloads`` takes longer than a run: each look hashes all types
        _MACHINE_CODE[entry] = next(iter(overloads.values())).entry_point
    found: F = _MACHINE_CODE[entry]
    return found


def is_compiled(entry_name: str) -> bool:
    """Whether the machine code of the kernel ``entry_name`` lies on disk (or none is needed)."""
    if numba.config.DISABLE_JIT:
        return True
    return CACHE_FOLDER is not None and any(CACHE_FOLDER.rglob(f"*{entry_name}*.nbc"))
