"""Questions about one pose, the start of a case, without a run."""

from __future__ import annotations

import math

from cagepose.kernels.boundary.geometry import PlacedCage
from cagepose.kernels.contact.metric import frame_at
from cagepose.kernels.native.kernel import entry
from cagepose.kernels.outcome.cases import Cases, Part, start_of
from cagepose.kernels.outcome.presses import press_at_start
from cagepose.kernels.outcome.publish import begin, end_phase
from cagepose.kernels.outcome.records import Outcome
from cagepose.kernels.outcome.trace import RESTS
from cagepose.kernels.stability.critical_friction import least_friction_of_faces
from cagepose.kernels.stability.proof import ProofWorkspace, are_balanced, stand_at, with_all_freedoms


@entry
def judge_start(phase: int, part: Part, cases: Cases, cage: PlacedCage, at: ProofWorkspace, outcome: Outcome) -> None:
    """Judge the start pose of the first case under the load of a phase.

    Parameters
    ----------
    phase
        Index of the load.
    part, cases
        The scene.
    cage, at
        Scratch.
    outcome
        Filled: the phase's record and its contacts.

    """
    begin(outcome)
    start = start_of(0, part, cases, cage)
    press_at_start(phase, start, cases, at.contacts.pressing)
    end_phase(RESTS, phase, start.position, start.quaternion, start, part, at, outcome)


@entry
def critical_friction(phase: int, part: Part, cases: Cases, cage: PlacedCage, at: ProofWorkspace) -> float:
    """Return the least coefficient of friction at which the contacts can balance the load of a phase at the start pose
    of the first case (5.17); inf: none; NaN: there are too many contacts, or choices of faces, to tell.

    Parameters as for `judge_start`.
    """
    start = start_of(0, part, cases, cage)
    load = start.actions[phase]
    press_at_start(phase, start, cases, at.contacts.pressing)
    asked = with_all_freedoms(at)
    if not stand_at(start.geometry, part.body, start.position, start.quaternion, load, start.friction, asked):
        return math.nan
    return least_friction_of_faces(frame_at(part.body, start.quaternion), asked)


@entry
def is_balanced_at_start(phase: int, part: Part, cases: Cases, cage: PlacedCage, at: ProofWorkspace) -> bool:
    """Whether the contacts can balance the load of a phase, and what presses in it, at the start pose of the first
    case, to first order.

    Parameters as for `judge_start`.
    """
    start = start_of(0, part, cases, cage)
    press_at_start(phase, start, cases, at.contacts.pressing)
    asked = with_all_freedoms(at)
    return are_balanced(
        start.geometry, part.body, start.position, start.quaternion, start.actions[phase], start.friction, asked
    )


@entry
def find_touching(phase: int, part: Part, cases: Cases, cage: PlacedCage, at: ProofWorkspace) -> bool:
    """Find the contacts at the start pose of the first case, and the load of a phase there; False: there are too many.

    Parameters
    ----------
    phase
        Index of the load.
    part, cases
        The scene.
    cage
        Scratch.
    at
        Filled: contacts and load.
    """
    start = start_of(0, part, cases, cage)
    return stand_at(
        start.geometry, part.body, start.position, start.quaternion, start.actions[phase], start.friction, at
    )
