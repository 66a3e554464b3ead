"""Lengths and angles of files, and those inside: metres and radians; and the units of a scene file's numbers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from cagepose.errors import Key
from cagepose.model.checks import FloatArray

LengthUnit = Literal["mm", "m", "in"]
LENGTH_UNITS: tuple[LengthUnit, ...] = get_args(LengthUnit)

# Each unit as a ratio of whole numbers: 29.52 mm becomes 29.52 / 1000, the double nearest to 0.02952 (29.52 * 0.001 may
# miss it).
METRES_OF: dict[LengthUnit, tuple[float, float]] = {"mm": (1.0, 1000.0), "m": (1.0, 1.0), "in": (127.0, 5000.0)}

_LENGTHS = {
    *("size", "position", "radius", "radius_bottom", "radius_top", "length", "depth", "width", "vertices"),
    *("points", "at", "to", "center_of_gravity"),
}
_OTHERS = {"mass": "kg", "gravity": "m/s²", "magnitude": "N", "preload": "N"}
"""The last words of paths to numbers in scene files that are lengths, and units of the others that have one."""


def to_metres(lengths: ArrayLike, unit: LengthUnit) -> FloatArray:
    """Turn lengths of a file into metres.

    >>> to_metres([29.52, 4.0], "mm").tolist()
    [0.02952, 0.004]
    """
    numerator, denominator = METRES_OF[unit]
    array: FloatArray = np.asarray(lengths, dtype=np.float64) * numerator / denominator
    return array


def from_metres(lengths_m: ArrayLike, unit: LengthUnit) -> FloatArray:
    """Turn metres into lengths of a file.

    >>> float(from_metres(0.0254, "in"))
    1.0
    """
    numerator, denominator = METRES_OF[unit]
    array: FloatArray = np.asarray(lengths_m, dtype=np.float64) * denominator / numerator
    return array


def unit_at(path: Sequence[Key], length_unit: LengthUnit) -> str:
    """Return the unit of the number at a path of a scene file; empty: it has none, or is a parameter, which may be
    anything.

    >>> unit_at(("cage", "points", "left", 0), "in"), unit_at(("loads", 0, "moments", 1, "magnitude"), "mm")
    ('in', 'N mm')
    """
    names = [key for key in path if isinstance(key, str)]
    if names[0] == "parameters":
        return ""
    if names[-1].endswith("_deg"):
        return "deg"
    if names[-1] == "stiffness":
        return f"N/{length_unit}"
    if names[-1] in _LENGTHS or "points" in names:
        return length_unit
    return f"N {length_unit}" if "moments" in names else _OTHERS.get(names[-1], "")


def with_unit(name: str, unit: str) -> str:
    """Return a name with its unit as an axis has it.

    >>> with_unit("x", "mm"), with_unit("friction", "")
    ('x [mm]', 'friction')
    """
    return f"{name} [{unit}]" if unit else name
