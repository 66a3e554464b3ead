"""What `pip` does when it builds cagepose: the library of kernels is compiled, and goes into the wheel."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface
from packaging.tags import platform_tags

ROOT = Path(__file__).resolve().parent


class KernelsHook(BuildHookInterface):  # type: ignore[type-arg]
    """Builds the library before the files of a wheel are collected, for editable installs too."""

    PLUGIN_NAME = "custom"

    def dependencies(self) -> list[str]:
        """Return what is needed to link: a C compiler from PyPI where the machine has none."""
        sys.path.insert(0, str(ROOT))
        from build_kernels.c_compiler import c_compiler

        return [] if c_compiler() else ["ziglang"]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        if self.target_name != "wheel":
            return
        sys.path[:0] = [str(ROOT), str(ROOT / "src")]
        from build_kernels.build import build, is_built

        all_levels = version != "editable"  # a checkout is for this machine
        if not is_built(all_levels=all_levels):
            build(all_levels=all_levels)
        # The library is called through ctypes: it fits every Python on this platform.
        platform = next(tag for tag in platform_tags() if not tag.startswith(("manylinux", "musllinux")))
        build_data.update(pure_python=False, tag=f"py3-none-{platform}")
