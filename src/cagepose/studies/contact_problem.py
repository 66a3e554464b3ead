"""The contact problem of a pose in plain NumPy, from the scene alone: `ContactProblem`, for checks of what kernels say.

Nothing here is shared with the kernels: contacts are found anew by (2.4) and (2.7), the metric and the load of (5.1) to
(5.3) are written once more.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cagepose.model.checks import FloatArray
from cagepose.model.methods import DEFAULT_METRIC
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.actions import wrench_at
from cagepose.runs.cases import contact_friction
from cagepose.runs.methods import chosen_method
from cagepose.runs.run import Run

PROBE, PROBE_MARGIN = 3.0, 1.5
"""In touch tolerances, of (2.7): a face is hidden where a point that far outside of it, and that far from its edge,
lies so deep in another box."""
SAME_NORMAL = 1e-9
"""Flush faces of two boxes give one contact."""
NEEDLE = 1e-9
"""In lengths of the object: no radius of gyration is less."""


@dataclass(frozen=True, order=True)
class ContactFace:
    """One cage point on one face of one box.

    Attributes
    ----------
    point, box
        Names.
    side
        The face as seen from the box's middle: "+x", "-x", "+y", "-y", "+z" or "-z".
    """

    point: str
    box: str
    side: str

    def __str__(self) -> str:
        return f"{self.point} on {self.side} of {self.box}"


@dataclass(frozen=True, eq=False)
class ContactProblem:
    """Contacts, load and metric at one pose, in the world, about the centre of gravity.

    Attributes
    ----------
    faces
        The contacts that count.
    groups
        Their places by point and box: of each group one face counts at a time (points on edges).
    wrenches
        Of each contact: force and moment of a unit force along its outward normal and two tangents, (n, 3, 6), metres.
        The tangents are the next two axes of its box, in the order x, y, z, x, y. The contact pushes the other way.
    friction
        Coefficient of each, (n,).
    load
        Force and moment in loads: scaled, it has length 1, (6,); zero where the loads cancel.
    scale
        D^-1/2 of (5.3), (6, 6): scaled wrenches are ``scale @ wrench``. By principal axes, as a needle's inertia about
        its own axis would be lost in a matrix of the world.
    """

    faces: tuple[ContactFace, ...]
    groups: tuple[tuple[int, ...], ...]
    wrenches: FloatArray
    friction: FloatArray
    load: FloatArray
    scale: FloatArray

    def scaled(self, wrenches: FloatArray) -> FloatArray:
        """Return wrenches (..., 6) in scaled coordinates."""
        return np.asarray(wrenches @ self.scale.T)

    def scaled_twist(self, twist: FloatArray) -> FloatArray:
        """Return a twist, velocity of the centre of gravity and angular velocity, (6,), in scaled coordinates."""
        return np.asarray(np.linalg.solve(self.scale.T, twist))


def contact_problem(run: Run, phase: int) -> ContactProblem:
    """Return the contact problem at the end of a phase, counted from 0, from a run's scene and the pose there."""
    scene, pose = run.scene, run.phases[phase].pose
    of_scene = chosen_method(scene, run.method).friction(scene)
    center = pose.transform(scene.object.center_of_gravity_m)
    faces, axes, arms = _touched_faces(scene, pose, center)
    groups: dict[tuple[str, str], list[int]] = {}
    for place, face in enumerate(faces):
        groups.setdefault((face.point, face.box), []).append(place)
    wrenches = np.concatenate([axes, np.cross(arms[:, None], axes)], axis=2)
    friction = np.array([contact_friction(scene, of_scene, face.point, face.box) for face in faces])
    scale = _scale(scene, pose)
    load = _load(scene, pose, phase)
    load /= float(np.linalg.norm(scale @ load)) or 1.0
    return ContactProblem(tuple(faces), tuple(map(tuple, groups.values())), wrenches, friction, load, scale)


def _touched_faces(scene: Scene, pose: Pose, center: FloatArray) -> tuple[list[ContactFace], FloatArray, FloatArray]:
    """Return the faces touched, for each its normal and two tangents (n, 3, 3), and the arms (n, 3)."""
    points, half_sizes = scene.cage.points_world(), scene.geometry.half_sizes
    rotations = pose.rotation @ scene.geometry.box_rotations
    middles = pose.transform(scene.geometry.box_positions)
    touch_m = scene.touch_m
    faces, axes, arms = list[ContactFace](), list[FloatArray](), list[FloatArray]()
    for name, point in zip(scene.cage.names, points, strict=True):
        normals = list[FloatArray]()
        for box, held in enumerate(scene.object.boxes):
            place = (point - middles[box]) @ rotations[box]
            gaps = np.abs(place) - half_sizes[box]
            if gaps.max() > touch_m:
                continue
            found = [
                axis for axis in np.nonzero(np.abs(gaps) <= touch_m)[0].tolist()
                if not _is_hidden(box, axis, place, gaps, touch_m, half_sizes, rotations, middles)
            ]  # fmt: skip
            outward = [np.copysign(1.0, place[axis]) * rotations[box][:, axis] for axis in found]
            if all(any(np.linalg.norm(one - other) <= SAME_NORMAL for other in normals) for one in outward):
                continue  # flush faces of another box say nothing new
            for axis, normal in zip(found, outward, strict=True):
                side = ("+" if place[axis] > 0.0 else "-") + "xyz"[axis]
                faces.append(ContactFace(name, str(held.name), side))
                axes.append(np.array([normal, rotations[box][:, (axis + 1) % 3], rotations[box][:, (axis + 2) % 3]]))
                arms.append(point - center)
            normals += outward
    return faces, np.array(axes).reshape(-1, 3, 3), np.array(arms).reshape(-1, 3)


def _is_hidden(
    box: int, axis: int, place: FloatArray, gaps: FloatArray, touch_m: float,
    half_sizes: FloatArray, rotations: FloatArray, middles: FloatArray,
) -> bool:  # fmt: skip
    """Whether another box covers the face at a point near its edge (2.7)."""
    is_near_edge = gaps > -touch_m
    is_near_edge[axis] = False
    if not is_near_edge.any():
        return False
    probe = np.where(is_near_edge, np.copysign(half_sizes[box] - PROBE * touch_m, place), place)
    probe[axis] = np.copysign(half_sizes[box][axis] + PROBE * touch_m, place[axis])
    seen = rotations[box] @ probe + middles[box]
    depths = half_sizes - np.abs(np.einsum("bij,bi->bj", rotations, seen - middles))
    depths[box] = -np.inf
    return bool((depths.min(axis=1) > PROBE_MARGIN * touch_m).any())


def _scale(scene: Scene, pose: Pose) -> FloatArray:
    """Return D^-1/2, D = diag(1, 1, 1, K) along the principal axes of K; that of "drag" prefers none."""
    gyration = scene.object.gyration_m2
    if (scene.metric or DEFAULT_METRIC) == "drag":
        squares, axes = np.full(3, np.trace(gyration) / 3.0), np.eye(3)
    else:
        squares, axes = np.linalg.eigh(gyration)
    corners = np.concatenate([box.corners_object() for box in scene.object.boxes])
    reach = float(np.linalg.norm(corners - scene.object.center_of_gravity_m, axis=1).max())
    scale = np.eye(6)
    scale[3:, 3:] = (pose.rotation @ axes).T / np.sqrt(np.maximum(squares, (NEEDLE * reach) ** 2))[:, None]
    return scale


def _load(scene: Scene, pose: Pose, phase: int) -> FloatArray:
    """Return force and moment of a phase's load about the centre of gravity."""
    return np.concatenate(wrench_at(scene, phase, pose))
