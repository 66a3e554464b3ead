"""Memory of one contact problem, and its answer."""

from __future__ import annotations

from typing import Annotated

from cagepose.kernels.algebra.least_squares import PassiveSet
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.contact.cone import ConeWorkspace
from cagepose.kernels.contact.coulomb_newton import NewtonWorkspace
from cagepose.kernels.contact.metric import ScaledVector


class SelfStressWorkspace:
    """Memory for self-stresses and their second order; a record.

    Attributes
    ----------
    cone
        One self-stress.
    held
        Span of the normals of all.
    curvature, reduced, vectors
        Their second derivatives, what the free twists see of them, and the eigenvectors of that.
    free
        Scaled twists that keep all the gaps, rows.
    twist
        One of them.
    """

    cone: ConeWorkspace
    held: PassiveSet

    curvature: Annotated[FloatArray, 6, 6]
    reduced: Annotated[FloatArray, 6, 6]
    vectors: Annotated[FloatArray, 6, 6]
    free: Annotated[FloatArray, 6, 6]
    twist: ScaledVector


class ContactWorkspace:
    """Memory for one contact problem, and its answer; a record.

    Attributes
    ----------
    load, load_terms
        Given: the scaled wrench of the load, and the length of its terms (which may cancel).
    cone, newton
        See there. Without a balance ``cone.passive.residual`` is a scaled twist along which the load works and that no
        contact force resists (5.6).
    y, trial
        Scaled twist of the motion, and that with one choice of faces.
    span
        Basis of all that the carrying contacts can push along, if none of them slips.
    stress, stopped, whole_load
        See `self_stress`: memory, a basis of the motions that contacts without play stop to second order, and the load
        before these were taken out of it.
    residual
        What the contacts leave of the load, in its lengths: zero, to rounding, if the object is held.
    """

    load: ScaledVector
    load_terms: float
    cone: ConeWorkspace
    newton: NewtonWorkspace
    y: ScaledVector
    trial: ScaledVector
    span: PassiveSet
    stress: SelfStressWorkspace
    stopped: PassiveSet
    whole_load: ScaledVector
    residual: float
