"""Kernels linked into the function that Python calls give what Numba's own way of compiling gives."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from jit import JIT_IS_OFF

pytestmark = pytest.mark.skipif(JIT_IS_OFF, reason="nothing is compiled")

PROGRAM = """
import numpy as np
from cagepose.kernels import linking
{change}
from cagepose.kernels.contacts import deepest_boxes
from cagepose.kernels.geometry import Geometry, row
from cagepose.kernels.pose import moved_pose

boxes = np.array([[0.3, 0.2, 0.1], [0.1, 0.1, 0.4]])
turns = np.array([np.eye(3), [[0, -1, 0], [1, 0, 0], [0, 0, 1.0]]])
geometry = Geometry(boxes, np.array([[0, 0, 0], [0.1, 0, 0.2]]), turns, 2, np.array([[0.1, 0.3, 0.2], [0, 0.1, 0.5]]))
position, quaternion = moved_pose((0.1, 0.2, 0.3), (1.0, 0.0, 0.0, 0.0), (0.6, 0.0, 0.8), (1.0, 2.0, 3.0), 0.5, 0.25)
print(position, quaternion, *(array.tolist() for array in deepest_boxes(geometry, position, quaternion)))
print(type(next(iter(row.overloads.values())).library).__name__)
"""


def output(change: str, cache: Path) -> list[str]:
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(cache)}
    command = [sys.executable, "-c", PROGRAM.format(change=change)]
    return subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout.splitlines()


def test_linked_kernels_give_what_numbas_own_way_gives(tmp_path: Path) -> None:
    linked, kind = output("", tmp_path / "linked")
    plain, plain_kind = output("linking.TRIED = ()", tmp_path / "plain")

    assert (kind, plain_kind) == ("LinkedLibrary", "JITCodeLibrary")
    assert linked == plain

    def kept(folder: Path) -> set[str]:
        return {path.name.split("-")[0] for path in folder.rglob("*.nbc")}

    assert "vector.row" in kept(tmp_path / "plain")
    assert "vector.row" not in kept(tmp_path / "linked")  # only what Python calls
