"""What is kept between builds: the LLVM of each kernel, in ``build/kernels``, so that only what changed is compiled.

A kernel's code hangs on its own source, on the constants and classes that it names, on the types of its arguments, and
on what the kernels that it calls return. The first three are in the name of its file; the last is written in the file,
and asked again before the file is used. What a called kernel does inside is that kernel's own matter.
"""

from __future__ import annotations

import hashlib
import os
import sys
import time
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any, NamedTuple

import llvmlite
import numba
import numpy as np
from numba.core import sigutils, types
from numba.core.dispatcher import Dispatcher

HERE = Path(__file__).resolve().parent
FOLDER = HERE.parent / "build" / "kernels"
UNUSED_S = 14 * 24 * 3600.0
"""What no build has used for so long is removed."""


@cache
def folder() -> Path:
    """Return where this state of the builder, of Numba and of Python keeps what it made."""
    state = [sys.version, numba.__version__, llvmlite.__version__]
    for source in sorted(HERE.glob("*.py")):
        state.append(source.read_text(encoding="utf-8"))
    path = FOLDER / digest_of(*state)
    path.mkdir(parents=True, exist_ok=True)
    return path


def write(path: Path, content: bytes) -> None:
    """Write a file that another build may write, or read, at the same time."""
    part = path.with_name(f".{path.name}.{os.getpid()}")
    part.write_bytes(content)
    part.replace(path)


def read(path: Path) -> bytes | None:
    """Return what was kept, and note that it was used; None: nothing was."""
    try:
        content = path.read_bytes()
        os.utime(path)
    except FileNotFoundError:
        return None
    return content


def remove_unused() -> None:
    """Remove what no build has used for a while."""
    for path in FOLDER.rglob("*"):
        if path.is_file() and time.time() - path.stat().st_mtime > UNUSED_S:
            path.unlink(missing_ok=True)


class Call(NamedTuple):
    """A kernel that a kernel calls: its name, the types it is given, and a description of what it returned."""

    name: str
    takes: tuple[Any, ...]
    gives: str


class KeptKernel(NamedTuple):
    """A kernel as it was compiled: Numba's description of it, its calls, and its LLVM as bitcode."""

    descriptor: Any
    signature: Any
    calls: tuple[Call, ...]
    bitcode: bytes


def file_of(function: Callable[..., Any], signature: Any) -> Path:
    """Return the file for a kernel with arguments of the types of a signature, whether there is one or not."""
    if function.__closure__:
        name, free = f"{function.__module__}.{function.__qualname__}", ", ".join(function.__code__.co_freevars)
        raise TypeError(f"{name}: a build cannot tell whether {free} of the function around it has changed; pass it on")
    takes, _ = sigutils.normalize_signature(signature)
    content = digest_of(*_content(function.__code__, function), *[described(kind) for kind in takes])
    return folder() / f"{function.__module__}.{function.__qualname__}.{content}"


def described(kind: Any) -> str:
    """Return a type's name; unlike Numba's own, with the names of the fields of tuples."""
    if isinstance(kind, types.BaseNamedTuple):
        made = kind.instance_class
        fields = ", ".join(f"{name}={described(part)}" for name, part in zip(kind.fields, kind, strict=True))
        return f"{made.__module__}.{made.__qualname__}({fields})"
    if isinstance(kind, types.BaseTuple):
        return f"({', '.join(described(part) for part in kind)})"
    return str(kind)


def _content(code: CodeType, function: Callable[..., Any]) -> Iterator[str]:
    """Yield all that a function's own lines say: not where they stand, nor what is said of them."""
    yield repr((code.co_name, code.co_varnames, code.co_names, code.co_argcount, function.__defaults__))
    yield code.co_code.hex()
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _content(constant, function)
        elif constant != function.__doc__:
            yield repr(constant)
    for name in code.co_names:
        if name in function.__globals__:
            yield f"{name} is {_named(function.__globals__[name], f'{function.__module__}.{function.__qualname__}')}"


def _named(value: Any, where: str) -> str:
    """Return what a kernel gets when it names a thing of its module."""
    if isinstance(value, (bool, int, float, str, np.generic, np.dtype, type(None))):
        return f"{type(value).__name__} {value!r}"
    if isinstance(value, tuple):
        return f"({', '.join(_named(part, where) for part in value)})"
    if isinstance(value, Dispatcher):
        return f"kernel {value.py_func.__module__}.{value.py_func.__qualname__}"
    if isinstance(value, type):
        return f"class {value.__module__}.{value.__qualname__} {getattr(value, '_fields', '')}"
    if isinstance(value, ModuleType) and not value.__name__.startswith("cagepose"):
        return f"module {value.__name__}"
    if callable(value) and not str(getattr(value, "__module__", "")).startswith("cagepose"):
        return f"function {value!r}" if isinstance(value, types.Type) else f"function {value.__name__}"
    raise TypeError(
        f"{where}: a build cannot tell whether {value!r} has changed; import a constant, a class or a kernel"
    )


def digest_of(*parts: str) -> str:
    """Return a name for what some texts say."""
    digest = hashlib.sha256()
    for part in parts:
        digest.update(part.encode() + b"\0")
    return digest.hexdigest()[:24]
