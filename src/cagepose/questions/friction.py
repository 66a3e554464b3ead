"""How much friction a rest needs, to be a balance at all and so that no motion can begin: `friction_limits`.

A balance needs the least coefficient of (5.17), which is exact. That no motion can begin is shown at one coefficient at
a time, (5.13). It need not stay so as friction grows, so several coefficients are tried, and each change between two of
them is closed in by halving.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

from cagepose.questions.ends import not_in_contact, phase_asked
from cagepose.questions.unanswered import Unanswered
from cagepose.runs.cases import greatest_friction
from cagepose.runs.drives import displaced_after
from cagepose.runs.judge import critical_friction_at, judge_pose
from cagepose.runs.methods import chosen_method
from cagepose.runs.proof import FreeMotion, Proof
from cagepose.runs.run import Run

WITHIN = 1e-6
"""To this fraction of itself each end of a range is closed in."""
UP_TO = 2.0
"""Coefficients are tried up to this one, or to twice the present one or the least one of a balance."""
HALVINGS = 20
"""So many coefficients are tried at first, each twice as far above that of the balance as the one before."""
MOST_TRIED = 150
"""Then ends are as wide as they are."""


@dataclass(frozen=True)
class NoMotion:
    """Coefficients at which no motion can begin (strongly stable, Pang and Trinkle 2000).

    Attributes
    ----------
    shown_from, shown_to
        The least and the greatest of them that were tried: shown at both, and at all that were tried between.
    motion_at
        The greatest coefficient tried below these at which a motion can begin; None: none was found below.
    motion
        Which one.
    motion_again_at
        The least coefficient tried above these at which a motion can begin; None: none was found above.
    """

    shown_from: float
    shown_to: float
    motion_at: float | None
    motion: FreeMotion | None
    motion_again_at: float | None


@dataclass(frozen=True)
class FrictionLimits:
    """How much friction the pose at the end of a phase needs.

    Where points, boxes or shapes have coefficients of their own, each number is the greatest of all coefficients, and
    the others keep their proportion to it.

    Attributes
    ----------
    phase
        Its name.
    present
        The coefficient of the scene.
    has_several
        Whether some have coefficients of their own.
    balance
        The least at which the contacts can balance the load (weakly stable); exact. Infinite: none is enough.
    no_motion
        Ranges in which no motion can begin, the lowest first; empty: none was shown.
    n_tried, up_to
        How many coefficients were tried, and the greatest. What happens between two neighbours that are alike is not
        known.
    """

    phase: str
    present: float
    has_several: bool
    balance: float
    no_motion: tuple[NoMotion, ...]
    n_tried: int
    up_to: float


def friction_limits(run: Run, phase: str | None = None) -> FrictionLimits | Unanswered:
    """Say from which coefficient of friction on the contacts can balance the load, and from which no motion can begin.

    Parameters
    ----------
    run
        Of either method.
    phase
        Name of the phase at whose end it is asked; None: the last.

    Raises
    ------
    SceneError
        The run has no such phase.
    """
    number = phase_asked(run, phase)
    if reason := not_in_contact(run, number):
        return reason
    end = _End(run, number)
    if math.isnan(end.balance):
        return Unanswered("there are more contacts, or choices of faces at edges, than can be asked")
    for coefficient in _first_tried(end.balance, end.present):
        end.ask(coefficient)
    end.close_in()
    tried = sorted(end.tried)
    return FrictionLimits(
        run.phases[number].name,
        end.present,
        bool(run.scene.friction_of),
        end.balance,
        tuple(_ranges(end.tried)),
        len(tried),
        tried[-1],
    )


def _first_tried(balance: float, present: float) -> set[float]:
    least = balance if math.isfinite(balance) else 0.0
    span = max(UP_TO, 2.0 * present, 2.0 * least) - least
    above = {least + span * 0.5**halving for halving in range(HALVINGS)}
    return {least * (1.0 - WITHIN), least, present, *above}


class _End:
    """The pose at the end of a phase, asked with one coefficient after the other."""

    def __init__(self, run: Run, phase: int) -> None:
        self._scene, self._phase, self._pose = run.scene, phase, run.phases[phase].pose
        self._friction = chosen_method(run.scene, run.method).friction(run.scene)
        self._displaced = displaced_after(run, phase)
        self.present = greatest_friction(run.scene, self._friction)
        self.balance = critical_friction_at(run.scene, self._pose, phase, self._friction, self._displaced)
        self.tried = dict[float, Proof]()

    def ask(self, coefficient: float) -> None:
        self.tried[coefficient] = judge_pose(
            self._scene, self._pose, self._phase, self._friction, self._displaced, coefficient
        )[0]

    def close_in(self) -> None:
        """Try coefficients between neighbours that are not alike, until all such are as good as one."""
        while len(self.tried) < MOST_TRIED and (middles := list(self._between())):
            for coefficient in middles:
                self.ask(coefficient)

    def _between(self) -> Iterator[float]:
        for low, high in pairwise(sorted(self.tried)):
            if high - low > WITHIN * high and _finding(self.tried[low]) != _finding(self.tried[high]):
                yield 0.5 * (low + high)


def _finding(proof: Proof) -> tuple[bool, bool]:
    """Whether no motion can begin, and whether one was found: neither, where it is not known."""
    return proof.verdict == "rests", proof.motion is not None


def _ranges(tried: dict[float, Proof]) -> list[NoMotion]:
    """Return the ranges of coefficients that are next to each other and at all of which it is shown to rest."""
    coefficients, ranges = sorted(tried), list[list[float]]()
    for before, coefficient in zip([None, *coefficients], coefficients, strict=False):
        if tried[coefficient].verdict != "rests":
            continue
        if before is not None and tried[before].verdict == "rests":
            ranges[-1].append(coefficient)
        else:
            ranges.append([coefficient])
    moving = [coefficient for coefficient in coefficients if tried[coefficient].motion is not None]
    found = []
    for of_range in ranges:
        below = max((one for one in moving if one < of_range[0]), default=None)
        above = min((one for one in moving if one > of_range[-1]), default=None)
        motion = None if below is None else tried[below].motion
        found.append(NoMotion(of_range[0], of_range[-1], below, motion, above))
    return found
