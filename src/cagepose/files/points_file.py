"""Cage points from a CSV file: rows of x,y,z or name,x,y,z, with or without a header."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from pathlib import Path

from cagepose.errors import FileProblem, SceneFileError
from cagepose.files.read import read_text
from cagepose.files.schema_base import LARGEST_NUMBER
from cagepose.model.wording import number_of

POINTS_KEY = ("cage", "points", "file")
"""Where a scene names its points file."""

_HEADERS = (["x", "y", "z"], ["name", "x", "y", "z"])


@dataclass(frozen=True)
class PointsTable:
    """The rows of a points file: names (None: not given), coordinates in the scene's unit, and line numbers."""

    source: str
    names: tuple[str, ...] | None
    points: list[list[float]]
    lines: list[int]


def read_points(path: Path, source: str) -> PointsTable:
    """Read a points file.

    Raises
    ------
    SceneFileError
        Not readable, or rows that are no points: all of them, each with its line.
    """
    text = read_text(path, source, POINTS_KEY)
    problems: list[FileProblem] = []
    rows: list[tuple[int, list[str]]] = []
    reader = csv.reader(text.splitlines(), skipinitialspace=True, strict=True)
    try:
        for row in reader:
            cells = [cell.strip() for cell in row]
            if any(cells) and not cells[0].startswith("#"):
                rows.append((reader.line_num, cells))
    except csv.Error as error:
        problems.append(_problem(source, reader.line_num, f"is not CSV ({error}); correct this line"))
    if rows and [cell.lower() for cell in rows[0][1]] in _HEADERS:
        del rows[0]
    if not rows and not problems:
        raise SceneFileError([FileProblem(POINTS_KEY, "holds no points; give rows of x,y,z or name,x,y,z", source)])
    width = len(rows[0][1]) if rows else 3
    points: list[list[float]] = []
    for line, cells in rows:
        message = _row_message(cells, width)
        if message:
            problems.append(_problem(source, line, message))
        else:
            points.append([float(cell) for cell in cells[-3:]])
    if problems:
        raise SceneFileError(problems)
    names = tuple(cells[0] for _, cells in rows) if width == 4 else None
    return PointsTable(source, names, points, [line for line, _ in rows])


def _row_message(cells: list[str], width: int) -> str | None:
    if len(cells) not in (3, 4):
        return f"has {number_of(len(cells), 'value')}; give x,y,z or name,x,y,z"
    if len(cells) != width:
        return f"has {number_of(len(cells), 'value')}, the first row {width}; give all points a name or none"
    if width == 4 and not (cells[0] and cells[0].isprintable() and len(cells[0]) <= 100):
        return f"has the name {cells[0][:40]!r}; give a name of 1 to 100 visible characters"
    for cell in cells[-3:]:
        try:
            number = float(cell) if "_" not in cell else math.nan
        except ValueError:
            return f"holds {cell[:40]!r}, which is no number; give x, y and z with a decimal point"
        if not abs(number) <= LARGEST_NUMBER:
            return f"holds {cell[:40]!r}; give a finite number up to {LARGEST_NUMBER:g}"
    return None


def _problem(source: str, line: int, message: str) -> FileProblem:
    return FileProblem(POINTS_KEY, message, source, line, 1)
