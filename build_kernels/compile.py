"""From kernels to LLVM: one module that holds each entry as a C function, with all that it calls.

Numba would make machine code of each kernel by itself, with a copy of all that it calls, which takes three times as
long as everything else. `_OwnModule` keeps it from that; this is the one place that reaches into Numba, whose release
is therefore pinned (docs/decisions/0016-built-kernels).

The C function is ``int32_t name(int64_t *slots, double *the_same)``. `cagepose.kernels.native.slots` says what stands
in the slots; results follow behind the arguments. It returns 0, or another number if the kernel raised an exception.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, ClassVar, NamedTuple

import llvmlite.binding as llvm
import numba
import numpy as np
from numba import carray, types
from numba.core import codegen
from numba.extending import intrinsic
from numba.np.numpy_support import from_dtype

from cagepose.kernels.native import interrupt, kernel
from cagepose.kernels.native.slots import Slots

Signature = tuple[str, str]
"""What an entry takes, as `Slots.kinds`, and gives, as letters of `struct`."""


def compile_kernel(function: Callable[..., Any]) -> Any:
    """Stand in for the decorators of kernels: no Python objects, no GIL, IEEE arithmetic.

    Kernels make no arrays, so that references need not be counted (``_nrt``).
    """
    options = {"nogil": True, "error_model": "numpy", "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    return numba.njit(_nrt=False, **options)(function)


_is_stopped = types.ExternalFunction("cagepose_is_stopped", types.int32())
"""In ``interrupt.c``."""


@compile_kernel
def heed_interrupt() -> None:
    """End the call of a kernel if it is to end: each function that calls another hands its exception on."""
    if _is_stopped() != 0:
        raise InterruptedError


def take_over() -> None:
    """Put what the build makes in the place of what kernels import, before the first of them is imported."""
    kernel.compiler, interrupt.heed_interrupt = compile_kernel, heed_interrupt


class Module(NamedTuple):
    """LLVM's module of all entries, not yet optimised, and their signatures."""

    llvm_module: llvm.ModuleRef
    signatures: dict[str, Signature]


def module_of(entries: Iterable[tuple[Any, tuple[object, ...]]]) -> Module:
    """Compile entries, each given with arguments of the types that it will be called with."""
    whole, signatures = llvm.parse_assembly(""), dict[str, Signature]()
    numba.njit(_nothing)()  # so that Numba has set up what it runs with
    codegen.JITCPUCodegen._library_class = _OwnModule
    codegen.JITCPUCodegen.set_env = lambda *_: None
    for entry, arguments in entries:
        text, signatures[entry.__name__] = _c_function(entry, arguments)
        whole.link_in(llvm.parse_assembly(text))
    for part in _OwnModule.parts:
        for function in part.functions:
            if not function.is_declaration:
                function.linkage = "weak_odr"  # functions of one name are the same, and all are taken in
        whole.link_in(part)
    for value in (*whole.functions, *whole.global_variables):
        if not value.is_declaration and value.name not in signatures:
            value.linkage = "internal"  # so that what is called from one place only is taken in there
    whole.verify()
    return Module(whole, signatures)


def _nothing() -> None:
    pass


class _OwnModule(codegen.JITCodeLibrary):  # type: ignore[misc]
    """The LLVM module of one kernel, without what it calls, and without machine code."""

    parts: ClassVar[list[llvm.ModuleRef]] = []

    def _optimize_functions(self, ll_module: Any) -> None:
        ll_module.data_layout = self._codegen._data_layout

    def finalize(self) -> None:
        self._finalize_dynamic_globals()
        self._finalized = True
        self.parts.append(self._final_module)
        for library in self._linking_libraries:
            if not isinstance(library, _OwnModule):  # Numba's own, made before
                self.parts.append(library._get_module_for_linking().clone())

    def get_pointer_to_function(self, _name: str) -> int:
        self._ensure_finalized()
        return 0


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


def _c_function(entry: Any, arguments: tuple[object, ...]) -> tuple[str, Signature]:
    """Return LLVM's text of a C function, and its signature."""
    source = _Source()
    call = ", ".join([source.argument(value) for value in arguments])
    argument_types = tuple(_type_of(value) for value in arguments)
    entry.compile(argument_types)
    gives = _results(entry.overloads[argument_types].signature.return_type)
    lines = ["def c_function(slots, floats):", f"    found = entry({call})"]
    for place, letter in enumerate(gives):
        array = "floats" if letter == "d" else "slots"
        value = f"found[{place}]" if _is_tuple(entry, argument_types) else "found"
        lines.append(f"    {array}[{source.n_slots + place}] = {value}")
    exec("\n".join(lines), source.names | {"entry": entry}, made := dict[str, Any]())
    function = numba.njit(nogil=True, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)(
        made["c_function"]
    )
    pointers = (types.CPointer(types.int64), types.CPointer(types.float64))
    function.compile(pointers)
    inner = function.overloads[pointers].fndesc.mangled_name
    text = _EXPORTED.format(name=entry.__name__, inner=inner)
    takes = "".join([Slots(value).kinds for value in arguments])
    return text, (takes, gives)


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
