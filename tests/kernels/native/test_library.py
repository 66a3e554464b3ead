"""Finding the library of machine code, and choosing from it; what is wrong is told before any kernel runs."""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from build_kernels.levels import LEVELS
from cagepose.errors import KernelsError
from cagepose.kernels.algebra.pose import write_euler_zyx, write_quaternions
from cagepose.kernels.native import library
from cagepose.kernels.native.library import FILE_NAME, LIBRARY, Library, kernel_library
from cagepose.model.methods import METHODS

ROOT = Path(__file__).resolve().parents[3]
SCENE = ROOT / "scenes" / "sample.yaml"
NATIVE = kernel_library()
REMEDY = "build it with `make setup`"

pytestmark = pytest.mark.skipif(NATIVE is None, reason="there is no library where kernels are plain Python")


def levels() -> list[str]:
    """All that the library holds."""
    assert NATIVE is not None
    return NATIVE.levels


def fake_processor(monkeypatch: pytest.MonkeyPatch, best: int) -> None:
    """Let every library say that this processor runs the levels up to ``best``; -1: none of them."""

    class OnAnother(ctypes.CDLL):
        def __init__(self, path: str) -> None:
            super().__init__(path)
            self.cagepose_best_level = lambda: best

    monkeypatch.setattr(library.ctypes, "CDLL", OnAnother)


def test_a_processor_gets_the_best_level_that_it_can_run(monkeypatch):
    for best in range(len(LEVELS)):
        fake_processor(monkeypatch, best)
        held = [name for name in levels() if name in LEVELS[: best + 1]]
        if held:
            assert Library(LIBRARY).level == held[-1]
        for beyond in LEVELS[best + 1 :]:
            with pytest.raises(KernelsError, match=f"{beyond} is not for this processor|^this processor is older than"):
                Library(LIBRARY, beyond)


def test_a_processor_older_than_all_levels_is_told_what_still_works(monkeypatch):
    message = rf"^this processor is older than {levels()[0]}; set CAGEPOSE_KERNELS=python$"
    for best in range(-1, LEVELS.index(levels()[0])):
        fake_processor(monkeypatch, best)
        with pytest.raises(KernelsError, match=message):
            Library(LIBRARY)


def test_a_level_that_the_library_lacks_is_told_with_those_that_it_has():
    with pytest.raises(
        KernelsError, match=r"^CAGEPOSE_KERNELS=x86-64-v9 is not for this processor; choose python or one of \S+"
    ):
        Library(LIBRARY, "x86-64-v9")


def test_each_level_has_machine_code_of_its_own_for_each_entry():
    """Two levels of one address would be one level under two names."""
    assert NATIVE is not None
    for name in NATIVE.signatures:
        found = [Library(LIBRARY, level).function(name) for level in levels()]
        addresses = {ctypes.cast(function, ctypes.c_void_p).value for function in found}
        assert len(addresses) == len(levels())


def test_a_missing_library_is_told_with_its_remedy(tmp_path):
    with pytest.raises(KernelsError) as told:
        Library(tmp_path / "kernels.so")
    assert str(told.value).startswith(f"{tmp_path / 'kernels.so'}: the library of kernels is missing; {REMEDY}")


@pytest.mark.parametrize("kind", ["empty", "text", "for another processor"])
def test_what_is_no_library_is_told_with_its_remedy(tmp_path, kind):
    """The twentieth byte of an ELF file names the processor family; 0 is none."""
    path, real = tmp_path / FILE_NAME, LIBRARY.read_bytes()
    path.write_bytes({"empty": b"", "text": b"no library"}.get(kind, real[:18] + b"\0\0" + real[20:]))
    with pytest.raises(KernelsError, match=r"the library of kernels cannot be loaded \(.+\); build it with"):
        Library(path)


@pytest.mark.skipif(sys.platform != "linux", reason="only ELF files say where they end")
@pytest.mark.parametrize("share", [0.01, 0.5, 0.999])
def test_half_a_library_is_refused_before_it_can_end_the_process(tmp_path, share):
    path, real = tmp_path / FILE_NAME, LIBRARY.read_bytes()
    path.write_bytes(real[: int(share * len(real))])
    with pytest.raises(KernelsError, match=r"the library of kernels cannot be loaded \(the file is cut off\); build"):
        Library(path)


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A copy of the program's sources and its library, as in a checkout."""
    quiet = shutil.ignore_patterns("__pycache__")
    for folder in ("src", "build_kernels"):
        shutil.copytree(ROOT / folder, tmp_path / folder, ignore=quiet)
    return tmp_path


