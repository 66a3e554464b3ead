"""Machine code of entries: kept on disk, loaded without Numba, called with what Python has."""

from __future__ import annotations

import gc
import os
import subprocess
import sys
import weakref
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from cagepose.kernels.algebra.record import FloatArray, IntArray, empty_rows
from cagepose.kernels.native import cache
from cagepose.kernels.native.cache import cache_folder
from cagepose.kernels.native.jit import Entry, bound
from cagepose.kernels.native.machine_code import MachineCode
from cagepose.kernels.native.object_file import ObjectFile, read_object_file
from jit import JIT_IS_OFF

pytestmark = pytest.mark.skipif(JIT_IS_OFF, reason="nothing is compiled")

CALLS_NOBODY = """
declare i32 @no_such_function()

define i32 @asks(i64* %arguments, i64* %results) {
    %code = call i32 @no_such_function()
    ret i32 %code
}
"""
SMALL = """
import sys
import weakref
import numpy as np
from cagepose.kernels.algebra.pose import write_quaternions

found = np.empty((1, 4))
write_quaternions(np.zeros((1, 3)), found)
print(found.tolist(), "numba" in sys.modules)
"""


class Part(NamedTuple):
    values: FloatArray
    scale: float
    counts: tuple[int, bool]


class Row:
    index: int
    is_odd: bool


def told(part: Part, shift: float) -> tuple[float, tuple[int, bool]]:
    return part.values.sum() * part.scale + shift, (part.counts[0] + 1, not part.counts[1])


def number(rows: IntArray) -> None:
    for i in range(len(rows)):
        rows[i].index, rows[i].is_odd = i, i % 2 == 1


def copy(first: int, source: FloatArray, target: FloatArray) -> float:
    for i in range(first, len(source)):
        target[i] = source[i]
    return source[0]


def fill(source: FloatArray, target: FloatArray) -> None:
    for i in range(source.shape[0]):
        for k in range(source.shape[1]):
            target[i, k] = source[i, k]


def refuse(number: int) -> int:
    if number < 0:
        raise ValueError
    return number


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(cache, "cache_folder", lambda: tmp_path)
    return tmp_path


def test_numbers_go_in_and_come_out_in_tuples_named_or_not() -> None:
    tell = Entry(told)
    assert tell(Part(np.arange(4.0), 0.5, (2, True)), -1.0) == (2.0, (3, False))
    assert tell(Part(np.arange(4.0), np.float64(0.5), (np.int64(2), np.bool_(False))), -1.0) == (2.0, (3, True))
    assert len(tell.loaded) == 1
    with pytest.raises(TypeError, match="numbers, arrays, records, tuples of them, and no list"):
        tell([1.0], 0.0)


def test_records_are_written_to_where_they_are() -> None:
    rows = empty_rows(Row, 3)
    assert Entry(number)(rows) is None
    assert [(int(row.index), bool(row.is_odd)) for row in rows] == [(0, False), (1, True), (2, False)]


@pytest.mark.parametrize("order", ["C", "F", "A"])
def test_an_array_may_have_its_numbers_in_any_order(order: str) -> None:
    target = np.zeros((3, 2))
    numbers = np.arange(24.0)
    source = {"C": numbers[:6].reshape(3, 2), "F": numbers[:6].reshape(2, 3).T, "A": numbers.reshape(6, 4)[::2, ::2]}
    Entry(fill)(source[order], target)
    assert (target == source[order]).all()


def test_each_kind_of_arguments_has_machine_code_of_its_own() -> None:
    copies, into = Entry(copy), np.zeros(3)
    values = np.arange(6)[::2]
    values.setflags(write=False)
    assert copies(0, values, into) == 0
    assert into.tolist() == [0.0, 2.0, 4.0]
    assert copies(0, np.array([0.5, 1.5, 2.5]), into) == 0.5
    assert len(copies.loaded) == 2


def test_what_is_read_only_is_not_written_to() -> None:
    target = np.zeros(3)
    target.setflags(write=False)
    with pytest.raises(Exception, match="Cannot modify readonly array"):
        Entry(copy)(0, np.ones(3), target)
    assert not target.any()


def test_an_exception_in_a_kernel_is_an_error_in_python() -> None:
    refuses = Entry(refuse)
    assert refuses(3) == 3
    with pytest.raises(RuntimeError, match=r"the kernel refuse-[0-9a-f]+ failed"):
        refuses(-1)


