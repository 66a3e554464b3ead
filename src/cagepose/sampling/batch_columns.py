"""Numbers of a scene file as columns of a `Variation`: what the batch kernel can vary without building scenes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cagepose.files.key_path import Path, value_at
from cagepose.files.schema_base import LARGEST_NUMBER, SMALLEST_NUMBER
from cagepose.files.units import LengthUnit, to_metres
from cagepose.model.checks import FloatArray
from cagepose.runs.variation import Variation

Columns = Mapping[Path, FloatArray]
"""Numbers of the scene file by their paths, one for each run."""

CAGE, START, FRICTION = ("cage", "pose"), ("object", "pose"), ("friction", "coefficient")


class BatchColumns:
    """Turns numbers of one scene's file into columns.

    Parameters
    ----------
    data
        The nominal scene's plain data, every expression as its number.
    length_unit
        Of its lengths.
    """

    def __init__(self, data: object, length_unit: LengthUnit) -> None:
        self._data, self._unit = data, length_unit
        self._force = _one_force(data)

    def takes(self, path: Path) -> bool:
        """Whether the batch kernel can vary the number at ``path``."""
        if path[:1] == ("parameters",) or path == FRICTION:
            return True
        if path[:2] in (CAGE, START):
            return path[2:3] in (("position",), ("euler_zyx_deg",))
        if path[:2] == ("cage", "points"):
            return len(path) == 4 and not value_at(self._data, ("cage", "bodies"))  # whose points stand behind these
        if self._force is None or path[: len(self._force)] != self._force:
            return False
        return path[len(self._force)] != "at_world"

    def usable(self, columns: Columns) -> NDArray[np.bool_]:
        """Return which rows hold numbers that a scene file may, (n,); the others are for the scene's own checks."""
        found: NDArray[np.bool_] = np.logical_and.reduce(
            [np.abs(column) <= LARGEST_NUMBER for column in columns.values()]
        )
        if FRICTION in columns:
            found &= columns[FRICTION] >= 0.0
        if self._force is not None:
            magnitude = columns.get((*self._force, "magnitude"))
            if magnitude is not None:
                found &= magnitude >= SMALLEST_NUMBER
            if any(path[: len(self._force) + 1] == (*self._force, "direction") for path in columns):
                found &= np.any(self._rows((*self._force, "direction"), columns) != 0.0, axis=1)
        return found

    def variation(self, columns: Columns) -> Variation:
        """Return the columns, in metres and radians."""
        given: dict[str, FloatArray] = {}
        for place, name in ((CAGE, "cage"), (START, "object")):
            if self._is_varied((*place, "position"), columns):
                given[f"{name}_position_m"] = to_metres(self._rows((*place, "position"), columns), self._unit)
            if self._is_varied((*place, "euler_zyx_deg"), columns):
                given[f"{name}_euler_zyx"] = np.radians(self._rows((*place, "euler_zyx_deg"), columns))
        if self._is_varied(("cage", "points"), columns):
            given["points_cage_m"] = to_metres(self._points(columns), self._unit)
        if FRICTION in columns:
            given["friction_coefficient"] = columns[FRICTION]
        if self._force is not None:
            if self._is_varied((*self._force, "direction"), columns):
                given["force_direction_world"] = self._rows((*self._force, "direction"), columns)
            if self._is_varied((*self._force, "at"), columns):
                given["force_at_object_m"] = to_metres(self._rows((*self._force, "at"), columns), self._unit)
            if (*self._force, "magnitude") in columns:
                given["force_magnitude_n"] = columns[*self._force, "magnitude"]
        return Variation(**given)

    def _is_varied(self, place: Path, columns: Columns) -> bool:
        return any(path[: len(place)] == place for path in columns)

    def _rows(self, place: Path, columns: Columns) -> FloatArray:
        """Return a vector of the file, (n, 3), with what varies of it."""
        rows = np.tile(np.array(value_at(self._data, place), dtype=np.float64), (len(_any(columns)), 1))
        for path, column in columns.items():
            if path[:-1] == place:
                rows[:, int(path[-1])] = column
        return rows

    def _points(self, columns: Columns) -> FloatArray:
        points: Any = value_at(self._data, ("cage", "points"))
        names = list(points) if isinstance(points, dict) else list(range(len(points)))
        base = np.array([points[name] for name in names], dtype=np.float64)
        rows = np.tile(base, (len(_any(columns)), 1, 1))
        for path, column in columns.items():
            if path[:2] == ("cage", "points"):
                rows[:, names.index(path[2]), int(path[3])] = column
        return rows


def _any(columns: Columns) -> FloatArray:
    return next(iter(columns.values()))


def _one_force(data: Any) -> Path | None:
    """Return the path of the only force of all phases; None: there is none, or more than one."""
    found: list[Path] = []
    for index, load in enumerate(data["loads"]):
        found += [("loads", index, "force")] if load.get("force") is not None else []
        found += [("loads", index, "forces", number) for number in range(len(load.get("forces") or []))]
    return found[0] if len(found) == 1 else None
