"""From a kernel to LLVM: what stands in for the decorators of kernels, and what Numba is kept from doing.

Numba would make machine code of each kernel by itself, with a copy of all that it calls, which takes three times as
long as everything else. `KernelLibrary` keeps it from that: it holds a kernel's own LLVM, made smaller by a few cheap
passes, and the libraries of the kernels that it calls. This is the one place that reaches into Numba, whose release is
therefore pinned (docs/decisions/0016-built-kernels).
"""

from __future__ import annotations

import pickle
from collections.abc import Callable
from typing import Any

import llvmlite.binding as llvm
import numba
from numba import types
from numba.core import codegen
from numba.core.compiler import CompileResult, compile_result
from numba.core.cpu import CPUContext
from numba.core.funcdesc import default_mangler
from numba.core.ir import Expr
from numba.core.lowering import Environment

from build_kernels import kept
from cagepose.kernels.native import interrupt, kernel

OPTIONS = {"nogil": True, "error_model": "numpy", "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
"""No Python objects, no GIL, IEEE arithmetic."""
kernels: dict[str, Any] = {}
"""All that has been decorated, by module and name."""


def compile_kernel(function: Callable[..., Any]) -> Any:
    """Stand in for the decorators of kernels. Kernels make no arrays: references need not be counted (``_nrt``)."""
    name = f"{function.__module__}.{function.__qualname__}"
    kernels[name] = made = compiled_when_called(function, _nrt=False)
    return made


def compiled_when_called(function: Callable[..., Any], **more: bool) -> Any:
    made = numba.njit(**OPTIONS, **more)(function)
    made._cache = _Kept(made)
    return made


def set_up_numba() -> None:
    """Put what is ours in Numba's place, once it has set up what it runs with."""
    numba.njit(_nothing)()
    codegen.JITCPUCodegen._library_class = KernelLibrary
    codegen.JITCPUCodegen.set_env = lambda *_: None
    CPUContext.mangler = _short_name


def _nothing() -> None:
    pass


def _short_name(_context: Any, name: str, takes: Any, *, abi_tags: Any = (), uid: int | None = None) -> str:
    """Return the name of a compiled function: Numba's spell out all types, and were a third of all LLVM's text.

    A kernel has the same name in each build. Numba's own functions get a number in the order of their making.
    """
    is_ours = name.removeprefix(".NumbaEnv.") in kernels
    tag = kept.digest_of(*[kept.described(kind) for kind in takes])[:12]
    made: str = default_mangler(
        name, (), abi_tags=(tag,) if is_ours else (*abi_tags, tag), uid=None if is_ours else uid
    )
    return made


class KernelLibrary(codegen.JITCodeLibrary):  # type: ignore[misc]
    """The LLVM module of one function, without the kernels that it calls, and without machine code.

    Attributes
    ----------
    called
        The libraries of the kernels that it calls; None: it is not a kernel but one of Numba's own functions, of which
        each kernel that calls it has a copy.
    digest
        A name for what is in it.
    """

    called: list[KernelLibrary] | None = None
    digest = ""

    def _optimize_functions(self, ll_module: Any) -> None:
        ll_module.data_layout = self._codegen._data_layout

    def finalize(self) -> None:
        self._finalize_dynamic_globals()
        self._finalized = True

    def get_pointer_to_function(self, _name: str) -> int:
        self._ensure_finalized()
        return 0

    def take_in(self, name: str) -> None:
        """Copy Numba's own functions into a kernel's module, show nothing but the kernel, and make it smaller."""
        self.called, module = [], self._final_module
        numbas, pending = dict[Any, None](), list(self._linking_libraries)
        while pending:
            library = pending.pop()
            if getattr(library, "called", None) is not None:
                self.called.append(library)
            elif library not in numbas:
                numbas[library] = None
                pending.extend(library._linking_libraries)
        # LLVM takes in what is asked for when it comes: last what Numba made beforehand, which all others may ask for.
        for library in sorted(numbas, key=lambda library: not isinstance(library, KernelLibrary)):
            module.link_in(library._get_module_for_linking(), preserve=True)
        for value in (*module.functions, *module.global_variables):
            if not value.is_declaration and value.name != name:
                value.linkage = "internal"
        _simplify(module)

    @classmethod
    def of(cls, codegen: Any, name: str, bitcode: bytes, called: list[KernelLibrary]) -> KernelLibrary:
        """Return the library of a kernel that was kept."""
        self = codegen.create_library(name)
        assert isinstance(self, cls)
        self._final_module, self._finalized, self.called = llvm.parse_bitcode(bitcode), True, called
        return self


def _simplify(module: llvm.ModuleRef) -> None:
    """Run the cheap passes that remove most of what Numba writes: the passes on the whole then take half as long."""
    llvm.initialize_native_target()
    machine = llvm.Target.from_triple(llvm.get_process_triple()).create_target_machine(opt=2, reloc="pic")
    passes = llvm.create_new_module_pass_manager()
    passes.add_global_dead_code_eliminate_pass()
    passes.add_sroa_pass()
    passes.add_simplify_cfg_pass()
    passes.add_instruction_combine_pass()
    passes.add_simplify_cfg_pass()
    passes.run(module, llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=1)))


class _Kept:
    """What Numba asks before it compiles a kernel, and tells afterwards."""

    def __init__(self, dispatcher: Any) -> None:
        self.dispatcher = dispatcher

    def load_overload(self, signature: Any, context: Any) -> CompileResult | None:
        path = kept.file_of(self.dispatcher.py_func, signature)
        content = kept.read(path)
        if content is None:
            return None
        try:
            found = kept.KeptKernel(*pickle.loads(content))
        except (AttributeError, ImportError):  # it takes a type that has another name now
            return None
        called = list[KernelLibrary]()
        for call in found.calls:
            dispatcher = kernels.get(call.name)
            if dispatcher is None:
                return None
            dispatcher.compile(call.takes)
            result = dispatcher.overloads[call.takes]
            if kept.described(result.signature.return_type) != call.gives:
                return None
            called.append(result.library)
        library = KernelLibrary.of(context.codegen(), found.descriptor.mangled_name, found.bitcode, called)
        library.digest = path.name
        environment = Environment.from_fndesc(found.descriptor)
        return compile_result(
            target_context=context,
            typing_context=context.typing_context,
            entry_point=context.get_executable(library, found.descriptor, environment),
            library=library,
            fndesc=found.descriptor,
            signature=found.signature,
            objectmode=False,
            lifted=(),
        )

    def save_overload(self, signature: Any, result: CompileResult) -> None:
        path = kept.file_of(self.dispatcher.py_func, signature)
        descriptor, library = result.fndesc, result.library
        calls = dict[str, kept.Call]()
        for expression, call in descriptor.calltypes.items():
            if isinstance(expression, Expr) and expression.op == "call":
                called = descriptor.typemap[expression.func.name]
                if isinstance(called, types.Dispatcher) and isinstance(called.dispatcher._cache, _Kept):
                    function = called.dispatcher.py_func
                    name = f"{function.__module__}.{function.__qualname__}"
                    one = kept.Call(name, tuple(call.args), kept.described(call.return_type))
                    calls[repr(one)] = one
        library.take_in(descriptor.mangled_name)
        library.digest = path.name
        descriptor.typemap = descriptor.calltypes = descriptor.global_dict = None
        found = kept.KeptKernel(descriptor, result.signature, tuple(calls.values()), library._final_module.as_bitcode())
        kept.write(path, pickle.dumps(tuple(found)))


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
