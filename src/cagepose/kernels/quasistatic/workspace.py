"""Everything that a quasistatic run writes to."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.record import Rows, empty_rows
from cagepose.kernels.boundary.geometry import (
    Geometry,
    PlacedCage,
    Placement,
    empty_cage,
    empty_placement,
    most_elements,
)
from cagepose.kernels.contact.contact_set import ContactSet, contact_set_for
from cagepose.kernels.contact.metric import ScaledVector
from cagepose.kernels.contact.workspace import ContactWorkspace
from cagepose.kernels.outcome.trace import Trace, empty_trace
from cagepose.kernels.quasistatic.implicit_step import ImplicitStepWorkspace
from cagepose.kernels.quasistatic.pushing_out import StepWorkspace, empty_step_workspace
from cagepose.kernels.stability.proof import ProofWorkspace, empty_proof_workspace


class SolverWorkspace:
    """Workspace of fixed size; a record.

    Attributes
    ----------
    solver, stiff
        What the solvers need.
    before, along
        Scaled twists: the motion that is to go on, and the one that goes on as it.
    """

    solver: ContactWorkspace
    stiff: ImplicitStepWorkspace
    before: ScaledVector
    along: ScaledVector


class QuasistaticWorkspace(NamedTuple):
    """All arrays that a run writes to, so that compiled code makes none.

    Attributes
    ----------
    placement, contacts
        The state at the present pose.
    ahead
        Workspace for the contacts at a pose that is tried.
    turned
        Workspace for the contacts in the coordinates of an implicit step.
    scratch
        One workspace of fixed size.
    path
        Workspace of the steps.
    touched
        Which of the cage's points and shapes touched before the step, (n_elements,).
    trace
        Steps of one phase.
    cage
        That of the case that is run.
    proof
        Workspace for the proof of a phase's end.
    """

    placement: Placement
    contacts: ContactSet
    ahead: ContactSet
    turned: ContactSet
    scratch: Rows[SolverWorkspace]
    path: StepWorkspace
    touched: NDArray[np.bool_]
    trace: Trace
    cage: PlacedCage
    proof: ProofWorkspace


def empty_quasistatic_workspace(geometry: Geometry, step_limit: int) -> QuasistaticWorkspace:
    """Return a workspace for one run at a time (plain Python)."""
    n_elements = most_elements(geometry)
    return QuasistaticWorkspace(
        empty_placement(geometry),
        contact_set_for(geometry),
        contact_set_for(geometry),
        contact_set_for(geometry),
        empty_rows(SolverWorkspace, 1),
        empty_step_workspace(geometry),
        np.zeros(n_elements, np.bool_),
        empty_trace(step_limit, n_elements, 0),
        empty_cage(geometry),
        empty_proof_workspace(geometry),
    )
