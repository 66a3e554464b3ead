"""Where machine code is kept.

The folder's name holds a hash of all that machine code depends on: an edit of any kernel, another release of Numba or
another processor (home folders are shared between machines) starts an empty one. If no folder can be written, kernels
are compiled anew in each process; nothing else changes.
"""

from __future__ import annotations

import hashlib
import os
import sys
import tempfile
from collections.abc import Callable
from functools import cache
from importlib.metadata import version
from pathlib import Path

import llvmlite.binding as llvm

from cagepose.kernels.native.arguments import Kind
from cagepose.kernels.native.jit import Entry
from cagepose.kernels.native.machine_code import MachineCode
from cagepose.kernels.native.object_file import read_object_file

before_compiling: list[Callable[[], None]] = []
"""Called once each, when something is compiled for the first time in this process."""


def load_machine_code(entry: Entry, kinds: tuple[Kind, ...]) -> MachineCode | None:
    """Return machine code for such arguments, from disk or compiled now; None: Numba must call it in its own way."""
    name, path = _place(entry, kinds)
    file = None if path is None else read_object_file(path)
    if file is not None:
        try:
            return MachineCode(file)
        except RuntimeError:  # it asks for a function that only a process with Numba has
            pass
    while before_compiling:
        before_compiling.pop()()
    from cagepose.kernels.native import linking  # here, as it imports Numba

    if not linking.is_tried():
        return None
    file = linking.object_file(entry.dispatcher, kinds, name)
    if path is not None:
        file.write(path)
    return MachineCode(file)


def is_kept(entry: Entry, kinds: tuple[Kind, ...]) -> bool:
    """Whether machine code for such arguments lies on disk."""
    _, path = _place(entry, kinds)
    return path is not None and path.exists()


def _place(entry: Entry, kinds: tuple[Kind, ...]) -> tuple[str, Path | None]:
    """Return the name of an entry's machine code, and where it is kept."""
    name = f"{entry.name}-{hashlib.sha256(repr(kinds).encode()).hexdigest()[:16]}"
    folder = cache_folder()
    return name, None if folder is None else folder / f"{name}.o"


def is_writable() -> bool:
    """Whether what is compiled now will be kept."""
    folder = cache_folder()
    if folder is None:
        return False
    try:
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


@cache
def cache_folder() -> Path | None:
    """Return the folder, or None if there is none. `NUMBA_CACHE_DIR` and `XDG_CACHE_HOME` are respected."""
    chosen = os.environ.get("NUMBA_CACHE_DIR")
    if chosen:
        root = Path(chosen)
    elif sys.platform == "win32":
        root = Path(os.environ.get("LOCALAPPDATA", "~"))
    else:
        root = Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache")
    try:
        folder = root.expanduser() / "cagepose" / f"kernels-{inputs_hash()}"
        folder.mkdir(parents=True, exist_ok=True)
    except (OSError, RuntimeError):  # RuntimeError: no home folder to expand "~" to
        return None
    return folder


def inputs_hash() -> str:
    """Return a hash of all that machine code depends on, beside its arguments."""
    digest = hashlib.sha256()
    # Numba's settings too: with some of them it makes other code.
    settings = sorted(
        item for item in os.environ.items() if item[0].startswith("NUMBA_") and item[0] != "NUMBA_CACHE_DIR"
    )
    processor = (llvm.get_process_triple(), llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten())
    releases = (sys.version_info[:2], version("numba"), version("llvmlite"), version("numpy"))
    digest.update(repr((releases, processor, settings)).encode())
    for source in sorted(Path(__file__).parent.parent.rglob("*.py")):
        digest.update(source.name.encode() + b"\0" + source.read_bytes())
    return digest.hexdigest()[:16]
