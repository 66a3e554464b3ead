"""From entries to one module of LLVM: each entry as a C function, with all that it calls.

The C function is ``int32_t name(int64_t *slots, double *the_same)``. `cagepose.kernels.native.slots` says what stands
in the slots; results follow behind the arguments. It returns 0, or another number if the kernel raised an exception.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import llvmlite.binding as llvm
import numpy as np
from numba import carray, types
from numba.extending import intrinsic
from numba.np.numpy_support import from_dtype

from build_kernels import kept
from build_kernels.compile import KernelLibrary, compiled_when_called, kernels, set_up_numba
from cagepose.kernels.native.slots import Slots

Signature = tuple[str, str]
"""What an entry takes, as `Slots.kinds`, and gives, as letters of `struct`."""
LINKED_AT_ONCE = 16
"""Linking into a large module takes as long as the module is large, so modules are linked a few at a time."""


class Module(NamedTuple):
    """LLVM's module of all entries, not yet optimised, their signatures, and a name for what is in it."""

    llvm_module: llvm.ModuleRef
    signatures: dict[str, Signature]
    digest: str


def module_of(
    entries: Iterable[tuple[Any, tuple[object, ...]]], progress: Callable[[int, int], None] | None = None
) -> Module:
    """Compile entries, each given with arguments of the types that it will be called with.

    ``progress`` is told how many kernels are ready, and about how many there are.
    """
    set_up_numba()
    texts, signatures, libraries = list[str](), dict[str, Signature](), dict[int, KernelLibrary]()
    for entry, arguments in entries:
        text, signatures[entry.__name__], library = _c_function(entry, arguments)
        texts.append(text)
        if progress:
            progress(sum(len(made.overloads) for made in kernels.values()), len(kernels))
        _add_all_called(library, libraries)
    modules = [llvm.parse_assembly(text) for text in texts]
    modules += [library._final_module for library in libraries.values()]
    whole = _linked(modules)
    for value in (*whole.functions, *whole.global_variables):
        if not value.is_declaration and value.name not in signatures:
            value.linkage = "internal"  # so that what is called from one place only is taken in there
    whole.verify()
    digest = kept.digest_of(*texts, *sorted(library.digest for library in libraries.values()))
    return Module(whole, signatures, digest)


def _add_all_called(library: KernelLibrary, found: dict[int, KernelLibrary]) -> None:
    """Add a kernel's library and those of all that it calls."""
    if id(library) not in found:
        found[id(library)] = library
        for called in library.called or ():
            _add_all_called(called, found)


def _linked(modules: list[llvm.ModuleRef]) -> llvm.ModuleRef:
    while len(modules) > 1:
        groups = [modules[start : start + LINKED_AT_ONCE] for start in range(0, len(modules), LINKED_AT_ONCE)]
        for first, *others in groups:
            for other in others:
                first.link_in(other)
        modules = [group[0] for group in groups]
    return modules[0]


@intrinsic  # type: ignore[untyped-decorator]
def _pointer(_context: Any, _address: Any) -> Any:
    """Return the pointer that an integer is."""

    def code(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        return builder.inttoptr(arguments[0], context.get_value_type(types.voidptr))

    return types.voidptr(types.int64), code


class _Source:
    """Python source that makes arguments from slots."""

    def __init__(self) -> None:
        self.names: dict[str, Any] = {"carray": carray, "pointer": _pointer}
        self.n_slots = 0

    def _slot(self) -> int:
        self.n_slots += 1
        return self.n_slots - 1

    def _named(self, value: object) -> str:
        name = f"value{len(self.names)}"
        self.names[name] = value
        return name

    def argument(self, value: object) -> str:
        if isinstance(value, np.ndarray):
            address = self._slot()
            shape = ", ".join(f"slots[{self._slot()}]" for _ in range(value.ndim))
            return f"carray(pointer(slots[{address}]), ({shape},), {self._named(value.dtype)})"
        if isinstance(value, np.void):
            return f"carray(pointer(slots[{self._slot()}]), 1, {self._named(value.dtype)})[0]"
        if isinstance(value, tuple):
            parts = ", ".join([self.argument(part) for part in value])
            return f"({parts},)" if type(value) is tuple else f"{self._named(type(value))}({parts})"
        slot = self._slot()
        if isinstance(value, bool):
            return f"slots[{slot}] != 0"
        return f"slots[{slot}]" if isinstance(value, int) else f"floats[{slot}]"


def _c_function(entry: Any, arguments: tuple[object, ...]) -> tuple[str, Signature, KernelLibrary]:
    """Return LLVM's text of a C function, its signature, and the library of what it calls."""
    source = _Source()
    call = ", ".join([source.argument(value) for value in arguments])
    argument_types = tuple(_type_of(value) for value in arguments)
    entry.compile(argument_types)
    gives = _results(entry.overloads[argument_types].signature.return_type)
    lines = [f"def {entry.__name__}(slots, floats):", f"    found = entry({call})"]
    for place, letter in enumerate(gives):
        array = "floats" if letter == "d" else "slots"
        value = f"found[{place}]" if _is_tuple(entry, argument_types) else "found"
        lines.append(f"    {array}[{source.n_slots + place}] = {value}")
    names = source.names | {"entry": entry, "__name__": "c"}
    exec("\n".join(lines), names, made := dict[str, Any]())
    function = compiled_when_called(made[entry.__name__])
    kernels[f"c.{entry.__name__}"] = function
    pointers = (types.CPointer(types.int64), types.CPointer(types.float64))
    function.compile(pointers)
    result = function.overloads[pointers]
    text = _EXPORTED.format(name=entry.__name__, inner=result.fndesc.mangled_name)
    takes = "".join([Slots(value).kinds for value in arguments])
    return text, (takes, gives), result.library


_EXPORTED = """
declare i32 @"{inner}"(ptr, ptr, ptr, ptr)

define i32 @"{name}"(ptr %slots, ptr %floats) {{
  %result = alloca ptr
  %exception = alloca ptr
  %status = call i32 @"{inner}"(ptr %result, ptr %exception, ptr %slots, ptr %floats)
  ret i32 %status
}}
"""
"""Numba's own calling convention, without the wrapper that needs Python."""


def _is_tuple(entry: Any, argument_types: tuple[Any, ...]) -> bool:
    return isinstance(entry.overloads[argument_types].signature.return_type, types.BaseTuple)


def _results(given: Any) -> str:
    """Return the letters of what an entry returns: nothing, a number, or a tuple of numbers."""
    if given == types.none:
        return ""
    letters = {types.float64: "d", types.int64: "q", types.boolean: "?"}
    return "".join(letters[part] for part in (given if isinstance(given, types.BaseTuple) else [given]))


def _type_of(value: object) -> Any:
    if isinstance(value, np.ndarray):
        return types.Array(from_dtype(value.dtype), value.ndim, "C")
    if isinstance(value, np.void):
        return from_dtype(value.dtype)
    if isinstance(value, tuple):
        return types.BaseTuple.from_types(tuple(_type_of(part) for part in value), type(value))
    if isinstance(value, bool):
        return types.boolean
    return types.int64 if isinstance(value, int) else types.float64
