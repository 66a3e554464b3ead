"""What solids and bodies of models became, beside what their files say, in words: `HEADINGS`, `summary_rows`; and what
an object weighs: `weight_words`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cagepose.exchange.imported_part import ImportedPart
from cagepose.exchange.model_parts import Weight
from cagepose.exchange.stl import MM_PER_M
from cagepose.exchange.tolerances import ROUNDING_OF_MEASURES
from cagepose.model.wording import coordinates

HEADINGS = ("part", "of", "is", "size mm", "volume mm3", "volume off", "centre off", "inertia off", "surface off")
"""Size and volume are those of the source. How far what is here is off them, and its surface from that at most."""


def summary_rows(parts: Sequence[ImportedPart]) -> list[tuple[str, ...]]:
    """Return the cells of a row for each part, see `HEADINGS`."""
    return [_row(part) for part in parts]


def weight_words(weight: Weight) -> str:
    """Return what an object of a model weighs, and how far what it weighs here is off that."""
    said, ours = weight
    center = coordinates(MM_PER_M * said.center_m, 5)
    moments = [MM_PER_M**2 * moment for moment in np.linalg.eigvalsh(said.inertia_kg_m2).tolist()]
    size_m = float(np.sqrt(moments[-1] / said.mass_kg)) / MM_PER_M
    inertia_off = np.abs(ours.inertia_kg_m2 - said.inertia_kg_m2).max() / np.abs(said.inertia_kg_m2).max()
    offs = (
        _percent(ours.mass_kg / said.mass_kg - 1.0),
        _length(float(np.linalg.norm(ours.center_m - said.center_m)), size_m),
        _percent(float(inertia_off)),
    )
    return (
        f"MuJoCo says of the object: {said.mass_kg:.5g} kg, centre of gravity {center} mm,"
        f" moments of inertia {', '.join(f'{moment:.5g}' for moment in moments)} kg mm2; here off by {', '.join(offs)}"
    )


def _row(part: ImportedPart) -> tuple[str, ...]:
    size_m = float(part.source.size_m.max())
    sides = " x ".join(f"{MM_PER_M * side:.5g}" for side in part.source.size_m)
    return (
        part.name,
        part.body,
        part.became,
        sides,
        f"{MM_PER_M**3 * part.source.volume_m3:.7g}",
        _percent(part.volume_off),
        _length(part.center_off_m, size_m),
        _percent(part.gyration_off),
        _length(part.off_m, size_m),
    )


def _percent(share: float) -> str:
    if abs(share) < ROUNDING_OF_MEASURES:
        return "0"
    return f"{100.0 * share:+.2g} %" if abs(share) < 0.995 else f"{100.0 * share:+.0f} %"


def _length(length_m: float, size_m: float) -> str:
    is_zero = length_m < ROUNDING_OF_MEASURES * size_m
    return "0" if is_zero else f"{MM_PER_M * length_m:.2g} mm"
