"""Does it matter how points and boxes are numbered, or whether a run is one of many? It must not."""

from __future__ import annotations

import numpy as np

from audit.case import Answer, FloatArray
from audit.geometry import farthest_move
from cagepose import Cage, Force, Load, Object, Pose, Run, Runs, Scene, SceneError, Variation, run, run_many

SAME_POSE = 1e-6
"""In sizes of the scene."""
MOST_SHIFT = 1e-4
"""In sizes. The cage in a row of a batch is shifted by this at most: few points come inside, and the way is another
one."""


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
        friction_of=scene.friction_of,
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
    """Renumbered, and with the same verdicts, the scene has the same poses at the end of its phases, but for an escape:
    that ends wherever nothing is in the way any more.
    """
    other = _again(one)
    if [phase.verdict for phase in one.phases] != [phase.verdict for phase in other.phases]:
        return None
    pairs = [(a, b) for a, b in zip(one.phases, other.phases, strict=True) if a.verdict != "escapes"]
    apart = max((farthest_move(one.scene, a.pose, b.pose) for a, b in pairs), default=0.0)
    return [f"renumbered: {one.verdict}, {apart:.1e} sizes away"] if apart > SAME_POSE else []


def _again(one: Run) -> Run:
    return run(renumbered(one.scene, np.random.default_rng(1)))


def batch(one: Run) -> Answer:
    """As a row of `run_many`, among others with another friction, place and push, a run is equal to the last bit."""
    scene, rng = one.scene, np.random.default_rng(2)
    mu = scene.friction_coefficient or 0.0
    frictions = [0.1 if mu == 0.0 else 0.5 * mu, mu, mu]
    shifts = MOST_SHIFT * scene.size_m * np.array([[0.0] * 3, [0.0] * 3, rng.uniform(-1, 1, 3)])
    positions = scene.cage.pose_world_cage.position_m + shifts
    pushes = [load for load in scene.loads if load.force is not None]
    directions = rng.normal(size=(3, 3)) if len(pushes) == 1 else None
    if directions is not None and pushes[0].force is not None:
        directions[1] = pushes[0].force.direction
    rows = run_many(
        scene,
        Variation(friction_coefficient=frictions, cage_position_m=positions, force_direction_world=directions),
        threads=1,
    )
    found = []
    for row, (friction, position) in enumerate(zip(frictions, positions, strict=True)):
        if row == 1:
            found += _row_differs(rows, row, one)
            continue
        try:
            changed = _changed(scene, friction, position, None if directions is None else directions[row])
        except SceneError:  # a point has come inside, and `run_many` must say so
            if rows.phase_verdicts[row, 0] != "invalid":
                found.append(f"run_many, row {row}: {rows.phase_verdicts[row, 0]} of a scene that is refused")
        else:
            found += _row_differs(rows, row, run(changed))
    return found


def _row_differs(rows: Runs, row: int, single: Run) -> list[str]:
    told = [str(verdict) for verdict in rows.phase_verdicts[row] if verdict]
    verdicts = [phase.verdict for phase in single.phases]
    if told != verdicts:
        return [f"run_many, row {row}: {told} instead of {verdicts}"]
    positions = np.array([phase.pose.position_m for phase in single.phases])
    turns = np.array([phase.pose.quaternion_wxyz for phase in single.phases])
    there, turned = rows.position_m[row, : len(told)], rows.quaternion_wxyz[row, : len(told)]
    if (there == positions).all() and (turned == turns).all():
        return []
    apart = max(np.abs(there - positions).max() / single.scene.size_m, np.abs(turned - turns).max())
    return [f"run_many, row {row}: {single.verdict}, but {apart:.1e} sizes or rad away"]


def _changed(scene: Scene, friction: float, position: FloatArray, direction: FloatArray | None) -> Scene:
    """The scene of one row, built as one would build it alone."""
    loads = [
        load
        if load.force is None or direction is None
        else Load(
            load.name,
            gravity=load.gravity_world,
            force=Force(direction, load.force.at_object_m, load.force.magnitude_n),
        )
        for load in scene.loads
    ]
    cage = scene.cage
    return Scene(
        scene.object,
        Cage(cage.points_cage, cage.names, Pose(position, cage.pose_world_cage.quaternion_wxyz)),
        loads,
        friction_coefficient=friction,
        friction_of=scene.friction_of,
        method=scene.method,
        metric=scene.metric,
        tolerances=scene.tolerances,
    )