def test_a_bound_call_keeps_its_arrays_and_takes_the_first_numbers_anew() -> None:
    target = np.zeros(3)
    source = np.array([5.0, 6.0, 7.0])
    call, kept = bound(Entry(copy), 0, source, target), weakref.ref(source)
    del source
    gc.collect()
    assert kept() is not None
    assert call(2) == 5.0
    assert target.tolist() == [0.0, 0.0, 7.0]
    call(0)
    assert target.tolist() == [5.0, 6.0, 7.0]


def test_threads_that_call_at_once_load_it_once(monkeypatch: pytest.MonkeyPatch) -> None:
    n_loaded = []
    load = cache.load_machine_code
    monkeypatch.setattr(cache, "load_machine_code", lambda *given: n_loaded.append(1) or load(*given))
    tell = Entry(told)
    with ThreadPoolExecutor(8) as threads:
        found = list(threads.map(lambda k: tell(Part(np.full(3, float(k)), 1.0, (k, True)), 0.5), range(200)))
    assert found == [(3.0 * k + 0.5, (k + 1, False)) for k in range(200)]
    assert len(n_loaded) == 1


@pytest.mark.parametrize("damage", ["cut", "changed", "empty", "gone"])
def test_a_damaged_file_is_compiled_anew(damage: str, folder: Path) -> None:
    assert Entry(refuse)(3) == 3
    (path,) = folder.iterdir()
    whole = path.read_bytes()
    if damage == "gone":
        path.unlink()
    else:
        middle = len(whole) // 2
        changed = whole[:middle] + bytes([whole[middle] ^ 1]) + whole[middle + 1 :]
        path.write_bytes({"cut": whole[:-100], "changed": changed, "empty": b""}[damage])
    assert read_object_file(path) is None
    assert Entry(refuse)(4) == 4
    assert read_object_file(path) is not None
    assert list(folder.iterdir()) == [path]


def test_a_file_that_asks_for_what_this_process_lacks_is_compiled_anew(
    folder: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    import llvmlite.binding as llvm

    assert Entry(refuse)(3) == 3
    (path,) = folder.iterdir()
    module = llvm.parse_assembly(CALLS_NOBODY)
    asks = ObjectFile("asks", "q", llvm.Target.from_default_triple().create_target_machine().emit_object(module))
    with pytest.raises(RuntimeError, match="asks"):
        MachineCode(asks)
    asks.write(path)
    assert Entry(refuse)(4) == 4
    assert capfd.readouterr() == ("", "")


def test_a_disk_that_cannot_be_written_to_is_no_error(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cache, "cache_folder", lambda: folder / "nowhere")
    assert Entry(refuse)(3) == 3
    monkeypatch.setattr(cache, "cache_folder", lambda: None)
    assert Entry(refuse)(4) == 4


def test_another_processor_or_setting_of_numba_has_a_folder_of_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    here = cache.inputs_hash()
    assert cache.inputs_hash() == here
    with monkeypatch.context() as changed:
        changed.setattr("llvmlite.binding.get_host_cpu_name", lambda: "another")
        assert cache.inputs_hash() != here
    monkeypatch.setenv("NUMBA_BOUNDSCHECK", "1")
    assert cache.inputs_hash() != here


def test_the_next_process_needs_no_numba(tmp_path: Path) -> None:
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    command = [sys.executable, "-c", SMALL]
    found = [subprocess.run(command, env=environment, capture_output=True, text=True, check=True) for _ in range(2)]
    assert [done.stdout for done in found] == ["[[1.0, 0.0, 0.0, 0.0]] True\n", "[[1.0, 0.0, 0.0, 0.0]] False\n"]


def test_a_folder_that_can_only_be_read_is_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse_to_write(**_: object) -> None:
        raise PermissionError

    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    cache_folder.cache_clear()
    try:
        kept = cache_folder()
        assert kept is not None
        monkeypatch.setattr(cache, "cache_folder", lambda: kept)
        assert Entry(refuse)(3) == 3
        assert cache.is_writable()
        monkeypatch.setattr("tempfile.TemporaryFile", refuse_to_write)
        monkeypatch.setattr("cagepose.kernels.native.linking.object_file", refuse_to_write)  # nothing is compiled
        cache_folder.cache_clear()
        assert cache_folder() == kept
        assert Entry(refuse)(4) == 4
        assert not cache.is_writable()
    finally:
        cache_folder.cache_clear()
