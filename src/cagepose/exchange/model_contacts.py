"""Which geoms of a model can touch each other: `ModelContacts`, by MuJoCo's rules."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

Data = dict[str, Any]
WORLD_WELD = 0
"""What all bodies without joints up to the world are one with."""


class ModelContacts:
    """Pairs of geoms, filtered as MuJoCo filters them: by their types and affinities, by excluded bodies, and between
    a body and the one that it hangs on. Pairs that the model lists can touch whatever these say.
    """

    def __init__(self, compiled: Data) -> None:
        self._bodies: Sequence[Data] = compiled["bodies"]
        self._filters_parents: bool = compiled["filters_parents"]
        self._excluded = {frozenset(pair) for pair in compiled["excluded"]}
        self._pairs = {frozenset(pair) for pair in compiled["pairs"]}

    def touching(self, held: Sequence[Data], others: Sequence[Data]) -> set[tuple[int, int]]:
        """Return the pairs that can touch, of the numbers of a geom of ``held`` and one of ``others``.

        Bodies without a joint between them are one for MuJoCo, and touch nothing of each other. Here one of them is
        taken out to be held, so that they do.
        """
        return {(one["number"], other["number"]) for one in held for other in others if self._can_touch(one, other)}

    def _can_touch(self, one: Data, other: Data) -> bool:
        if frozenset((one["number"], other["number"])) in self._pairs:
            return True
        if not (one["contype"] & other["conaffinity"] or other["contype"] & one["conaffinity"]):
            return False
        bodies = frozenset((one["body"], other["body"]))
        if bodies in self._excluded:
            return False
        return not (self._filters_parents and self._hang_on_each_other(one["body"], other["body"]))

    def _hang_on_each_other(self, one: int, other: int) -> bool:
        welds = self._bodies[one]["weld"], self._bodies[other]["weld"]
        above = [self._bodies[self._bodies[weld]["parent"]]["weld"] for weld in welds]
        if WORLD_WELD in welds or welds[0] == welds[1]:
            return False
        return bool(welds[0] == above[1] or welds[1] == above[0])