def run_in(tree: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run the sample by the sources of a tree."""
    return subprocess.run(
        [sys.executable, "-m", "cagepose", "run", str(SCENE)],
        env={**os.environ, "PYTHONPATH": str(tree / "src"), **environment},
        cwd=tree,
        capture_output=True,
        text=True,
        check=False,
    )


def library_in(tree: Path) -> Path:
    return tree / LIBRARY.relative_to(ROOT)


def edit(path: Path) -> None:
    """Change a source, later than anything else was written."""
    path.write_text(path.read_text(encoding="utf-8") + "\n# changed\n", encoding="utf-8")
    later(path)


def later(path: Path) -> None:
    seconds = path.stat().st_mtime + 1e6
    os.utime(path, (seconds, seconds))


def test_a_copied_tree_runs_with_its_own_library(tree):
    done = run_in(tree)
    assert (done.returncode, done.stderr) == (0, "")
    library_in(tree).unlink()
    missing = run_in(tree)
    assert (missing.returncode, missing.stdout) == (2, "")
    assert missing.stderr.startswith(f"{library_in(tree)}: the library of kernels is missing; {REMEDY}")
    assert missing.stderr.count("\n") == 1


@pytest.mark.parametrize("source", ["algebra/pose.py", "quasistatic/run.py", "native/slots.py"])
def test_kernels_that_have_changed_since_the_build_do_not_run(tree, source):
    edit(tree / "src/cagepose/kernels" / source)
    done = run_in(tree)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith(f"{library_in(tree)}: kernels have changed since the library was built; {REMEDY}")
    assert run_in(tree, CAGEPOSE_KERNELS="python").returncode == 0


def test_a_kernel_that_was_added_counts_as_a_change(tree):
    added = tree / "src/cagepose/kernels/algebra/added.py"
    added.write_text("", encoding="utf-8")
    later(added)
    assert "kernels have changed" in run_in(tree).stderr


def test_touching_a_kernel_without_a_change_is_none(tree):
    for source in (tree / "src/cagepose/kernels").rglob("*.py"):
        later(source)
    done = run_in(tree)
    assert (done.returncode, done.stderr) == (0, "")


def test_what_is_not_compiled_may_change(tree):
    edit(tree / "src/cagepose/runs/run.py")
    edit(tree / "src/cagepose/kernels/native/kernel.py")
    assert run_in(tree).returncode == 0


def test_an_installed_program_does_not_ask_for_its_sources_age(tree):
    """There, nobody edits kernels, and dates of files mean nothing."""
    shutil.rmtree(tree / "build_kernels")
    edit(tree / "src/cagepose/kernels/algebra/pose.py")
    assert run_in(tree).returncode == 0


@pytest.mark.parametrize("method", METHODS)
def test_a_run_needs_no_compiler(method):
    code = (
        "import sys, cagepose\n"
        f"cagepose.run(cagepose.load_scene({str(SCENE)!r}), {method!r})\n"
        f"cagepose.run_many(cagepose.load_scene({str(SCENE)!r}), method={method!r})\n"
        "print([name for name in sys.modules if name.startswith(('numba', 'llvmlite'))])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert (done.stdout, done.stderr) == ("[]\n", "")


N_THREADS = 8


def test_threads_may_call_one_entry_at_once():
    """Each with arrays of its own, over and over, all begun together."""
    angles = np.random.default_rng(1).uniform(-1.5, 1.5, (N_THREADS, 200, 3))
    expected = np.zeros((N_THREADS, 200, 4))
    for given, made in zip(angles, expected, strict=True):
        write_quaternions(given, made)
    wrong, gate = list[int](), threading.Barrier(N_THREADS)

    def work(index: int) -> None:
        gate.wait()
        for _ in range(200):
            found = np.zeros_like(expected[index])
            write_quaternions(angles[index], found)
            if not np.array_equal(found, expected[index]):
                wrong.append(index)

    threads = [threading.Thread(target=work, args=(index,)) for index in range(N_THREADS)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert wrong == []


def test_other_threads_go_on_while_a_kernel_runs():
    """A call of some 0.1 s; were the interpreter held, nothing would happen before its end."""
    quaternions = np.tile([1.0, 0.0, 0.0, 0.0], (1_000_000, 1))
    angles, call = np.zeros((len(quaternions), 3)), list[float]()

    def work() -> None:
        call.append(time.perf_counter())
        write_euler_zyx(quaternions, angles)
        call.append(time.perf_counter())

    thread = threading.Thread(target=work)
    thread.start()
    moments = list[float]()
    while thread.is_alive():
        moments.append(time.perf_counter())
    shares = (np.array(moments) - call[0]) / (call[1] - call[0])
    assert ((shares > 0.25) & (shares < 0.75)).any()
