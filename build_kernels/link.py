"""From LLVM's module to a shared library: optimised for each level of processor, linked by a C compiler."""

from __future__ import annotations

import json
import os
import platform
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import llvmlite.binding as llvm

from build_kernels.c_compiler import c_compiler
from build_kernels.compile import Module

HERE = Path(__file__).resolve().parent
LEVELS = ("x86-64-v2", "x86-64-v3") if platform.machine().lower() in ("x86_64", "amd64") else ("generic",)
"""In the order of ``best_level.c``."""


def link(module: Module, sources_hash: str, target: Path) -> None:
    """Write the library; whoever reads it meanwhile sees the old one or the new one whole."""
    description = {"levels": LEVELS, "signatures": module.signatures, "sources": sources_hash}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        quoted = json.dumps(json.dumps(description))  # a JSON text in quotes is a C string
        (folder / "description.h").write_text(f"#define CAGEPOSE_DESCRIPTION {quoted}\n", encoding="utf-8")
        objects = [str(folder / f"{level}.o") for level in LEVELS]
        text = str(module.llvm_module)
        with ProcessPoolExecutor() as processes:  # LLVM takes most of its time here, one level in each process
            list(
                processes.map(
                    _write_machine_code, [text] * len(LEVELS), [list(module.signatures)] * len(LEVELS), LEVELS, objects
                )
            )
        made = folder / target.name
        command = [
            *(c_compiler() or [sys.executable, "-m", "ziglang", "cc"]),
            "-shared",
            "-fPIC",
            "-O1",
            f"-I{folder}",
            *map(str, sorted(HERE.glob("*.c"))),
            *objects,
        ]
        subprocess.run([*command, "-lm", "-o", str(made)], check=True)
        part = target.with_name(f".{target.name}.{os.getpid()}")
        shutil.copyfile(made, part)
        part.replace(target)


def _write_machine_code(text: str, names: Sequence[str], level: str, path: str) -> None:
    """Write an object file in which each entry is called ``name.level``."""
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    module = llvm.parse_assembly(text)
    for name in names:
        module.get_function(name).name = f"{name}.{level}"
    target = llvm.Target.from_triple(llvm.get_process_triple())
    machine = target.create_target_machine(cpu="" if level == "generic" else level, opt=3, reloc="pic")
    options = llvm.create_pipeline_tuning_options(speed_level=3)
    options.loop_vectorization = True  # packing scalars into vectors ("slp") made runs slower by 5 %
    builder = llvm.create_pass_builder(machine, options)
    builder.getModulePassManager().run(module, builder)
    Path(path).write_bytes(machine.emit_object(module))
