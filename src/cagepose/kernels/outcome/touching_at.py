"""What touches at a pose, without a judgement of it: `find_touching`."""

from __future__ import annotations

from cagepose.kernels.boundary.geometry import PlacedCage
from cagepose.kernels.native.kernel import entry
from cagepose.kernels.outcome.cases import Cases, Part, start_of
from cagepose.kernels.stability.proof import ProofWorkspace, stand_at


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
