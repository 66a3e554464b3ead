"""Friction of a model's geoms as that of a scene: `scene_friction`.

MuJoCo takes, of two geoms, that of the higher priority, else the greater. A scene takes that of the cage's element,
else that of the object's, else that of all.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import Any


def scene_friction(
    held: Mapping[str, Mapping[str, Any]], cage: Mapping[str, Mapping[str, Any]]
) -> tuple[float, dict[str, float], list[str]]:
    """Return the coefficient of all, those of single elements by name, and the names of cage elements for which no
    scene has the same: these have the greatest.

    ``held`` and ``cage`` have the geoms with their ``friction`` and ``priority``, by the names of their elements.
    """

    def of_pair(one: Mapping[str, Any], other: Mapping[str, Any]) -> float:
        if one["priority"] != other["priority"]:
            return float(max(one, other, key=lambda geom: geom["priority"])["friction"])
        return max(float(one["friction"]), float(other["friction"]))

    pairs = {(part, name): of_pair(held[part], cage[name]) for part in held for name in cage}
    if not pairs:
        return 0.0, {}, []
    of_cage = {name: {pairs[part, name] for part in held} for name in cage}
    mixed = [name for name, found in of_cage.items() if len(found) > 1]
    of_held = {part: {pairs[part, name] for name in mixed} for part in held}
    uneven: list[str] = []
    if any(len(found) > 1 for found in of_held.values()):
        uneven, of_held, mixed = mixed, {}, []
    single = {name: max(found) for name, found in of_cage.items() if name not in mixed}
    common = Counter(single.values()).most_common(1)
    plain = common[0][0] if common and not mixed else Counter(pairs.values()).most_common(1)[0][0]
    if mixed:  # what the cage leaves open is the object's, so that each of the other cage elements needs its own
        single |= {part: max(found) for part, found in of_held.items()}
        cage_own = {name for name in single if name in cage}
        return plain, {name: mu for name, mu in single.items() if name in cage_own or mu != plain}, uneven
    return plain, {name: mu for name, mu in single.items() if mu != plain}, uneven
