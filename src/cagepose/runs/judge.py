"""What the mechanics says of any pose: `judge_pose`, `critical_friction_at`."""

from __future__ import annotations

from cagepose.kernels.outcome import at_pose
from cagepose.kernels.outcome.records import empty_outcome
from cagepose.kernels.stability.proof import empty_proof_workspace
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.cases import cases_of, part_of
from cagepose.runs.proof import Proof
from cagepose.runs.run import Contact
from cagepose.runs.solved import judged, written


def judge_pose(scene: Scene, pose: Pose, phase: int, friction: float) -> tuple[Proof, tuple[Contact, ...]]:
    """Return the proof at a pose under the load of a phase, and the contacts with their forces."""
    points = scene.cage.points_world()
    n_contacts = 3 * len(points)
    while True:
        outcome = empty_outcome(len(scene.loads), 1, len(points), n_contacts)
        fits = at_pose.judge_start(
            phase,
            part_of(scene),
            cases_of(scene, friction, pose),
            points,
            empty_proof_workspace(scene.geometry),
            outcome,
        )
        if fits:
            contacts, proofs = judged(scene, written(outcome), [pose] * (phase + 1))
            return proofs[phase], tuple(contacts[phase])
        n_contacts *= 2


def critical_friction_at(scene: Scene, pose: Pose, phase: int) -> float:
    """Return the least coefficient of friction at which the contacts balance the load of a phase (5.17); inf: none."""
    return at_pose.critical_friction(
        phase,
        part_of(scene),
        cases_of(scene, 0.0, pose),
        scene.cage.points_world(),
        empty_proof_workspace(scene.geometry),
    )
