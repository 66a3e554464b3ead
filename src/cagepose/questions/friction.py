"""How much friction a rest needs, to be a balance at all and so that no motion can begin: `friction_limits`.

A balance needs the least coefficient of (5.17), which is exact. The other one is closed in by `no_motion`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from cagepose.questions.ends import not_in_contact, phase_asked
from cagepose.questions.no_motion import WITHIN, NoMotion, Tried
from cagepose.questions.unanswered import Unanswered
from cagepose.runs.cases import cases_of, greatest_friction, with_greatest_friction
from cagepose.runs.drives import displaced_after
from cagepose.runs.judge import critical_friction_at, judge_case
from cagepose.runs.methods import chosen_method
from cagepose.runs.run import Run

UP_TO = 2.0
"""Coefficients are tried up to this one, or to twice the present one or the least one of a balance."""
HALVINGS = 20
"""So many coefficients are tried at first, each twice as far above that of the balance as the one before."""


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
    scene, pose, displaced = run.scene, run.phases[number].pose, displaced_after(run, number)
    of_scene = chosen_method(scene, run.method).friction(scene)
    present = greatest_friction(scene, of_scene)
    balance = critical_friction_at(scene, pose, number, of_scene, displaced)
    if math.isnan(balance):
        return Unanswered("there are more contacts, or choices of faces at edges, than can be asked")
    case = cases_of(scene, of_scene, pose, displaced)
    tried = Tried(
        lambda coefficient: judge_case(scene, with_greatest_friction(case, coefficient), pose, number)[0],
        _first_tried(balance, present),
    )
    return FrictionLimits(
        run.phases[number].name,
        present,
        bool(scene.friction_of),
        balance,
        tried.ranges(),
        len(tried.proofs),
        max(tried.proofs),
    )


def _first_tried(balance: float, present: float) -> set[float]:
    least = balance if math.isfinite(balance) else 0.0
    span = max(UP_TO, 2.0 * present, 2.0 * least) - least
    above = {least + span * 0.5**halving for halving in range(HALVINGS)}
    return {least * (1.0 - WITHIN), least, present, *above}
