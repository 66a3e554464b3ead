"""Does a motion that friction could have ended obey Coulomb's law? By least squares from its path alone.

Where an event says that the part could stay, no proof that nothing balances the load can be asked for. Instead, from
pose to pose: are there forces, in full and against the slip where a contact slips and in the cone where it sticks, that
leave of the load just this motion? By (5.3) and (5.7) that is b = A f + lambda y, f and lambda >= 0, y the scaled way.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from scipy.optimize import nnls

from audit.case import Answer, FloatArray
from audit.geometry import Acting, Touch, acting, choices, friction_of, load_of, touches
from audit.uniqueness import scaled_rows
from cagepose import Event, Pose, Run, Scene

COULD_STAY = "could stay"
MOST_CHOICES, MOST_STEPS, N_SIDES = 12, 6, 32
SHORTEST = 1e-6
"""In sizes. A shorter step has no direction that is right to a thousandth."""
OPENS = 0.02
"""In lengths of the way: a contact that leaves faster, and has left at the next pose, carries nothing."""
SLIPS = 0.1
"""In lengths of the way: a contact that slips no faster may push any way, as its slip may turn within the step."""
ALLOWED = 0.05
"""In lengths of the load. The way to the next pose is the motion but for what it turns by."""


def goes_on(run: Run) -> Answer:
    """On an event that says `could stay`, the way is a motion that Coulomb's law allows."""
    found, asked = [], False
    for phase in run.phases:
        acts, start = acting(run.scene, load_of(run.scene, phase.name)), phase.start_pose
        for event in phase.events:
            if event.note == COULD_STAY:
                for one, other in _steps(run.scene, start, event):
                    asked = True
                    left = least_left(run.scene, one, other, acts)
                    if left > ALLOWED:
                        found.append(f"{phase.name}: goes on where Coulomb's law leaves {left:.1e} loads of its motion")
                        break
            start = event.pose_world_object
    return found if asked else None


def _steps(scene: Scene, start: Pose, event: Event) -> list[tuple[Pose, Pose]]:
    """Some steps of an event that are long enough to have a direction."""
    poses = [start, *event.path]
    long = [(one, other) for one, other in pairwise(poses) if _way(scene, one, other) > SHORTEST]
    return long[:: max(1, len(long) // MOST_STEPS)]


def _way(scene: Scene, one: Pose, other: Pose) -> float:
    """How far the middle of the object moves, or its turn, in sizes."""
    center = scene.object.center_of_gravity_m
    travel = float(np.linalg.norm(other.transform(center) - one.transform(center))) / scene.size_m
    return max(travel, float(np.linalg.norm(other.rotation - one.rotation)))


def least_left(scene: Scene, one: Pose, other: Pose, acts: Sequence[Acting]) -> float:
    """What forces that obey Coulomb's law along the way leave of the load, beside the motion, in loads: with the choice
    of faces with which it is least.
    """
    stay = {(touch.point, touch.box) for touch in touches(scene, other)}
    chosen, _ = choices(touches(scene, one), MOST_CHOICES, np.random.default_rng(0))
    return min(_left(scene, one, other, each, stay, acts) for each in chosen)


def _left(
    scene: Scene, one: Pose, other: Pose, chosen: Sequence[Touch], stay: set[tuple[int, int]], acts: Sequence[Acting]
) -> float:
    if not chosen:
        return 1.0
    rows, b = scaled_rows(scene, one, chosen, acts)
    y = _scaled_way(scene, one, other)
    columns = [y]
    for row, touch in zip(rows, chosen, strict=True):
        if (touch.point, touch.box) in stay or row[0] @ y > -OPENS * np.linalg.norm(row[0]):
            columns += _forces(row, friction_of(scene, touch), y)
    return float(nnls(np.array(columns).T, b, maxiter=1000)[1])


def _forces(row: FloatArray, mu: float, y: FloatArray) -> list[FloatArray]:
    """The wrenches of what a contact that stays closed can carry in a motion: of one force, or of a pyramid."""
    slip = row[1:] @ y
    speed, arm = float(np.linalg.norm(slip)), float(np.linalg.norm(row[0]))
    if mu == 0.0:
        return [row[0]]
    if speed > SLIPS * arm:
        return [row[0] + mu * slip @ row[1:] / speed]
    angles = 2.0 * np.pi * np.arange(N_SIDES) / N_SIDES
    return [row[0] + mu * (np.cos(a) * row[1] + np.sin(a) * row[2]) for a in angles]


def _scaled_way(scene: Scene, one: Pose, other: Pose) -> FloatArray:
    """The scaled motion (5.3) from one pose to the next, of length 1."""
    gyration = scene.object.gyration_m2
    if scene.metric == "drag":
        gyration = np.eye(3) * np.trace(gyration) / 3.0
    values, axes = np.linalg.eigh(one.rotation @ gyration @ one.rotation.T)
    center, turned = scene.object.center_of_gravity_m, other.rotation @ one.rotation.T
    spin = 0.5 * np.array([turned[2, 1] - turned[1, 2], turned[0, 2] - turned[2, 0], turned[1, 0] - turned[0, 1]])
    way = np.concatenate([other.transform(center) - one.transform(center), axes * np.sqrt(values) @ axes.T @ spin])
    return np.asarray(way / np.linalg.norm(way))
