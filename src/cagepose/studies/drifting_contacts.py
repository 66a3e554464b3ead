"""The contacts at a place of a drive, and how fast it closes them: `drifting_contacts` (8.1)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cagepose.kernels.algebra.least_squares import WRENCH
from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.actions import cage_middle, wrench_at
from cagepose.runs.cases import body_of, contact_friction, greatest_friction
from cagepose.runs.drives import displaced_at, velocity_at
from cagepose.runs.judge import judge_pose
from cagepose.runs.methods import chosen_method
from cagepose.runs.run import Contact, Run
from cagepose.studies.tolerances import SHARE_APART


class DriftingContacts(NamedTuple):
    """Contacts at a place of a drive. Motions of the object are twists about its centre of gravity along its principal
    axes, (6,), the turns times the radii of gyration.

    Attributes
    ----------
    columns
        How fast a motion closes each contact, and slips there along two tangents, (n, 3, 6).
    drift
        How fast the drive does so, as a part of the fastest, (n, 3).
    friction
        Coefficient of each as a part of the greatest one, (n,).
    """

    columns: FloatArray
    drift: FloatArray
    friction: FloatArray


def drifting_contacts(run: Run, phase: int, share: float, pose: Pose) -> DriftingContacts:
    """Return what touches at a place of a phase's drive. Where faces take turns at an edge it is the first one.

    Springs that ride on driven bodies are one more contact, without friction, which gives way along the load that grows
    with the drive, as fast as the fastest body goes: forces that take up this load without bound hold the object, too.
    """
    scene, load = run.scene, run.scene.loads[phase]
    friction = chosen_method(scene, run.method).friction(scene)
    before = [0.0 if ended.drive is None else ended.drive.share for ended in run.phases[:phase]]
    displaced = displaced_at(scene, [*before, share])
    _, found = judge_pose(scene, pose, phase, friction, displaced)
    contacts = [contact for number, contact in enumerate(found) if contact.group == number]
    to_scale = _to_scale(scene, pose)
    rows = [_rows(scene, contact, pose) @ to_scale.T for contact in contacts]
    drifts = [_drift(scene, phase, share, contact) for contact in contacts]
    own = [contact_friction(scene, friction, contact.point, contact.box) for contact in contacts]
    greatest = greatest_friction(scene, friction)
    parts = [coefficient / greatest if greatest > 0.0 else 1.0 for coefficient in own]
    grows = to_scale @ _growth(scene, phase, [*before, share], pose)
    size, fastest = float(np.linalg.norm(grows)), _fastest(scene, phase, share)
    if size > 0.0:
        rows.append(np.concatenate([-grows[None] / size, np.zeros((2, WRENCH))]))
        drifts.append(np.array([fastest, 0.0, 0.0]))
        parts.append(0.0)
    assert load.drive, "a phase without a drive has no curve"
    return DriftingContacts(
        np.array(rows).reshape(-1, 3, WRENCH), np.array(drifts).reshape(-1, 3) / fastest, np.array(parts)
    )


def _to_scale(scene: Scene, pose: Pose) -> FloatArray:
    """Return what turns wrenches in the world into those that work on scaled motions, (6, 6)."""
    body, found = body_of(scene), np.eye(WRENCH)
    found[3:, 3:] = np.asarray(body.axes_object) @ pose.rotation.T / np.asarray(body.radii)[:, None]
    return found


def _rows(scene: Scene, contact: Contact, pose: Pose) -> FloatArray:
    """Return the wrenches in the world, about the centre of gravity, of unit forces along a contact's normal and two
    tangents, (3, 6).
    """
    assert contact.place_world is not None, "contacts of a pose that was judged now have places"
    directions = _directions(contact)
    arm = contact.place_world - pose.transform(scene.object.center_of_gravity_m)
    return np.concatenate([directions, np.cross(arm, directions)], axis=1)


def _directions(contact: Contact) -> FloatArray:
    """Return a contact's normal, out of the object, and two tangents, rows."""
    normal = contact.normal_world
    tangent = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    tangent /= np.linalg.norm(tangent)
    return np.stack([normal, tangent, np.cross(normal, tangent)])


def _drift(scene: Scene, phase: int, share: float, contact: Contact) -> FloatArray:
    """Return how fast the drive closes a contact, and slips there, for a unit share, (3,)."""
    body = scene.cage.element_bodies[scene.cage.element_names.index(contact.point)]
    if body == 0 or contact.place_world is None:
        return np.zeros(3)
    legs = scene.loads[phase].drive.get(scene.cage.bodies[body - 1].name, ())
    velocity, _ = velocity_at(legs, share, scene.cage.pose_world_cage, contact.place_world)
    return -_directions(contact) @ velocity


def _growth(scene: Scene, phase: int, shares: list[float], pose: Pose) -> FloatArray:
    """Return how the load grows for a unit share, as springs ride on driven bodies: force and moment, (6,)."""
    last = min(shares[-1], 1.0 - SHARE_APART)
    before, after = (
        wrench_at(scene, phase, pose, displaced_at(scene, [*shares[:-1], at])) for at in (last, last + SHARE_APART)
    )
    found: FloatArray = np.concatenate([after.force - before.force, after.moment - before.moment]) / SHARE_APART
    return found


def _fastest(scene: Scene, phase: int, share: float) -> float:
    """Return how fast the fastest body goes for a unit share, metres, seen from the middle of the cage."""
    reach_m, middle, fastest = scene.object.reach_m, cage_middle(scene), 0.0
    for legs in scene.loads[phase].drive.values():
        velocity, spin = velocity_at(legs, share, scene.cage.pose_world_cage, middle)
        fastest = max(fastest, float(np.linalg.norm(velocity)), reach_m * float(np.linalg.norm(spin)))
    return fastest
