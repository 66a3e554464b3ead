"""A library that may crash or hang, in a process of its own with limits: `ask` here, `answer` there."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable

from cagepose.errors import Problem, SceneError

MEMORY_BYTES = 2 * 1024**3
EXIT_REFUSED = 2
"""Exit code where the library refuses what it is given; its message is the last line of standard error."""


def ask(module: str, given: bytes, seconds: float, library: str) -> bytes:
    """Return what a module, run as a program, answers; it takes so much time at most.

    It runs in a folder of its own, so that names of files in what is given must be whole, and takes no modules (``-P``)
    from the folder where the user is.

    Raises
    ------
    SceneError
        The library refuses what it is given, breaks, or takes too much.
    """
    try:
        with tempfile.TemporaryDirectory() as folder:  # libraries write logs to where they run
            command = [sys.executable, "-P", "-m", module, folder]
            done = subprocess.run(command, input=given, capture_output=True, timeout=seconds, check=False)
    except subprocess.TimeoutExpired:
        raise SceneError([Problem((), f"takes {library} more than {seconds:g} s; simplify it")]) from None
    if done.returncode == 0:
        return done.stdout
    message = f"broke {library}, or asked it for too much time or memory; simplify or repair it"
    if done.returncode == EXIT_REFUSED:
        message = done.stderr.decode(errors="replace").splitlines()[-1]
    raise SceneError([Problem((), message)])


def answer(work: Callable[[bytes], bytes], cpu_seconds: int | None = None) -> None:
    """Answer `ask` with what ``work`` makes of what was given."""
    limit(cpu_seconds)
    answers = os.dup(1)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # libraries print there
    os.chdir(sys.argv[1])
    try:
        found = work(sys.stdin.buffer.read())
    except (ValueError, RuntimeError) as error:
        sys.stderr.write("\n" + " ".join(str(error).split()))
        sys.exit(EXIT_REFUSED)
    with os.fdopen(answers, "wb") as stream:
        stream.write(found)


def limit(cpu_seconds: int | None = None) -> None:
    """Let this process take no more than `MEMORY_BYTES`, and so much time of a processor."""
    try:
        import resource
    except ImportError:  # Windows has no such limits
        return
    resource.setrlimit(resource.RLIMIT_DATA, (MEMORY_BYTES, MEMORY_BYTES))
    if cpu_seconds is not None:
        resource.setrlimit(resource.RLIMIT_CPU, (cpu_seconds, cpu_seconds))
