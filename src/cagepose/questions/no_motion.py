"""From where to where no motion can begin, as a number of a scene is varied: `NoMotion`, by `Tried`.

That no motion can begin is shown at one value at a time, (5.13). It need not stay so as the number grows, so several
values are tried, and each change between two of them is closed in by halving.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import pairwise

from cagepose.runs.proof import FreeMotion, Proof

WITHIN = 1e-6
"""To this fraction of itself each end of a range is closed in."""
MOST_TRIED = 150
"""Then ends are as wide as they are."""


@dataclass(frozen=True)
class NoMotion:
    """Values of a number, such as a coefficient of friction, at which no motion can begin (strongly stable, Pang and
    Trinkle 2000).

    Attributes
    ----------
    shown_from, shown_to
        The least and the greatest of them that were tried: shown at both, and at all that were tried between.
    motion_at, motion
        The greatest value tried below these at which a motion can begin, and which one; None: none was found below.
    motion_again_at, motion_again
        The least value tried above these at which one can; None: none was found above.
    """

    shown_from: float
    shown_to: float
    motion_at: float | None
    motion: FreeMotion | None
    motion_again_at: float | None
    motion_again: FreeMotion | None


class Tried:
    """The proofs at values that were tried, by value."""

    def __init__(self, prove: Callable[[float], Proof], first: Iterable[float]) -> None:
        """Try some values, then such between neighbours that are not alike, until all these are as good as one."""
        self.proofs = {value: prove(value) for value in first}
        while len(self.proofs) < MOST_TRIED and (middles := self._between()):
            self.proofs |= {value: prove(value) for value in middles}

    def _between(self) -> list[float]:
        return [
            0.5 * (low + high)
            for low, high in pairwise(sorted(self.proofs))
            if high - low > WITHIN * high and _finding(self.proofs[low]) != _finding(self.proofs[high])
        ]

    def ranges(self) -> tuple[NoMotion, ...]:
        """Return the ranges of values next to each other at all of which no motion can begin."""
        values, ranges, is_within = sorted(self.proofs), list[list[float]](), False
        for value in values:
            was_within, is_within = is_within, self.proofs[value].verdict == "rests"
            if is_within and was_within:
                ranges[-1].append(value)
            elif is_within:
                ranges.append([value])
        return tuple(self._range(found[0], found[-1]) for found in ranges)

    def _range(self, first: float, last: float) -> NoMotion:
        moving = [value for value, proof in self.proofs.items() if proof.motion is not None]
        below = max((value for value in moving if value < first), default=None)
        above = min((value for value in moving if value > last), default=None)
        return NoMotion(first, last, below, self._motion(below), above, self._motion(above))

    def _motion(self, value: float | None) -> FreeMotion | None:
        return None if value is None else self.proofs[value].motion


def _finding(proof: Proof) -> tuple[bool, bool]:
    """Whether no motion can begin, and whether one was found: neither, where it is not known."""
    return proof.verdict == "rests", proof.motion is not None
