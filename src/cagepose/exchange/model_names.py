"""Names of a model's geoms in a scene: `name_them`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

from cagepose.exchange.model_bodies import ModelBodies


def name_them(geoms: Sequence[dict[str, Any]], bodies: ModelBodies, of_cage: set[int]) -> None:
    """Give each geom its ``label``, none twice and none the name of a body of the cage.

    That is its name, without that of its body before it unless two would be one then. What moves with a body of the
    cage has that body's name before its own, or before its kind.
    """
    counts = Counter(_short(geom) for geom in geoms)
    movers = [bodies.mover(geom["body"], of_cage) if geom["body"] in of_cage else None for geom in geoms]
    taken = {bodies.name(mover) for mover in movers if mover is not None}
    for number, (geom, mover) in enumerate(zip(geoms, movers, strict=True)):
        if mover is None:
            label = (_short(geom) if counts[_short(geom)] == 1 else geom["name"]) or f"geom {number + 1}"
        else:
            label = f"{bodies.name(mover)}/{_short(geom) or geom['kind']}"
        geom["label"] = next(name for name in (label, *_numbered(label, len(taken))) if name not in taken)
        taken.add(geom["label"])


def _short(geom: dict[str, Any]) -> str:
    name: str = geom["name"]
    return name.partition("/")[2] or name


def _numbered(label: str, n_taken: int) -> list[str]:
    return [f"{label} {number}" for number in range(2, n_taken + 3)]
