"""What is asked and what came of it: `Case`, an `Answer` of an oracle, and a `Failure`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cagepose import PhaseRun, Scene

FloatArray = NDArray[np.float64]

Answer = list[str] | None
"""What an oracle finds wrong with a run, in words; None: the run holds nothing that it could ask about."""

BY_FORCES = 1e-6
"""Fraction of the load. Forces that balance it leave less."""


@dataclass(frozen=True)
class Case:
    """One scene of a family.

    Attributes
    ----------
    family, index, seed
        What makes the scene again.
    scene
        As `cagepose.run` takes it.
    ending
        The verdict that it must have, where the family knows it by hand.
    """

    family: str
    index: int
    seed: int
    scene: Scene
    ending: str | None = None

    @property
    def friction(self) -> float:
        return self.scene.friction_coefficient or 0.0


def is_held_by_forces(phase: PhaseRun) -> bool:
    """Whether forces balance the load. Else contacts without play hold a part of it to second order, by forces without
    bound, and the proof says so: then forces say nothing, and only a disturbance can tell.
    """
    return phase.proof.residual <= BY_FORCES or "to second order" not in phase.proof.reason


@dataclass(frozen=True)
class Failure:
    """What one oracle says against the run of one case."""

    family: str
    index: int
    oracle: str
    text: str
