"""The library of machine code that is built with the program: finding it, and choosing what fits the processor.

It holds each entry once for each level of the processor family, such as x86-64-v2 and v3 (with AVX2 and FMA), and a
text that says which, and what each takes and gives. ``build_kernels`` writes both.
"""

from __future__ import annotations

import ctypes
import hashlib
import json
import os
import struct
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path

from cagepose.errors import KernelsError

VARIABLE = "CAGEPOSE_KERNELS"
"""The environment variable that chooses: "python" for plain Python, a level such as "x86-64-v2" for its machine code;
empty or missing: the best that the processor can run."""
PLAIN_PYTHON = "python"
KERNELS = Path(__file__).resolve().parent.parent
FILE_NAME = {"win32": "kernels.dll", "darwin": "kernels.dylib"}.get(sys.platform, "kernels.so")
LIBRARY = Path(__file__).resolve().parent / FILE_NAME
Machine = Callable[..., int]
"""Machine code of an entry: ``int32_t name(int64_t *slots, double *the_same)``."""
STATUS_STOPPED = -130
"""Status of a call that was stopped, see ``build_kernels/interrupt.c``."""
REMEDY = f"build it with `make setup` (`pip install` does too), or set {VARIABLE}={PLAIN_PYTHON} for slow plain Python"


class Library:
    """Machine code in this process.

    Attributes
    ----------
    signatures
        For each entry what it takes, as `Slots.kinds`, and what it gives, as letters of `struct`.
    levels
        Those that it holds; a checkout builds the one of its own processor.
    level
        Whose machine code is used.
    call_until, call_until_interrupt
        Call a function of `function` until a number in memory is not zero, or until Ctrl-C is pressed:
        ``(address, function, slots)`` and ``(function, slots)``; either gives its status, or STATUS_STOPPED.

    Raises
    ------
    KernelsError
        There is no such file, it cannot be loaded, or it has no such level.
    """

    def __init__(self, path: Path, level: str = "") -> None:
        if not path.exists():
            raise KernelsError(f"{path}: the library of kernels is missing; {REMEDY}")
        try:
            _check_whole(path)
            self._library = ctypes.CDLL(str(path))
        except OSError as error:
            raise KernelsError(f"{path}: the library of kernels cannot be loaded ({error}); {REMEDY}") from None
        try:
            described = ctypes.c_char_p.in_dll(self._library, "cagepose_description").value or b""
            description = json.loads(described)
            levels: list[str] = description["levels"]
            self.levels: list[str] = description["built"]
            self.signatures: dict[str, tuple[str, str]] = description["signatures"]
            self.sources_hash: str = description["sources"]
        except (ValueError, KeyError) as error:
            raise KernelsError(f"{path}: this is no library of kernels ({error}); {REMEDY}") from None
        best = self._library.cagepose_best_level()
        can_run = [name for name in levels[: best + 1] if name in self.levels]
        if not can_run:
            raise KernelsError(f"this processor is older than {self.levels[0]}; set {VARIABLE}={PLAIN_PYTHON}")
        if level and level not in can_run:
            raise KernelsError(
                f"{VARIABLE}={level} is not for this processor; choose {PLAIN_PYTHON} or one of {', '.join(can_run)}"
            )
        self.level = level or can_run[-1]
        self.call_until, self.call_until_interrupt = (
            self._library.cagepose_call_until,
            self._library.cagepose_call_until_interrupt,
        )
        self.call_until.argtypes = [ctypes.c_void_p] * 3
        self.call_until_interrupt.argtypes = [ctypes.c_void_p] * 2

    def function(self, name: str) -> Machine:
        """Return the machine code of an entry."""
        found: Machine = self._library[f"{name}.{self.level}"]
        return found


def _check_whole(path: Path) -> None:
    """Refuse an ELF file (Linux) that ends before its table of sections: loading half a file ends the process."""
    with path.open("rb") as file:
        head = file.read(64)
    if head.startswith(b"\x7fELF") and len(head) == 64:
        (table,), (size, n_sections) = struct.unpack_from("<Q", head, 40), struct.unpack_from("<HH", head, 58)
        if path.stat().st_size < table + size * n_sections:
            raise OSError("the file is cut off")


@cache
def kernel_library() -> Library | None:
    """Return the program's own library; None: kernels are plain Python, as the environment asks.

    Raises
    ------
    KernelsError
        As for `Library`, or it was built from other sources than those beside it.
    """
    chosen = os.environ.get(VARIABLE, "")
    if chosen == PLAIN_PYTHON:
        return None
    library = Library(LIBRARY, chosen)
    if is_checkout() and library.sources_hash != sources_hash():  # by content: dates tell little after a git checkout
        raise KernelsError(f"{LIBRARY}: kernels have changed since the library was built; {REMEDY}")
    return library


def is_checkout() -> bool:
    """Whether the program runs from its source tree, where kernels may change."""
    return (KERNELS.parents[2] / "build_kernels").is_dir()


def sources() -> list[Path]:
    """Return the files, in a source tree, that decide what the library is: kernels, how they are built, how called."""
    kernels = [path for path in KERNELS.rglob("*.py") if path.parent != LIBRARY.parent]
    build = (KERNELS.parents[2] / "build_kernels").glob("*.[pc]*")
    return sorted([*kernels, LIBRARY.with_name("slots.py"), *build])


def sources_hash() -> str:
    """Return a hash of the sources."""
    digest = hashlib.sha256()
    for path in sources():
        digest.update(path.relative_to(KERNELS.parents[2]).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()
