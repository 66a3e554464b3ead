"""A kernel as a C function: ``int32_t name(const int64_t *arguments, int64_t *results)``.

`Arguments` says what stands in the slots of the arguments. A result is a number, a tuple of results or nothing; each
number fills a slot. The function returns 0, or another number if the kernel raised an exception.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from llvmlite import ir
from numba.core import types
from numba.np.arrayobj import get_itemsize, populate_array
from numba.np.numpy_support import from_dtype

from cagepose.kernels.native.arguments import FLOAT, INTEGER, TRUTH, ArrayKind, Kind, RecordKind

SLOT = ir.IntType(64)


def add_c_function(library: Any, context: Any, kernel: Any, name: str) -> None:
    """Add the function to a library that the kernel is linked into; ``kernel`` is Numba's descriptor of it."""
    module = library.create_ir_module(name)
    pointer = SLOT.as_pointer()
    function = ir.Function(module, ir.FunctionType(ir.IntType(32), (pointer, pointer)), name)
    builder = ir.IRBuilder(function.append_basic_block("entry"))
    slots = _loaded(builder, function.args[0])
    arguments = [_argument(context, builder, wanted, slots) for wanted in kernel.argtypes]
    callee = context.declare_function(module, kernel)
    status, result = context.call_conv.call_function(builder, callee, kernel.restype, kernel.argtypes, arguments)
    for place, number in enumerate(_numbers(builder, kernel.restype, result)):
        builder.store(number, builder.gep(function.args[1], [SLOT(place)]))
    builder.ret(status.code)
    library.add_ir_module(module)


def type_of(kind: Kind) -> Any:
    """Return what Numba calls arguments of a kind."""
    if isinstance(kind, ArrayKind):
        return types.Array(from_dtype(kind.dtype), kind.n_axes, kind.layout, readonly=not kind.is_writable)
    if isinstance(kind, RecordKind):
        return from_dtype(kind.dtype)
    if isinstance(kind, str):
        return {FLOAT: types.float64, INTEGER: types.int64, TRUTH: types.boolean}[kind]
    return types.BaseTuple.from_types(tuple(type_of(part) for part in kind.parts), kind.of)


def format_of(result: Any) -> Any:
    """Return a result's type as `add_c_function` writes it: a letter, a list of formats, or None for nothing."""
    if isinstance(result, types.NoneType):
        return None
    if isinstance(result, types.BaseTuple) and not isinstance(result, types.BaseNamedTuple):
        return [format_of(part) for part in result]
    if result == types.float64:
        return FLOAT
    if isinstance(result, types.Boolean):
        return TRUTH
    if isinstance(result, types.Integer):
        return INTEGER
    raise TypeError(f"what Python calls returns numbers, or tuples of them, and not {result}")


def _loaded(builder: Any, slots: Any) -> Iterator[Any]:
    place = 0
    while True:
        yield builder.load(builder.gep(slots, [SLOT(place)]))
        place += 1


def _argument(context: Any, builder: Any, wanted: Any, slots: Iterator[Any]) -> Any:
    """Return an argument as kernels pass it to each other."""
    if isinstance(wanted, types.Array):
        array = context.make_array(wanted)(context, builder)
        data = builder.inttoptr(next(slots), context.get_data_type(wanted.dtype).as_pointer())
        shape = [next(slots) for _ in range(wanted.ndim)]
        strides = [next(slots) for _ in range(wanted.ndim)]
        populate_array(array, data, shape, strides, get_itemsize(context, wanted), meminfo=None)
        return array._getvalue()
    if isinstance(wanted, types.Record):
        return builder.inttoptr(next(slots), context.get_value_type(wanted))
    if isinstance(wanted, types.BaseTuple):
        parts = [_argument(context, builder, part, slots) for part in wanted]
        return context.make_tuple(builder, wanted, parts)
    slot = next(slots)
    if wanted == types.float64:
        return builder.bitcast(slot, ir.DoubleType())
    return slot if wanted == types.int64 else builder.trunc(slot, context.get_value_type(wanted))


def _numbers(builder: Any, result: Any, value: Any) -> Iterator[Any]:
    if isinstance(result, types.BaseTuple):
        for place, part in enumerate(result):
            yield from _numbers(builder, part, builder.extract_value(value, place))
    elif result == types.float64:
        yield builder.bitcast(value, SLOT)
    elif isinstance(result, types.Boolean):
        yield builder.zext(value, SLOT)
    elif isinstance(result, types.Integer):
        yield builder.sext(value, SLOT) if result.signed and result.bitwidth < 64 else value
