"""Machine code in this process: loaded by LLVM's linker, called through ctypes, with no Numba."""

from __future__ import annotations

import ctypes
import struct
from collections.abc import Callable, Iterator
from functools import cache
from itertools import count
from typing import Any

import llvmlite.binding as llvm

from cagepose.kernels.native.arguments import FLOAT, INTEGER, TRUTH, Arguments
from cagepose.kernels.native.object_file import ObjectFile

_FUNCTION = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.c_void_p)  # it lets go of the interpreter's lock
_NUMBERS = count()


class MachineCode:
    """A function that is ready to be called.

    Raises
    ------
    RuntimeError
        The file asks for a function that this process does not have.
    """

    def __init__(self, file: ObjectFile) -> None:
        linker = llvm.JITLibraryBuilder().add_object_img(file.code).add_current_process().export_symbol(file.name)
        self._tracker = linker.link(_compiler(), f"{file.name}.{next(_NUMBERS)}")  # the code lives as long as this
        self._function = _FUNCTION(self._tracker[file.name])
        self._name, self._results = file.name, file.results
        letters = "".join(_letters(file.results))
        self._is_flat = isinstance(file.results, list) and all(part in (FLOAT, INTEGER) for part in file.results)
        self._unpack = struct.Struct("=" + letters.replace(TRUTH, "q")).unpack_from
        self._room = bytes(8 * len(letters))

    def bound(self, arguments: Arguments, owner: object) -> Callable[..., Any]:
        """Return a call with these arguments, the first of which, if they are numbers, can be given anew.

        It is for one thread at a time. ``owner`` keeps alive the arrays whose addresses are among the arguments.
        """
        formats = "".join(arguments.formats)
        slots = bytearray(struct.pack(f"={formats}", *arguments.slots) + self._room)
        memory = ctypes.c_char.from_buffer(slots)
        address = ctypes.addressof(memory)
        first_result = 8 * len(formats)
        pointers = (address, address + first_result)
        function, name, results, unpack = self._function, self._name, self._results, self._unpack
        is_flat, packers = self._is_flat, dict[int, Callable[..., None]]()

        def call(*first: int | float) -> Any:
            if first:
                n_first = len(first)
                if n_first not in packers:
                    packers[n_first] = struct.Struct(f"={formats[:n_first]}").pack_into
                packers[n_first](slots, 0, *first)
            if function(*pointers):
                raise RuntimeError(f"the kernel {name} failed: it raised an exception")
            if results is None:
                return None
            numbers = unpack(slots, first_result)
            return numbers if is_flat else _shaped(results, iter(numbers))

        call.__dict__["keeps"] = (owner, memory, self)
        return call


def _letters(results: Any) -> Iterator[str]:
    if isinstance(results, list):
        for part in results:
            yield from _letters(part)
    elif results is not None:
        yield results


def _shaped(results: Any, numbers: Iterator[int | float]) -> Any:
    if isinstance(results, list):
        return tuple(_shaped(part, numbers) for part in results)
    number = next(numbers)
    return bool(number) if results == TRUTH else number


@cache
def _compiler() -> Any:
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    return llvm.create_lljit_compiler(suppress_errors=True)  # errors are raised too
