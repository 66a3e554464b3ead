"""What the mechanics says of any pose: `judge_pose`, `critical_friction_at`."""

from __future__ import annotations

from cagepose.kernels.algebra.least_squares import WRENCH
from cagepose.kernels.boundary.geometry import PlacedCage, empty_cage
from cagepose.kernels.outcome import at_pose
from cagepose.kernels.outcome.cases import Cases
from cagepose.kernels.outcome.records import Outcome, empty_outcome
from cagepose.kernels.stability.proof import ProofWorkspace, empty_proof_workspace
from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.cases import cases_of, part_of
from cagepose.runs.proof import Proof
from cagepose.runs.run import Contact
from cagepose.runs.solved import judged, written


def judge_pose(
    scene: Scene, pose: Pose, phase: int, friction: float, displaced: FloatArray | None = None
) -> tuple[Proof, tuple[Contact, ...]]:
    """Return the proof at a pose under the load of a phase, and the contacts with their forces. The bodies of the cage
    stand still, displaced as for `cases_of`.

    Raises
    ------
    IndexError
        The scene has no such phase.
    """
    return judge_case(scene, cases_of(scene, friction, pose, displaced), pose, phase)


def judge_case(scene: Scene, case: Cases, pose: Pose, phase: int) -> tuple[Proof, tuple[Contact, ...]]:
    """As `judge_pose`, of a case of one that starts at the pose, with a friction or a load of its own.

    Raises
    ------
    IndexError
        The scene has no such phase.
    """
    _, outcome = _judged(scene, case, phase)
    contacts, proofs = judged(scene, written(outcome), [pose] * (phase + 1))
    return proofs[phase], tuple(contacts[phase])


def judged_workspace(
    scene: Scene, pose: Pose, phase: int, friction: float, displaced: FloatArray | None = None
) -> tuple[ProofWorkspace, Outcome]:
    """Judge a pose under the load of a phase, as `judge_pose`; return the memory of that as the kernel has left it, and
    what it wrote.

    Raises
    ------
    IndexError
        The scene has no such phase.
    """
    return _judged(scene, cases_of(scene, friction, pose, displaced), phase)


def _judged(scene: Scene, case: Cases, phase: int) -> tuple[ProofWorkspace, Outcome]:
    cage, at = _cage(scene, phase), empty_proof_workspace(scene.geometry)
    outcome = empty_outcome(scene.geometry, len(scene.loads), 1, 0)
    outcome.displaced[:] = case.displaced
    at_pose.judge_start(phase, part_of(scene), case, cage, at, outcome)
    n_freedoms = WRENCH + len(scene.loads[phase].press)
    return at._replace(contacts=at.contacts._replace(n_freedoms=n_freedoms)), outcome


def critical_friction_at(
    scene: Scene, pose: Pose, phase: int, friction: float, displaced: FloatArray | None = None
) -> float:
    """Return the least coefficient of friction at which the contacts balance the load of a phase (5.17); inf: none.

    Where points or boxes have coefficients of their own, the greatest of all, with all in proportion to what they are
    beside ``friction``. Bodies as for `judge_pose`.

    Raises
    ------
    IndexError
        The scene has no such phase.
    """
    cage = _cage(scene, phase)
    return at_pose.critical_friction(
        phase, part_of(scene), cases_of(scene, friction, pose, displaced), cage, empty_proof_workspace(scene.geometry)
    )


def _cage(scene: Scene, phase: int) -> PlacedCage:
    """Return memory for the cage; kernels check nothing, so the phase is checked here."""
    if not 0 <= phase < len(scene.loads):
        raise IndexError(f"the scene has no phase {phase}; it has {len(scene.loads)}, counted from 0")
    return empty_cage(scene.geometry)
