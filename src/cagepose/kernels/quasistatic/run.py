"""The steps of a phase, one after the other, until it ends."""

from __future__ import annotations

from typing import NamedTuple

from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.outcome.trace import LIMIT
from cagepose.kernels.quasistatic.setting import Setting
from cagepose.kernels.quasistatic.state import State
from cagepose.kernels.quasistatic.step import GOES_ON, next_step, stand_at
from cagepose.kernels.quasistatic.workspace import QuasistaticWorkspace


class QuasistaticRules(NamedTuple):
    """All numbers of the method.

    Attributes
    ----------
    turn_step_rad
        Longest turn in one step.
    step_limit
        Greatest number of steps in a phase.
    """

    turn_step_rad: float
    step_limit: int


@kernel
def steps_from(
    setting: Setting, state: State, first_step: int, step_limit: int, work: QuasistaticWorkspace
) -> tuple[int, int, State]:
    """Make steps from a state until it ends at rest or otherwise, and write them behind those before ``first_step``, up
    to a limit of all; return (verdict code, number of all steps, state at the end).
    """
    fits = stand_at(setting, state.position, state.quaternion, work)
    for step in range(first_step, step_limit):
        verdict, state, fits = next_step(setting, state, fits, step, work)
        if verdict != GOES_ON:
            return verdict, step + 1, state
    return LIMIT, step_limit, state
