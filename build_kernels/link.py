"""From LLVM's module to a shared library: optimised for each level of processor, linked by a C compiler."""

from __future__ import annotations

import ctypes
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import llvmlite.binding as llvm

from build_kernels import kept
from build_kernels.c_compiler import c_compiler
from build_kernels.c_functions import Module
from build_kernels.levels import LEVELS

HERE = Path(__file__).resolve().parent


def own_level() -> str:
    """Return the best level that this machine's processor can run, by the features that ``best_level.c`` asks for."""
    features = llvm.get_host_cpu_features()
    return LEVELS[-1] if all(features.get(name, False) for name in ("avx2", "fma", "bmi2")) else LEVELS[0]


def link(module: Module, levels: Sequence[str], sources_hash: str, target: Path) -> None:
    """Write the library; whoever reads it meanwhile sees the old one or the new one whole."""
    description = {
        "levels": LEVELS,
        "built": levels,
        "signatures": module.signatures,
        "sources": sources_hash,
    }
    objects = [kept.folder() / f"{module.digest}.{level}.o" for level in levels]
    wanted = [(level, path) for level, path in zip(levels, objects, strict=True) if kept.read(path) is None]
    if wanted:
        bitcode, names = module.llvm_module.as_bitcode(), list(module.signatures)
        with ProcessPoolExecutor() as processes:  # LLVM takes most of its time here, one level in each process
            list(processes.map(_write_machine_code, *zip(*[(bitcode, names, *one) for one in wanted], strict=True)))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        quoted = json.dumps(json.dumps(description))  # a JSON text in quotes is a C string
        (folder / "description.h").write_text(f"#define CAGEPOSE_DESCRIPTION {quoted}\n", encoding="utf-8")
        made = folder / target.name
        command = [
            *(c_compiler() or [sys.executable, "-m", "ziglang", "cc"]),
            "-shared",
            "-fPIC",
            "-O1",
            f"-I{folder}",
            *map(str, sorted(HERE.glob("*.c"))),
            *map(str, objects),
        ]
        subprocess.run([*command, "-lm", "-o", str(made)], check=True)
        ctypes.CDLL(str(made))  # what cannot be loaded, since something is missing, takes nobody's place
        part = target.with_name(f".{target.name}.{os.getpid()}")
        shutil.copyfile(made, part)
        part.replace(target)


def _write_machine_code(bitcode: bytes, names: Sequence[str], level: str, path: Path) -> None:
    """Write an object file in which each entry is called ``name.level``."""
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    module = llvm.parse_bitcode(bitcode)
    for name in names:
        module.get_function(name).name = f"{name}.{level}"
    target = llvm.Target.from_triple(llvm.get_process_triple())
    machine = target.create_target_machine(cpu="" if level == "generic" else level, opt=3, reloc="pic")
    options = llvm.create_pipeline_tuning_options(speed_level=3)
    options.loop_vectorization = True  # packing scalars into vectors ("slp") made runs slower by 5 %
    builder = llvm.create_pass_builder(machine, options)
    builder.getModulePassManager().run(module, builder)
    kept.write(path, machine.emit_object(module))
