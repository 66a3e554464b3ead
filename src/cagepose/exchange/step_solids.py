"""Solids of STEP files, asked of Open CASCADE in a process of its own. Millimetres throughout."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from cagepose.exchange.step_reader import read_here
from cagepose.exchange.step_writer import write_here
from cagepose.files.extra import require
from cagepose.files.own_process import answer, ask

Data = dict[str, Any]

CPU_SECONDS, WALL_SECONDS = 8, 60.0
"""Limits of the process; the start of Open CASCADE is one second of it."""


def read_step(path: Path) -> Data:
    """Return the ``solids`` of a file, each with ``name``, and ``vertices`` and ``faces`` of its triangles, and
    ``volume``, or the ``core`` of a rounded hull and its ``radius``; and what was left ``out``, in words. One with
    ``n_fillets`` in its hollow corners, ``radius`` at most, is ``sharp`` there without them.

    Raises
    ------
    SceneError
        Open CASCADE cannot read it, or takes too long.
    MissingExtraError
        Open CASCADE is not installed.
    """
    return _ask({"read": str(path.resolve())})


def write_step(solids: list[Data], path: Path) -> None:
    """Write solids: each has a ``name``, and ``added`` and ``removed`` primitives, see `cagepose.exchange.step_writer`.

    Raises
    ------
    SceneError, MissingExtraError
        As `read_step`.
    """
    _ask({"write": str(path.resolve()), "solids": solids})


def _ask(task: Data) -> Data:
    require("OCP", "STEP files need Open CASCADE", "cad")
    found: Data = json.loads(ask(__name__, json.dumps(task).encode(), WALL_SECONDS, "Open CASCADE"))
    return found


def _answer(task: bytes) -> bytes:
    given = json.loads(task)
    found = read_here(given["read"]) if "read" in given else write_here(given["solids"], given["write"])
    return json.dumps(found).encode()


if __name__ == "__main__":
    answer(_answer, CPU_SECONDS)
