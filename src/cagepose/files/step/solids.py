"""Solids of STEP files, asked of Open CASCADE in a process of its own. Millimetres throughout."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

from cagepose.files.extra import require
from cagepose.files.own_process import answer, ask
from cagepose.files.step.reader import read_here

Data = dict[str, Any]

CPU_SECONDS, WALL_SECONDS = 8, 60.0
"""Limits of the process; the start of Open CASCADE is one second of it."""


def read_step(path: Path, *, fillets: bool = True) -> Data:
    """Return the ``solids`` of a file, each with ``name``, and ``vertices`` and ``faces`` of its triangles, and
    ``volume``, or the ``core`` of a rounded hull and its ``radius``; and what was left ``out``, in words.

    Triangles stand for surfaces: these are ``known``, and each triangle is ``on`` one, -1: on another that is none of
    `cagepose.model.surfaces`. Corners are ``off_surfaces``, and triangles on others ``off_others``, by so much at most.
    Whether no side is open is ``is_closed``, and ``off_volume`` as `cagepose.files.step.triangles.off_volume`.

    Parameters
    ----------
    fillets
        False: one with ``n_fillets`` in its hollow corners, ``radius`` at most, is ``sharp`` there without them.

    Raises
    ------
    SceneError
        Open CASCADE cannot read it, or takes too long.
    MissingExtraError
        Open CASCADE is not installed.
    """
    require("OCP", "STEP files need Open CASCADE", "cad")
    found: Data = json.loads(ask(__name__, _task(path, fillets=fillets), WALL_SECONDS, "Open CASCADE"))
    return found


def _task(path: Path, *, fillets: bool) -> bytes:
    return (b"with " if fillets else b"without ") + os.fsencode(path.resolve())


def _answer(task: bytes) -> bytes:
    fillets, _, path = task.partition(b" ")
    return json.dumps(read_here(os.fsdecode(path), fillets=fillets == b"with")).encode()


if __name__ == "__main__":
    answer(_answer, CPU_SECONDS)
