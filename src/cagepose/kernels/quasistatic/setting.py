"""What does not change during a phase of the quasistatic method."""

from __future__ import annotations

from typing import NamedTuple

from cagepose.kernels.algebra.tolerances import KernelTolerances
from cagepose.kernels.boundary.geometry import Geometry
from cagepose.kernels.contact.friction import Friction
from cagepose.kernels.contact.loads import PhaseLoad
from cagepose.kernels.contact.metric import Body


class Setting(NamedTuple):
    """What does not change during a phase.

    Attributes
    ----------
    geometry, body, load
        The scene, with its cage points and boxes as seen from the centre of gravity, and the load of the phase.
    size_m
        The scene's size, metres.
    friction
        Coefficients of friction.
    turn_step_rad
        Longest turn in one step.
    tolerances
        See there.
    """

    geometry: Geometry
    body: Body
    load: PhaseLoad
    size_m: float
    friction: Friction
    turn_step_rad: float
    tolerances: KernelTolerances
