"""How MuJoCo is asked for a rest: settings found by search (`bench.tune`), which benchmark and cross-check share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from cagepose.exchange.extra import mujoco


@dataclass(frozen=True)
class MujocoSettings:
    """What was tuned, but for what depends on the unit of length.

    Attributes
    ----------
    step_s, window_steps
        Time step, and steps in a window of the rule that says when it is at rest.
    damping_per_s
        Drag on all freedoms, for each unit of mass and of inertia.
    time_constant_steps, damping_ratio, impedance
        MuJoCo's solref (time constant in steps) and solimp (all of d0, dmax).
    solver, iterations, tolerance, cone, integrator
        As MuJoCo names them.
    noslip_iterations
        Of the solver that takes back the creep of contacts that stick; zero: it creeps.
    """

    step_s: float = 0.014
    window_steps: int = 10
    damping_per_s: float = 0.5
    time_constant_steps: float = 2.0
    damping_ratio: float = 1.0
    impedance: float = 0.99
    solver: str = "Newton"
    iterations: int = 100
    tolerance: float = 1e-16
    cone: str = "pyramidal"
    integrator: str = "Euler"
    noslip_iterations: int = 0

    @property
    def reference(self) -> list[float]:
        """MuJoCo's solref of contacts."""
        return [self.time_constant_steps * self.step_s, self.damping_ratio]

    @property
    def impedances(self) -> list[float]:
        """MuJoCo's solimp of contacts."""
        return [self.impedance, self.impedance, 0.001, 0.5, 2.0]

    def set_options(self, option: Any) -> None:
        """Set the options of a model or of its description; gravity is none: loads are applied as forces."""
        library = mujoco()
        option.timestep = self.step_s
        option.disableflags |= library.mjtDisableBit.mjDSBL_AUTORESET  # a run that blows up must not start anew
        option.gravity = [0.0, 0.0, 0.0]
        option.solver = getattr(library.mjtSolver, f"mjSOL_{self.solver.upper()}")
        option.iterations = self.iterations
        option.tolerance = self.tolerance
        option.cone = getattr(library.mjtCone, f"mjCONE_{self.cone.upper()}")
        option.integrator = getattr(library.mjtIntegrator, f"mjINT_{self.integrator.upper()}")
        option.noslip_iterations = self.noslip_iterations
        option.noslip_tolerance = self.tolerance
