"""Ctrl-C ends whatever runs, soon: real processes, real signals."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from cagepose.kernels.native.library import kernel_library

SOON_S = 0.5
SCENE = Path(__file__).resolve().parents[2] / "scenes" / "rail-pitch.yaml"
LONG = f"""
import signal
import sys
import numpy as np
import cagepose
from cagepose.runs import many
from cagepose.runs.batch import Batch
from cagepose.runs.methods import chosen_method

signal.signal(signal.SIGINT, signal.default_int_handler)  # what a shell starts in the background ignores it
N = 1_000_000  # of 70 us each
scene = cagepose.load_scene({str(SCENE)!r})
variation = cagepose.Variation(cage_euler_zyx=np.full((N, 3), 1e-3))
before = cagepose.run(scene)


def one_call(*_):
    method, _, arguments = Batch(scene, chosen_method(scene), variation)._workspace().args
    print("begun", flush=True)
    method.run_cases(0, N, *arguments)


def many_calls():
    many.LONGEST_PIECE = N
    print("begun", flush=True)
    cagepose.run_many(scene, variation, threads=2)
"""
"""Runs that take minutes, in one call of a kernel and in one for each of several threads."""

pytestmark = [
    pytest.mark.skipif(kernel_library() is None, reason="plain Python hears Ctrl-C anyway"),
    pytest.mark.skipif(sys.platform == "win32", reason="there a call of a kernel goes on to its end"),
]


def interrupted(code: str, after_s: float = 0.5) -> tuple[float, int, str, str]:
    """Run Python code and press Ctrl-C some time after it has printed a line; return how long it then took to end, its
    exit code, and what it wrote after that line.
    """
    with subprocess.Popen(
        [sys.executable, "-c", LONG + code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "begun\n"
        time.sleep(after_s)
        pressed = time.perf_counter()
        process.send_signal(signal.SIGINT)
        try:
            out, err = process.communicate(timeout=20.0)
        except subprocess.TimeoutExpired:
            process.kill()
            out, err = process.communicate()
        return time.perf_counter() - pressed, process.returncode, out, err


@pytest.mark.parametrize("call", ["one_call", "many_calls"])
def test_a_program_goes_on_after_ctrl_c_with_sound_results(call: str) -> None:
    took_s, code, out, err = interrupted(f"""
try:
    {call}()
except KeyboardInterrupt:
    print("stopped", flush=True)
after = cagepose.run(scene)
for one, other in zip(before.phases, after.phases, strict=True):
    assert [event.pose_world_object.as_tuples() for event in one.events] == [
        event.pose_world_object.as_tuples() for event in other.events
    ]
""")
    assert (out, err, code) == ("stopped\n", "", 0)
    assert took_s < SOON_S


def test_a_run_that_is_stopped_leaves_nothing_half_written() -> None:
    """The workspace of a run is kept for the next one."""
    took_s, code, out, err = interrupted("""
import cagepose.runs.solve as solve
kept = solve._WORKSPACES.by_size
assert len(kept) == 1
method = chosen_method(scene)
one_call.until = one_call  # so is it called
object.__setattr__(method, "run", one_call)
try:
    cagepose.run(scene)
except KeyboardInterrupt:
    print(len(kept))
""")
    assert (out, err, code) == ("0\n", "", 0)
    assert took_s < SOON_S


def test_a_command_ends_with_130_and_one_line() -> None:
    took_s, code, out, err = interrupted(f"""
import cagepose.runs.solve
from cagepose.cli.app import main
cagepose.runs.solve.run = one_call
sys.exit(main(["run", {str(SCENE)!r}]))
""")
    assert (out, err, code) == ("", "cagepose: stopped\n", 130)
    assert took_s < SOON_S


def test_who_handles_ctrl_c_otherwise_decides_what_becomes_of_it() -> None:
    _, code, out, err = interrupted("""
N = 30_000
signal.signal(signal.SIGINT, lambda *_: print("heard", flush=True))
one_call()
print("ended", flush=True)
""")
    assert (sorted(out.split()), err, code) == (["ended", "heard"], "", 0)
