"""Does a stable rest bear a small disturbance? All points move out a little, and the part is let go again."""

from __future__ import annotations

import numpy as np

from audit.balance import AT_REST
from audit.case import Answer, FloatArray, is_held_by_forces
from audit.geometry import acting, farthest_move, half_sizes, load_of, load_size, points_in_boxes
from cagepose import Cage, Object, PhaseRun, Pose, Run, Scene, run

OUT = 1e-7
"""How far points move out, in sizes: a thousandth of a hair for a part of a hand's size."""
NEAR = 1e-5
"""Points within this of the part, in sizes, move; others are far enough away already."""
TRAVEL = 1e-3
"""How far the part may go, in sizes: ten thousand times the disturbance, as levers and wedges make more of it."""
TRAVEL_FOR_FORCE = 1e-5
"""And a hundred times the disturbance for each load of force: by virtual work, F loads at a contact stand for a lever
that moves the part F times as far as the contact."""
TRAVEL_WITH_PLAY: float = 10.0 * OUT**0.5
"""What fits without play tips by the root of the play that it is given."""


def robustness(one: Run) -> Answer:
    """A rest that is called stable stays where it is, within a few disturbances."""
    found, asked = [], False
    for phase in one.phases:
        if phase.verdict == "rests" and phase.proof.stability == "stable":
            asked = True
            again = run(disturbed(one.scene, phase))
            moved, allowed = farthest_move(one.scene, phase.pose, again.pose), _allowed(one.scene, phase)
            if again.verdict not in AT_REST:
                found.append(f"{phase.name}: stable, but after a disturbance of {OUT:g} sizes {again.verdict}")
            elif moved > allowed:
                found.append(f"{phase.name}: stable, but a disturbance of {OUT:g} sizes moves it by {moved:.1e}")
    return found if asked else None


def disturbed(scene: Scene, phase: PhaseRun) -> Scene:
    """The scene of one phase from its end, with the points near the part moved out."""
    held = scene.object
    moved = scene.cage.points_world() + OUT * scene.size_m * _outward(scene, phase.pose)
    return Scene(
        Object(
            held.boxes,
            held.center_of_gravity_m,
            pose=phase.pose,
            mass_kg=held.mass_kg,
            inertia_kg_m2=held.inertia_kg_m2,
        ),
        Cage(moved, scene.cage.names),
        [load_of(scene, phase.name)],
        friction_coefficient=scene.friction_coefficient,
        friction_of=scene.friction_of,
        metric=scene.metric,
        tolerances=scene.tolerances,
    )


def _outward(scene: Scene, pose: Pose) -> FloatArray:
    """For each point near the part the sum of the normals of all faces that it is at, (points, 3); else zero."""
    outward = np.zeros((len(scene.cage.names), 3))
    near_m = NEAR * scene.size_m
    for box, half, places in zip(scene.object.boxes, half_sizes(scene), points_in_boxes(scene, pose), strict=True):
        beyond = np.abs(places) - half
        at = (beyond.max(axis=1) < near_m)[:, None] & (beyond > -near_m)
        outward += (np.where(at, np.sign(places), 0.0)) @ (pose.rotation @ box.pose_object_box.rotation).T
    return outward


def _allowed(scene: Scene, phase: PhaseRun) -> float:
    if not is_held_by_forces(phase):
        return TRAVEL_WITH_PLAY
    load = load_size(acting(scene, load_of(scene, phase.name)))
    largest = max((contact.force_normal_n or 0.0 for contact in phase.contacts), default=0.0) / load
    return max(TRAVEL, TRAVEL_FOR_FORCE * largest)
