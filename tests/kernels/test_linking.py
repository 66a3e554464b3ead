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
from cagepose.kernels.native import linking
{change}
from cagepose.kernels.collision.contacts import deepest_boxes
from cagepose.kernels.collision.geometry import Geometry, empty_placement, place_object, row
from cagepose.kernels.native.jit import bound
from cagepose.kernels.algebra.pose import moved_pose

boxes = np.array([[0.3, 0.2, 0.1], [0.1, 0.1, 0.4]])
turns = np.array([np.eye(3), [[0, -1, 0], [1, 0, 0], [0, 0, 1.0]]])
geometry = Geometry(boxes, np.array([[0, 0, 0], [0.1, 0, 0.2]]), turns, 2, np.array([[0.1, 0.3, 0.2], [0, 0.1, 0.5]]))
position, quaternion = moved_pose((0.1, 0.2, 0.3), (1.0, 0.0, 0.0, 0.0), (0.6, 0.0, 0.8), (1.0, 2.0, 3.0), 0.5, 0.25)
bound(place_object, geometry, position, quaternion, empty_placement(geometry))
print(position, quaternion, *(array.tolist() for array in deepest_boxes(geometry, position, quaternion)))
print(type(next(iter(row.dispatcher.overloads.values())).library).__name__)
"""


SHARED = """
import numba, numpy as np
from cagepose.kernels.algebra.linear_program import ProgramRoom, factorise, program_rows, solve_program
from cagepose.kernels.algebra.record import empty_record

rows, bounds = program_rows(6)
rows[:], bounds[:] = np.eye(6), 1.0
room = empty_record(ProgramRoom)
room.objective[:], room.basis[0] = 1.0, -1
solve_program(rows, bounds, room)
numba.njit(lambda *arguments: factorise(*arguments))(rows, bounds, room)
print(room.x_near.tolist())
"""


def output(change: str, cache: Path) -> list[str]:
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(cache)}
    return printed(PROGRAM.format(change=change), environment).splitlines()


def printed(program: str, environment: dict[str, str]) -> str:
    command = [sys.executable, "-c", program]
    return subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout


def test_linked_kernels_give_what_numbas_own_way_gives(tmp_path: Path) -> None:
    linked, kind = output("", tmp_path / "linked")
    plain, plain_kind = output("linking.TRIED = ()", tmp_path / "plain")

    assert (kind, plain_kind) == ("LinkedLibrary", "JITCodeLibrary")
    assert linked == plain

    def kept(folder: Path) -> set[str]:
        return {path.name.split("-")[0] for path in folder.rglob("*-*.*")}

    assert "vector.row" in kept(tmp_path / "plain")
    assert kept(tmp_path / "linked") == {"place_object"}  # only what Python calls


def test_a_kernel_that_one_function_has_taken_in_still_serves_another(tmp_path: Path) -> None:
    """Both bring a copy: the address of one is not looked for in the other, where it is private."""
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    assert printed(SHARED, environment) == f"{[1.0] * 6}\n"
