"""The quasistatic method as seen from a scene: its numbers, and what a careful reader should know of its runs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cagepose.kernels.quasistatic.run import QuasistaticRules
from cagepose.model.scene import Scene
from cagepose.runs.run import PhaseRun
from cagepose.runs.warnings_of_runs import edge_warnings, proof_warnings, seam_warnings, weight_warnings

TURN_STEP_RAD = 0.02
"""Longest turn in one step: the path is wrong by about this fraction of it (docs/theory/mechanics)."""
STEP_LIMIT = 3000
"""Steps in a phase after which a run is named "limit"."""


def quasistatic_rules(_scene: Scene) -> QuasistaticRules:
    """Return the numbers of the method."""
    return QuasistaticRules(TURN_STEP_RAD, STEP_LIMIT)


def quasistatic_warnings(scene: Scene, phases: Sequence[PhaseRun], friction: float) -> Iterator[str]:
    """What a careful reader should know: seams, weights, contacts on edges, and what is less than a proven rest."""
    yield from seam_warnings(scene)
    yield from weight_warnings(scene, len(phases))
    for phase in phases:
        yield from edge_warnings(phase)
    yield from proof_warnings(phases, friction)
