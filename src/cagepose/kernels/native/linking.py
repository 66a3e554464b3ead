"""Compiling many small kernels into one: each is only typed and lowered, and taken in by what Python calls.

Numba makes machine code of every function that another one calls, and optimises it again with each of its callers, so
a call tree of two hundred small functions ten levels deep is optimised ten times over. Here only the functions that
Python calls are optimised and made into machine code, each with all that it calls in one piece
(docs/decisions/0012-linked-kernels).

It hangs on how Numba keeps its LLVM modules, which is none of its public interface; see `TRIED`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numba
from numba import _dynfunc
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_lock import global_compiler_lock
from numba.core.compiler_machinery import LoweringPass, PassManager, register_pass
from numba.core.typed_passes import AnnotateTypes, NativeLowering

from cagepose.kernels.native.arguments import Kind
from cagepose.kernels.native.c_function import add_c_function, format_of, type_of
from cagepose.kernels.native.cache import cache_folder, is_writable
from cagepose.kernels.native.object_file import ObjectFile

TRIED = ((0, 68),)
"""Releases of Numba in which all tests passed with this. In others kernels are compiled in Numba's own way, with the
same results, only more slowly.
"""


def is_tried() -> bool:
    """Whether kernels can be linked with the installed release of Numba."""
    return numba.version_info.short in TRIED


def dispatcher_of(function: Callable[..., object], is_entry: bool) -> Any:
    """Return what stands for a kernel where other kernels call it."""
    if is_tried():
        return _dispatcher(function, no_cpython_wrapper=True, pipeline_class=LinkedCompiler)
    # Numba reads its setting when the decorator runs; ours must not leak to other users of Numba in this process.
    previous, folder = numba.config.CACHE_DIR, cache_folder() if is_writable() else None
    numba.config.CACHE_DIR = str(folder or "")
    try:
        return _dispatcher(function, no_cpython_wrapper=not is_entry, cache=folder is not None)
    finally:
        numba.config.CACHE_DIR = previous


def _dispatcher(function: Callable[..., object], **options: Any) -> Any:
    """No Python objects, no GIL, IEEE arithmetic; no counting of references, since kernels make no arrays."""
    return numba.njit(nogil=True, error_model="numpy", no_cfunc_wrapper=True, _nrt=False, **options)(function)


@global_compiler_lock  # type: ignore[untyped-decorator]
def object_file(dispatcher: Any, kinds: Sequence[Kind], name: str) -> ObjectFile:
    """Return the machine code of a kernel for arguments of these kinds, with all that it calls, as the C function
    ``name`` of `add_c_function`.
    """
    signature = tuple(type_of(kind) for kind in kinds)
    dispatcher.compile(signature)
    compiled = dispatcher.overloads[signature]
    context = compiled.target_context
    library = EntryLibrary(context.codegen(), name)
    library.add_linking_library(compiled.library)
    add_c_function(library, context, compiled.fndesc, name)
    library.finalize()
    return ObjectFile(name, format_of(compiled.fndesc.restype), library.machine_code())


class LinkedLibrary(JITCodeLibrary):  # type: ignore[misc]
    """The LLVM module of one kernel, and the libraries of those that it calls."""

    def _optimize_functions(self, ll_module: Any) -> None:
        """Leave optimising to the one that takes it in."""
        ll_module.data_layout = self._codegen._data_layout

    def finalize(self) -> None:
        """Let several modules bring the same kernel; make no machine code."""
        self._raise_if_finalized()
        for function in self._final_module.functions:
            if not function.is_declaration and function.linkage.name == "external":
                function.linkage = "linkonce_odr"
        self._finalize_dynamic_globals()
        self._finalized = True

    def _get_module_for_linking(self) -> Any:
        """Return this kernel with all that it calls, directly or not."""
        self._ensure_finalized()
        module = self._final_module.clone()
        for library in self._called({self}):
            linked = isinstance(library, LinkedLibrary)
            module.link_in(library._final_module if linked else library._get_module_for_linking(), preserve=True)
        return module

    def _called(self, seen: set[Any]) -> list[Any]:
        """Return the libraries of all kernels called, callers first: LLVM takes in what has been asked for before."""
        found = list[Any]()
        for library in self._linking_libraries:
            if library not in seen:
                seen.add(library)
                library._ensure_finalized()
                below = library._called(seen) if isinstance(library, LinkedLibrary) else []
                found = [library, *below, *found]
        return found


class EntryLibrary(JITCodeLibrary):  # type: ignore[misc]
    """The LLVM module of a function that Python calls, and in the end all that it calls."""

    def _optimize_final_module(self) -> None:
        """Keep all kernels to itself: one that is called from one place only is taken in there, with no call left.

        A call passes each array as seven numbers or more, so that calling costs more than many a kernel does.
        """
        module = self._final_module
        for value in (*module.functions, *module.global_variables):
            if not value.is_declaration and value.linkage.name in ("linkonce_odr", "common"):
                value.linkage = "internal"
        super()._optimize_final_module()

    def _finalize_final_module(self) -> None:
        """Keep it out of Numba's engine, which would make machine code of it too."""
        self._verify_declare_only_symbols()
        self._finalized = True

    def machine_code(self) -> bytes:
        """Return it as an object file, as a linker takes them."""
        code: bytes = self._codegen._tm.emit_object(self._final_module)
        return code


@register_pass(mutates_CFG=False, analysis_only=True)
class UseLinkedLibrary(LoweringPass):  # type: ignore[misc]
    """Before lowering: give the kernel a library of ours, and ask for no machine code."""

    _name = "use_linked_library"

    def __init__(self) -> None:
        super().__init__()

    def run_pass(self, state: Any) -> bool:
        state.library = LinkedLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        state.flags.no_compile = True
        return False


@register_pass(mutates_CFG=False, analysis_only=True)
class OfferToCallers(LoweringPass):  # type: ignore[misc]
    """After lowering: tell other kernels which function to call, as Numba does for what it has compiled."""

    _name = "offer_to_callers"

    def __init__(self) -> None:
        super().__init__()

    def run_pass(self, state: Any) -> bool:
        lowered = state.cr
        name = lowered.fndesc.qualname.rpartition(".")[-1]
        # Address 0: Python cannot call it, just as a function that Numba compiles without its Python wrapper.
        handle = _dynfunc.make_function(
            lowered.fndesc.lookup_module(), name, "a kernel for kernels", 0, lowered.env, (state.library,)
        )
        state.targetctx.insert_user_function(handle, lowered.fndesc, [state.library])
        state.flags.no_compile = False
        state.cr = lowered._replace(cfunc=handle)
        return False


class LinkedCompiler(CompilerBase):  # type: ignore[misc]
    """Numba's own passes, with the two above around the lowering."""

    def define_pipelines(self) -> list[PassManager]:
        passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
        passes.add_pass_after(UseLinkedLibrary, AnnotateTypes)
        passes.add_pass_after(OfferToCallers, NativeLowering)
        passes.finalize()
        return [passes]
