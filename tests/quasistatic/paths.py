"""What tests ask of a run's path: its poses, the loads' potential, and gaps."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from cagepose import Load, PhaseRun, Pose, Run, Scene
from cagepose.runs.load_scaling import scaled_load

RESTS = ("rests", "may rest")
VERDICTS = {*RESTS, "escapes", "stalled", "limit"}


def again(scene: Scene, *, friction: float | None = None, metric: str | None = None) -> Scene:
    """The same scene with another coefficient of friction and another metric."""
    return Scene(
        scene.object,
        scene.cage,
        scene.loads,
        name=scene.name,
        friction_coefficient=friction,
        metric=metric,
        tolerances=scene.tolerances,
    )


def path_of(phase: PhaseRun) -> list[Pose]:
    """Start pose and all poses on the way, the last of them the end."""
    return [phase.start_pose, *(pose for event in phase.events for pose in event.path or (event.pose_world_object,))]


def path_poses(result: Run) -> Iterator[Pose]:
    for phase in result.phases:
        yield from path_of(phase)


def potential(scene: Scene, load: Load, pose: Pose) -> float:
    """Potential of a phase's dead forces, -sum F . x, x where each acts, and springs, in units of total force times
    size; a spring counts there with its preload and what it pulls when it is longer by a size.
    """
    weighed = scaled_load(scene, load)
    value = -weighed.gravity @ pose.transform(scene.object.center_of_gravity_m)
    for push, force in zip(load.pushes, weighed.forces, strict=True):
        value -= force @ pose.transform(push.at_object_m)
    total = np.linalg.norm(weighed.gravity) + np.linalg.norm(weighed.forces)
    for spring in load.springs:
        ends = [place.transform(spring.at_object_m) for place in (scene.object.pose_world_object, pose)]
        start, length = (float(np.linalg.norm(spring.to_m - end)) for end in ends)
        value += spring.preload_n * (length - start) + 0.5 * spring.stiffness_n_per_m * (length - start) ** 2
        total += abs(spring.preload_n) + spring.stiffness_n_per_m * scene.size_m
    return float(value / (total * scene.size_m))


def rows_at(scene: Scene, pose: Pose, within_m: float, points: tuple[str, ...] | None = None) -> list[tuple]:
    """Faces that the points touch: (index of the point, box, axis, side, normal, gap), each face of an edge a row.

    Faces of one box that a point lies over only; written anew here from the boxes, as an oracle must be.
    """
    rows = []
    world = scene.cage.points_world()
    for index, name in enumerate(scene.cage.names):
        if points is not None and name not in points:
            continue
        for box in scene.object.boxes:
            in_box = box.pose_object_box.inverse_transform(pose.inverse_transform(world[index]))
            gaps = np.abs(in_box) - box.size_m / 2.0
            if gaps.max() > within_m:
                continue
            for axis in np.nonzero(np.abs(gaps) <= within_m)[0]:
                side = float(np.copysign(1.0, in_box[axis]))
                normal = side * (pose.rotation @ box.pose_object_box.rotation)[:, axis]
                rows.append((index, box, int(axis), side, normal, float(gaps[axis])))
    return rows


def gap_of(scene: Scene, pose: Pose, row: tuple) -> float:
    """Gap of the same point and face at another pose."""
    index, box, axis, side = row[:4]
    in_box = box.pose_object_box.inverse_transform(pose.inverse_transform(scene.cage.points_world()[index]))
    return float(side * in_box[axis] - box.size_m[axis] / 2.0)
