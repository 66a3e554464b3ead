"""A `Margin` as a part of the document of ``--json``: moments in its force times the scene's unit of length."""

from __future__ import annotations

import math
from typing import Any, Literal

from cagepose.files.units import LengthUnit, from_metres
from cagepose.model.checks import FloatArray
from cagepose.studies.margin import Margin


def margin_document(margin: Margin, length_unit: LengthUnit) -> dict[str, Any]:
    """Return the document: only dict, list, str, finite float, bool and None."""
    moments = from_metres(margin.moment_nm, length_unit), from_metres(margin.moment_below_nm, length_unit)
    return {
        "in_newtons": margin.in_newtons,
        "force": _extra(margin.force_n, margin.force_below_n, margin.force_direction_world),
        "moment": _extra(float(moments[0]), float(moments[1]), margin.moment_direction_world),
        "contacts": [
            {
                "point": contact.point,
                "box": contact.box,
                "at": None if contact.place_world is None else _numbers(from_metres(contact.place_world, length_unit)),
                "least": contact.least_n,
                "greatest": _or_unbounded(contact.greatest_n),
                "equally_stiff_normal": contact.equally_stiff_n,
                "equally_stiff_tangential": _numbers(contact.equally_stiff_tangential_n),
            }
            for contact in margin.contacts
        ],
    }


def _extra(certain: float, below: float, direction: FloatArray) -> dict[str, Any]:
    return {
        "certain": _or_unbounded(certain),
        "below": _or_unbounded(below),
        "direction": None if math.isinf(certain) else _numbers(direction),
    }


def _or_unbounded(value: float) -> float | Literal["unbounded"]:
    """JSON has no infinite number."""
    return "unbounded" if math.isinf(value) else value


def _numbers(values: FloatArray) -> list[float]:
    return [value + 0.0 for value in values.tolist()]  # -0.0 becomes 0.0
