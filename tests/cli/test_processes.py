"""What only a process of its own can show: cost of the help, pipes, exit codes."""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

import pytest

CAGEPOSE = [sys.executable, "-m", "cagepose"]
HEAVY = ("numpy", "matplotlib", "PIL", "pydantic", "ruamel", "rich", "cyclopts")


def _run(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*CAGEPOSE, *arguments],
        capture_output=True,
        text=True,
        timeout=300,
        env={**os.environ, **environment},
        check=False,
    )


@pytest.mark.parametrize("arguments", ["[]", "['--help']", "['-h']"])
def test_the_overview_imports_nothing_heavy(arguments: str) -> None:
    code = (
        "import sys; from cagepose.cli.app import main\n"
        f"assert main({arguments}) == 0\n"
        f"print([name for name in {HEAVY!r} if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"


@pytest.mark.parametrize("name", ["run", "compare", "check", "plot", "reproduce", "schema", "init"])
def test_the_help_of_a_command_waits_for_no_kernels(name: str) -> None:
    code = (
        "import sys; from cagepose.cli.app import main\n"
        f"assert main(['{name}', '--help']) == 0\n"
        f"print([name for name in {HEAVY!r} if name in sys.modules and name not in ('rich', 'cyclopts')])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"


def test_help_costs_under_a_fifth_of_a_second_beyond_bare_python() -> None:
    """Measured: 0.02 s on 2 cores. The two are timed in turns, so that a busy machine slows both."""
    bare, with_help = [], []
    for _ in range(7):
        bare.append(_seconds([sys.executable, "-c", "pass"]))
        with_help.append(_seconds([*CAGEPOSE, "--help"]))
    assert statistics.median(with_help) - statistics.median(bare) < 0.2


def _seconds(arguments: list[str]) -> float:
    began = time.perf_counter()
    subprocess.run(arguments, capture_output=True, check=True)
    return time.perf_counter() - began


def test_a_verdict_ends_with_0_and_bad_input_with_2_without_a_traceback(tmp_path: Path, sample_text: str) -> None:
    scene = tmp_path / "scene.yaml"
    scene.write_text(sample_text, encoding="utf-8")
    good, bad = _run("run", str(scene)), _run("run", str(scene), "--set", "object.mass=ten")
    assert good.returncode == 0
    assert good.stdout.startswith("sample: rests")
    assert bad.returncode == 2
    assert bad.stderr == "--set object.mass=ten: object.mass: is text 'ten'; give a number\n"
    assert bad.stdout == ""


@pytest.mark.parametrize("arguments", [["run", "/nothing.yaml"], ["check", "/"], ["nonsense"], ["run", "x", "--y"]])
def test_errors_go_to_standard_error_in_one_line(arguments: list[str]) -> None:
    done = _run(*arguments)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.count("\n") == 1
    assert "Traceback" not in done.stderr


def test_a_reader_that_leaves_early_is_no_error(tmp_path: Path, sample_text: str) -> None:
    scene = tmp_path / "scene.yaml"
    scene.write_text(sample_text, encoding="utf-8")
    with subprocess.Popen(
        [*CAGEPOSE, "run", str(scene), "--json"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        errors = process.stderr.read()
        assert process.wait(timeout=300) == 141
    assert "Traceback" not in errors
    assert "Exception" not in errors


def test_output_survives_a_terminal_that_knows_only_ascii(tmp_path: Path, sample_text: str) -> None:
    scene = tmp_path / "scene.yaml"
    scene.write_text(sample_text.replace("name: sample", "name: Lehre für Öse"), encoding="utf-8")
    done = _run("run", str(scene), PYTHONIOENCODING="ascii", PYTHONUTF8="0", LC_ALL="C")
    assert done.returncode == 0
    assert "rests" in done.stdout


def test_forced_colours_do_not_reach_a_pipe(tmp_path: Path, sample_text: str) -> None:
    scene = tmp_path / "scene.yaml"
    scene.write_text(sample_text, encoding="utf-8")
    assert "\x1b" not in _run("run", str(scene), FORCE_COLOR="1", TERM="xterm-256color").stdout


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
def test_a_full_disk_is_told_and_is_no_bug_of_ours() -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run([*CAGEPOSE, "schema"], stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr == "cagepose: the output cannot be written: No space left on device\n"


@pytest.mark.skipif(os.name != "posix", reason="closes streams as a POSIX shell does")
@pytest.mark.parametrize("arguments", [["run"], ["check"], ["schema"], ["--help"]])
def test_a_closed_output_is_bad_input_with_a_message(arguments: list[str], tmp_path: Path, sample_text: str) -> None:
    scene = tmp_path / "scene.yaml"
    scene.write_text(sample_text, encoding="utf-8")
    given = [*CAGEPOSE, *arguments, *([str(scene)] if arguments[0] in ("run", "check") else [])]
    done = subprocess.run(["sh", "-c", '"$@" >&-', "sh", *given], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (
        2,
        "cagepose: standard output is closed; send it to a file, or to /dev/null\n",
    )
    quiet = subprocess.run(["sh", "-c", '"$@" >&- 2>&-', "sh", *given], capture_output=True, text=True, check=False)
    assert quiet.returncode == 2
