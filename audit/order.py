"""Does it matter how points and boxes are numbered, or whether a run is one of many? It must not."""

from __future__ import annotations

import numpy as np

from audit.case import Answer
from audit.geometry import farthest_move
from cagepose import Cage, Object, Run, Scene, Variation, run, run_many

SAME_POSE = 1e-6
"""In sizes of the scene."""


def renumbered(scene: Scene, rng: np.random.Generator) -> Scene:
    """The same scene, its points and boxes in another order."""
    points, boxes = rng.permutation(len(scene.cage.names)), rng.permutation(len(scene.object.boxes))
    held, cage = scene.object, scene.cage
    return Scene(
        Object(
            [held.boxes[k] for k in boxes],
            held.center_of_gravity_m,
            pose=held.pose_world_object,
            mass_kg=held.mass_kg,
            inertia_kg_m2=held.inertia_kg_m2,
        ),
        Cage(cage.points_cage[points], [cage.names[k] for k in points], cage.pose_world_cage),
        scene.loads,
        name=scene.name,
        friction_coefficient=scene.friction_coefficient,
        metric=scene.metric,
        tolerances=scene.tolerances,
    )


def order_of_verdicts(one: Run) -> Answer:
    """Renumbered, the scene has the same verdicts."""
    if len(one.scene.cage.names) < 2:
        return None
    told = [[phase.verdict for phase in each.phases] for each in (one, _again(one))]
    return [f"renumbered: {told[1]} instead of {told[0]}"] if told[0] != told[1] else []


def order_of_poses(one: Run) -> Answer:
    """Renumbered, and with the same verdicts, the scene has the same poses at the end of its phases."""
    other = _again(one)
    if [phase.verdict for phase in one.phases] != [phase.verdict for phase in other.phases]:
        return None
    apart = max(farthest_move(one.scene, a.pose, b.pose) for a, b in zip(one.phases, other.phases, strict=True))
    return [f"renumbered: {one.verdict}, {apart:.1e} sizes away"] if apart > SAME_POSE else []


def _again(one: Run) -> Run:
    return run(renumbered(one.scene, np.random.default_rng(1)))


def batch(one: Run) -> Answer:
    """As rows of `run_many` with other coefficients of friction beside, runs are equal to the last bit."""
    mu = one.scene.friction_coefficient or 0.0
    other_mu = 0.1 if mu == 0.0 else 0.5 * mu
    rows = run_many(one.scene, Variation(friction_coefficient=[other_mu, mu]), threads=1)
    found = []
    for row, single in enumerate((run(one.scene.changed(friction_coefficient=other_mu)), one)):
        told = [str(verdict) for verdict in rows.phase_verdicts[row] if verdict]
        verdicts = [phase.verdict for phase in single.phases]
        positions = np.array([phase.pose.position_m for phase in single.phases])
        turns = np.array([phase.pose.quaternion_wxyz for phase in single.phases])
        n = len(verdicts)
        if told != verdicts:
            found.append(f"run_many: {told} instead of {verdicts}")
        elif (rows.position_m[row, :n] != positions).any() or (rows.quaternion_wxyz[row, :n] != turns).any():
            apart = np.abs(rows.position_m[row, :n] - positions).max() / one.scene.size_m
            found.append(f"run_many: another pose, {apart:.1e} sizes away in position")
    return found
