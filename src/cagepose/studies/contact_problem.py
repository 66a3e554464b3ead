"""The contact problem of a pose in plain NumPy, from the scene alone: `ContactProblem`, for checks of what kernels say.

Contacts of points with boxes are found anew, and metric and load, (5.1) to (5.3), are written once more: none of this
is shared with the kernels. Where other shapes touch is what the kernels find.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cagepose.kernels.contact.tolerances import ACROSS
from cagepose.model.checks import FloatArray
from cagepose.model.methods import DEFAULT_METRIC
from cagepose.model.planar import normal_axis
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.actions import body_numbers, wrench_at
from cagepose.runs.cases import contact_friction
from cagepose.runs.drives import displaced_after, pressing_forces
from cagepose.runs.methods import chosen_method
from cagepose.runs.run import Run
from cagepose.runs.tolerances import LEAST_RADIUS_OF_GYRATION
from cagepose.studies.touched_faces import ContactFace, Touch, touched_faces
from cagepose.studies.touched_shapes import touched_shapes


@dataclass(frozen=True, eq=False)
class ContactProblem:
    """Contacts, load and metric at one pose, in the world, about the centre of gravity.

    Attributes
    ----------
    faces
        The contacts that count.
    groups
        Their numbers: of each group one counts at a time (points on edges; sharp edges that meet).
    directions, places
        Of each contact: its outward normal and two tangents, unit vectors (n, 3, 3), and where it is, (n, 3), metres.
    wrenches
        Force and moment of a unit force along each of the directions, (n, 3, 6), metres, and what it does along the way
        of each body that presses, as further columns. The contact pushes the other way.
    friction
        Coefficient of each, (n,).
    load
        Force and moment, and what bodies press with, in loads: scaled, it has length 1, (6,) or more; zero where the
        loads cancel.
    scale
        D^-1/2 of (5.3), (6, 6) or more: scaled wrenches are ``scale @ wrench``. By principal axes, as a needle's
        inertia about its own axis would be lost in a matrix of the world.
    """

    faces: tuple[ContactFace, ...]
    groups: tuple[tuple[int, ...], ...]
    directions: FloatArray
    places: FloatArray
    wrenches: FloatArray
    friction: FloatArray
    load: FloatArray
    scale: FloatArray

    def scaled(self, wrenches: FloatArray) -> FloatArray:
        """Return wrenches (..., 6) in scaled coordinates."""
        return np.asarray(wrenches @ self.scale.T)

    def scaled_twist(self, twist: FloatArray) -> FloatArray:
        """Return a twist, velocity of the centre of gravity and angular velocity, (6,), in scaled coordinates."""
        return np.asarray(np.linalg.pinv(self.scale.T) @ twist)


def contact_problem(run: Run, phase: int) -> ContactProblem:
    """Return the contact problem at the end of a phase, counted from 0, from a run's scene and the pose there."""
    scene, pose = run.scene, run.phases[phase].pose
    of_scene = chosen_method(scene, run.method).friction(scene)
    displaced = displaced_after(run, phase)
    if scene.has_other_shapes:
        touched = touched_shapes(scene, pose, phase, of_scene, displaced)
    else:
        touched = touched_faces(scene, pose, displaced)
    return problem_of(scene, pose, phase, touched, of_scene, displaced)


def problem_of(
    scene: Scene, pose: Pose, phase: int, touched: Sequence[Touch], of_scene: float, displaced: FloatArray
) -> ContactProblem:
    """Return the contact problem of what touches at a pose, under the load of a phase, with ``of_scene`` as the scene's
    friction and the bodies of the cage displaced as for `cases_of`.
    """
    if scene.planar is not None:
        touched = in_plane(scene, pose, touched)
    groups: dict[object, list[int]] = {}
    for number, touch in enumerate(touched):
        groups.setdefault(touch.group, []).append(number)
    faces = tuple(touch.face for touch in touched)
    directions = np.array([touch.directions for touch in touched]).reshape(-1, 3, 3)
    places = np.array([touch.place for touch in touched]).reshape(-1, 3)
    arms = places - pose.transform(scene.object.center_of_gravity_m)
    wrenches = np.concatenate([directions, np.cross(arms[:, None], directions)], axis=2)
    friction = np.array([contact_friction(scene, of_scene, face.point, face.box) for face in faces])
    pressed, forces = _pressed(scene, phase, faces, directions, displaced)
    wrenches = np.concatenate([wrenches, pressed], axis=2)
    scale = _scale(scene, pose, len(forces))
    load = np.concatenate([*wrench_at(scene, phase, pose, displaced), forces])
    load /= float(np.linalg.norm(scale @ load)) or 1.0
    by_group = tuple(map(tuple, groups.values()))
    return ContactProblem(faces, by_group, directions, places, wrenches, friction, load, scale)


def in_plane(scene: Scene, pose: Pose, touched: Sequence[Touch]) -> list[Touch]:
    """Return what touches at a pose of a planar scene, without groups of which one face is across the plane: no motion
    in the plane goes into it.
    """
    center, scale = pose.transform(scene.object.center_of_gravity_m), _scale(scene, pose, 0)
    across = set[object]()
    for touch in touched:
        normal = touch.directions[0]
        wrench = np.concatenate([normal, np.cross(touch.place - center, normal)])
        if np.linalg.norm(scale @ wrench) <= ACROSS:
            across.add(touch.group)
    return [touch for touch in touched if touch.group not in across]


def _pressed(
    scene: Scene, phase: int, faces: Sequence[ContactFace], directions: FloatArray, displaced: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return what unit forces along the directions of contacts do along the ways of k bodies that press, (n, 3, k), and
    how hard each presses where it is, (k,), newtons.
    """
    cage, presses, numbers = scene.cage, scene.loads[phase].press, body_numbers(scene)
    of_elements = dict(zip(cage.element_names, cage.element_bodies, strict=True))
    bodies = np.array([of_elements[face.point] for face in faces], dtype=np.int64)
    found = np.zeros((len(faces), 3, len(presses)))
    for place, (name, press) in enumerate(presses.items()):
        own = bodies == numbers[name]
        found[own, :, place] = -directions[own] @ (cage.pose_world_cage.rotation @ press.along_cage)
    return found, np.array(list(pressing_forces(scene, phase, displaced).values()))


def _scale(scene: Scene, pose: Pose, n_pressing: int) -> FloatArray:
    """Return D^-1/2, D = diag(1, 1, 1, K) along the principal axes of K; that of "drag" prefers none. What presses has
    the object's mass. What a plane holds has none of the force's effect: D is infinite there.
    """
    gyration = scene.object.gyration_m2
    if (scene.metric or DEFAULT_METRIC) == "drag":
        squares, axes = np.full(3, np.trace(gyration) / 3.0), np.eye(3)
    else:
        squares, axes = np.linalg.eigh(gyration)
    scale = np.eye(6 + n_pressing)
    squares = np.maximum(squares, (LEAST_RADIUS_OF_GYRATION * scene.object.reach_m) ** 2)
    principal = (pose.rotation @ axes).T
    scale[3:6, 3:6] = principal / np.sqrt(squares)[:, None]
    if scene.planar is not None:
        normal = normal_axis(scene.planar)
        scale[normal, normal] = 0.0
        scale[3:6, 3:6] = 0.0
        scale[3 + normal, 3 + normal] = 1.0 / math.sqrt(squares @ principal[:, normal] ** 2)
    return scale
