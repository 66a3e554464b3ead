"""A `Comparison` as the document of ``--json``: the document of each variant's run, and where they part."""

from __future__ import annotations

from typing import Any

from cagepose.files.document import run_document
from cagepose.files.units import LengthUnit
from cagepose.studies.comparison import Comparison, Parting, Variant


def comparison_document(comparison: Comparison, length_unit: LengthUnit) -> dict[str, Any]:
    """Return the document: only dict, list, str, int, finite float, bool and None."""
    return {
        "scene": comparison.variants[0].run.scene.name,
        "variants": [_variant(variant, length_unit) for variant in comparison.variants],
        "partings": [_parting(parting) for parting in comparison.partings],
    }


def _variant(variant: Variant, length_unit: LengthUnit) -> dict[str, Any]:
    run = variant.run
    return {
        "label": variant.label,
        "friction": variant.friction,
        "metric": None if run.method == "stepwise" else run.scene.metric,  # the paper's rules ask for none
        **run_document(run, length_unit),
    }


def _parting(parting: Parting) -> dict[str, Any]:
    return {
        "label": parting.label,
        "phase": parting.phase,
        "event": parting.number,
        "stepwise_event": parting.first_number,
        "reason": parting.reason,
    }
