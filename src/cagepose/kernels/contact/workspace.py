"""Memory of one contact problem, and its answer."""

from __future__ import annotations

from typing import Annotated

from cagepose.kernels.algebra.least_squares import MOST_FREEDOMS, PassiveSet
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.contact.cone import ConeWorkspace
from cagepose.kernels.contact.coulomb_newton import NewtonWorkspace
from cagepose.kernels.contact.coulomb_pivots import PivotWorkspace
from cagepose.kernels.contact.metric import ScaledVector

STRESS_LIMIT = 24
"""Self-stresses that are asked for, each of contacts that are not in one before it."""


class SelfStressWorkspace:
    """Memory for self-stresses and their second order; a record.

    Attributes
    ----------
    cone, reaction
        One self-stress, and the forces of contacts that are locked already.
    pressed
        Span of the normals of the locked contacts.
    curvatures
        Second derivatives of each self-stress.
    reduced, vectors
        What the free twists see of one of them, and its eigenvectors.
    free
        Scaled twists that are not locked, rows.
    twist, imbalance
        One of them, and a wrench.
    """

    cone: ConeWorkspace
    reaction: ConeWorkspace
    pressed: PassiveSet
    curvatures: Annotated[FloatArray, STRESS_LIMIT, MOST_FREEDOMS, MOST_FREEDOMS]
    reduced: Annotated[FloatArray, MOST_FREEDOMS, MOST_FREEDOMS]
    vectors: Annotated[FloatArray, MOST_FREEDOMS, MOST_FREEDOMS]
    free: Annotated[FloatArray, MOST_FREEDOMS, MOST_FREEDOMS]
    twist: ScaledVector
    imbalance: ScaledVector


class ContactWorkspace:
    """Memory for one contact problem, and its answer; a record.

    Attributes
    ----------
    load, load_terms
        Given: the scaled wrench of the load, and the length of its terms (which may cancel).
    cone, newton, pivots
        See there. Without a balance ``cone.passive.residual`` is a scaled twist along which the load works and that no
        contact force resists (5.6).
    y, trial
        Scaled twist of the motion, and that with one choice of faces.
    span
        Basis of all that the carrying contacts can push along, if none of them slips.
    stress, stopped, locked, whole_load
        See `self_stress`: memory, bases of the motions that contacts without play stop to second order and of all that
        is taken out of the problem with them, and the load before that.
    has_locked
        Whether they lock anything with one of the choices of faces that have been asked.
    residual
        What the contacts leave of the load, in its lengths: zero, to rounding, if the object is held by forces.
    is_second_order
        Whether a rest leaves more, along what contacts without play stop.
    is_chained
        Whether some contacts without play are locked only because others stop motions to second order.
    """

    load: ScaledVector
    load_terms: float
    cone: ConeWorkspace
    newton: NewtonWorkspace
    pivots: PivotWorkspace
    y: ScaledVector
    trial: ScaledVector
    span: PassiveSet
    stress: SelfStressWorkspace
    stopped: PassiveSet
    locked: PassiveSet
    whole_load: ScaledVector
    has_locked: bool
    residual: float
    is_second_order: bool
    is_chained: bool
