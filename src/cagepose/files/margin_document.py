"""A `Margin` as a part of the document of ``--json``: moments in its force times the scene's unit of length."""

from __future__ import annotations

from typing import Any

from cagepose.files.results import UNBOUNDED, plain_data
from cagepose.files.units import LengthUnit
from cagepose.studies.margin import Margin


def margin_document(margin: Margin, length_unit: LengthUnit) -> dict[str, Any]:
    """Return the document: only dict, list, str, finite float, bool and None."""
    told = plain_data(margin, length_unit)
    return {
        "in_newtons": margin.in_newtons,
        "force": _extra("force", told),
        "moment": _extra("moment", told),
        "contacts": told["contacts"],
    }


def _extra(kind: str, told: dict[str, Any]) -> dict[str, Any]:
    certain = told[kind]
    direction = None if certain == UNBOUNDED else told[f"{kind}_direction"]
    return {"certain": certain, "below": told[f"{kind}_below"], "direction": direction}
