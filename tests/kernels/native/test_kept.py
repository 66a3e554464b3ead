"""What a build keeps: a kernel is compiled again when its code would differ, and only then."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from cagepose.kernels.native.library import kernel_library

ROOT = Path(__file__).resolve().parents[3]
CALLEE = '''
from typing import NamedTuple
from cagepose.kernels.native.kernel import kernel

FACTOR = 2.0

class Pair(NamedTuple):
    one: float
    two: float

@kernel
def pair(x: float) -> Pair:
    """Words."""
    return Pair(FACTOR * x, x + 1.0)
'''
CALLER = """
from callee import pair
from cagepose.kernels.native.kernel import entry

@entry
def total(x: float) -> float:
    found = pair(x)
    return 10.0 * found.one + max(found.two, 0.0)
"""
BUILD = """
import os, sys
from pathlib import Path
os.environ.update(NUMBA_OPT="0", NUMBA_DISABLE_INTEL_SVML="1")
from build_kernels import kept
kept.FOLDER = Path("kept")
from build_kernels.c_functions import module_of
from build_kernels.compile import take_over
from build_kernels.link import link, own_level
take_over()
from caller import total
link(module_of([(total, (1.0,))]), (own_level(),), "", Path("library.so").resolve())
from cagepose.kernels.native import kernel
from cagepose.kernels.native.library import Library
called = kernel.Entry(total.py_func)
called.library = Library(Path("library.so").resolve())
print(called(3.0))
"""

pytestmark = pytest.mark.skipif(kernel_library() is None, reason="plain Python needs no build")


def build(folder: Path, callee: str) -> tuple[float, set[str]]:
    """Build in a process of its own; return the entry's answer, and what was compiled, by name."""
    (folder / "callee.py").write_text(callee, encoding="utf-8")
    (folder / "caller.py").write_text(CALLER, encoding="utf-8")
    before = kept_in(folder)
    paths = [str(folder), str(ROOT), *sys.path]
    done = subprocess.run(
        [sys.executable, "-c", BUILD],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(paths), "PYTHONDONTWRITEBYTECODE": "1"},
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    after = kept_in(folder)
    changed = {path for path, content in after.items() if before.get(path) != content}
    return float(done.stdout), {path.name.rsplit(".", 1)[0] for path in changed if path.suffix != ".o"}


def kept_in(folder: Path) -> dict[Path, bytes]:
    return {path: path.read_bytes() for path in folder.glob("kept/*/*")}


EVERY = {"callee.pair", "caller.total", "c.total"}


@pytest.fixture(scope="module")
def built(tmp_path_factory) -> Path:
    """A folder with what the first build keeps."""
    folder: Path = tmp_path_factory.mktemp("built")
    assert build(folder, CALLEE) == (64.0, EVERY)
    return folder


@pytest.mark.parametrize(
    ("old", "new", "answer", "compiled"),
    [
        ("", "", 64.0, set()),
        ("Words.", "Other words, on\n    two lines.", 64.0, set()),
        ("FACTOR = 2.0", "FACTOR = 3.0", 94.0, {"callee.pair"}),
        ("x + 1.0", "x + 2.0", 65.0, {"callee.pair"}),
        ("    one: float\n    two: float", "    two: float\n    one: float", 46.0, {"callee.pair", "caller.total"}),
        ("Pair(FACTOR * x, x + 1.0)", "Pair(FACTOR * x, int(x))", 63.0, {"callee.pair", "caller.total"}),
    ],
)
def test_a_change_compiles_what_it_changes(built, tmp_path, old, new, answer, compiled):
    """10 * 2 * 3 + 4 = 64 before; fields that change places give 10 * 4 + 6, as the tuple is made by position."""
    shutil.copytree(built, tmp_path, dirs_exist_ok=True)
    changed = CALLEE.replace(old, new)
    assert changed != CALLEE or old == new
    assert build(tmp_path, changed) == (answer, compiled)
    if len(compiled) > 1:
        assert build(tmp_path, changed) == (answer, set())


def test_a_kernel_that_takes_a_value_of_a_function_around_it_is_refused(tmp_path):
    """Its code says no more than the value's name, so that a change would go unseen."""
    head, _, kernel = CALLEE.partition("@kernel")
    made = ("@kernel" + kernel.replace("FACTOR * x", "factor * x")).strip().replace("\n", "\n    ")
    text = f"{head}def made(factor):\n    {made}\n    return pair\n\npair = made(2.0)\n"
    with pytest.raises(AssertionError, match=r"pair: a build cannot tell whether factor of the function around it has"):
        build(tmp_path, text)


def test_a_thing_that_a_build_cannot_see_through_is_refused(tmp_path):
    """A function that is no kernel would be inlined by Numba, or fail; its changes would go unseen."""
    text = CALLEE.replace("@kernel", "LIST = [1.0]\n\n@kernel").replace("FACTOR * x", "LIST[0] * x")
    with pytest.raises(AssertionError, match=r"callee\.pair: a build cannot tell whether \[1\.0\] has changed"):
        build(tmp_path, text)
