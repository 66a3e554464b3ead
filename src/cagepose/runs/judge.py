"""Judge poses: balance, uniqueness, stability, critical friction (docs/theory/mechanics)."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.record import empty_record
from cagepose.kernels.algebra.tolerances import kernel_tolerances
from cagepose.kernels.algebra.vector import Vector
from cagepose.kernels.collision.contacts import contact_rows
from cagepose.kernels.contact.contact_set import ContactSet
from cagepose.kernels.contact.metric import Body
from cagepose.kernels.stability.critical_friction import critical_friction
from cagepose.kernels.stability.proof import (
    OTHER_ONSET,
    PROVEN_MOVES,
    PROVEN_UNIQUE,
    PROVEN_WITHOUT_FRICTION,
    TOO_MANY_CHOICES,
    TOO_MANY_CONTACTS,
    UNIQUENESS_NOT_SHOWN,
    ProofRoom,
    empty_proof_room,
    prove,
)
from cagepose.kernels.stability.proof_search import first_motion, search_onsets
from cagepose.kernels.stability.second_order import STABILITY_NAMES
from cagepose.model.checks import FloatArray
from cagepose.model.methods import DEFAULT_METRIC
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.frames import Frames
from cagepose.runs.proof import FreeMotion, Proof
from cagepose.runs.run import Contact
from cagepose.runs.weights import dead_loads

REASONS = {
    PROVEN_WITHOUT_FRICTION: "the contacts balance the load without friction",
    PROVEN_UNIQUE: "the contacts balance the load with friction, and every other contact mode is ruled out",
    OTHER_ONSET: "the contacts can balance the load with friction, but Coulomb's law allows this motion too",
    PROVEN_MOVES: "no contact forces balance the load",
    TOO_MANY_CHOICES: "the contacts can balance the load with the first faces at edges that were asked, of too many",
    TOO_MANY_CONTACTS: "more faces touch at one place than a proof has room for",
}
NOT_SHOWN = "the contacts can balance the load with friction, but that the object cannot move was not shown"
WEDGED = "; the contacts can press against each other without a load, as in a wedge"
SAME_NORMAL = 1e-9
"""Radians, as in the kernels: flush faces of two boxes are one contact."""
IN_SPAN = 1e-6
"""Sine of the angle below which a freedom lies in the span of the undetermined ones."""
NO_TURN = 1e-9
"""Turning, in radians for each radius of gyration of travel, that is rounding: Newton's method leaves 1e-11."""


def body_of(scene: Scene) -> Body:
    """Return the metric of a scene: its inertia about the centre of gravity, or the same about every axis ("drag")."""
    gyration = scene.object.gyration_m2
    corners = np.concatenate([box.corners_object() for box in scene.object.boxes])
    reach_m = float(np.linalg.norm(corners - scene.object.center_of_gravity_m, axis=1).max())
    if (scene.metric or DEFAULT_METRIC) == "drag":
        squares, axes = np.full(3, np.trace(gyration) / 3.0), np.eye(3)
    else:
        squares, axes = np.linalg.eigh(gyration)
    body = empty_record(Body)
    body.axes_object[:] = axes.T
    # A needle's inertia about its own axis may come out as zero: no body is thinner than a box may be.
    body.radii[:] = np.sqrt(np.maximum(squares, (1e-9 * reach_m) ** 2))
    body.reach_m = reach_m
    return body


class Judge:
    """Judges poses of one scene; what does not change from pose to pose is made once."""

    def __init__(self, scene: Scene, friction: float) -> None:
        self.scene = scene
        self.friction = friction
        self.frames = Frames(scene, scene.object.center_of_gravity_m)
        self.geometry = self.frames.geometry(scene)
        self.body = body_of(scene)
        self.loads = dead_loads(scene)
        self.tolerances = kernel_tolerances(scene.size_m, scene.tolerances.touch)

    @cached_property
    def _room(self) -> ProofRoom:
        return empty_proof_room(self.geometry)

    def proof(self, pose: Pose, phase: int) -> tuple[Proof, tuple[Contact, ...]]:
        """Return the proof at a pose under the load of a phase, and the contacts with their forces."""
        inside = self.frames.inward(pose)
        code, steady, n_undetermined = prove(
            self.geometry,
            self.body,
            *inside,
            self.loads[phase],
            self.friction,
            self.scene.size_m,
            self.tolerances,
            self._room,
        )
        if code == UNIQUENESS_NOT_SHOWN:
            code = search_onsets(self.friction, self._room)
        elif code == PROVEN_MOVES:
            first_motion(self.friction, self._room)
        room, contacts = self._room.rooms[0], self._room.contacts
        touching = [contacts.rows[i] for i in range(contacts.used[0])]
        names = self.scene.cage.names
        held = code not in (PROVEN_MOVES, TOO_MANY_CONTACTS)
        is_open = held and code not in (PROVEN_WITHOUT_FRICTION, PROVEN_UNIQUE)
        shared = {names[contact.point] for contact in touching if contact.is_shared} if held else set()
        motion = {PROVEN_MOVES: room.solver.y, OTHER_ONSET: room.modes.y}.get(code)
        proof = Proof(
            verdict="moves" if not held else "may rest" if is_open else "rests",
            reason=REASONS.get(code, NOT_SHOWN) + (WEDGED if is_open and room.wedged else ""),
            residual=float(room.solver.residual),
            needs_friction=held and code != PROVEN_WITHOUT_FRICTION,
            stability=STABILITY_NAMES[steady] if held else None,
            undetermined=self._freedoms(pose, room.rest.ways.basis[:n_undetermined, :6]) if held else (),
            shared=tuple(sorted(shared, key=names.index)),
            motion=None if motion is None else self._motion(pose, motion),
        )
        return proof, self._contacts(inside, contacts, held)

    def with_critical_friction(self, proof: Proof, pose: Pose, phase: int) -> Proof:
        """Return the proof with the least coefficient of friction at which the contacts balance the load."""
        least = critical_friction(
            self.geometry, self.body, *self.frames.inward(pose), self.loads[phase], self.tolerances, self._room
        )
        return replace(proof, critical_friction=float(least))

    def _contacts(self, inside: tuple[Vector, Quaternion], contacts: ContactSet, held: bool) -> tuple[Contact, ...]:
        position, quaternion = inside
        rows = contact_rows(self.geometry, position, quaternion, self.scene.touch_m)
        forces = [
            _force(contacts, rows.points[i], rows.boxes[i], rows.normals_world[i]) if held else (None, None)
            for i in range(len(rows.points))
        ]
        return tuple(
            Contact(
                point=self.scene.cage.names[rows.points[i]],
                box=str(self.scene.object.boxes[rows.boxes[i]].name),
                normal_world=rows.normals_world[i].copy(),
                gap_m=float(rows.gaps[i]),
                near_edge=bool(rows.near_edge[i]),
                force_normal_n=normal,
                force_tangential_n=tangential,
            )
            for i, (normal, tangential) in enumerate(forces)
        )

    def _twist(self, pose: Pose, y: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return (velocity of the centre of gravity, angular velocity) of a scaled twist (5.3)."""
        axes_world = self.body.axes_object @ pose.rotation.T
        return y[:3].copy(), axes_world.T @ (y[3:6] / self.body.radii)

    def _motion(self, pose: Pose, y: FloatArray) -> FreeMotion:
        velocity, spin = self._twist(pose, y)
        rate, speed = float(np.linalg.norm(spin)), float(np.linalg.norm(velocity))
        if rate * float(self.body.radii.max()) <= NO_TURN * speed:
            return FreeMotion("travel", velocity / speed, None, None, 0.0)
        axis = spin / rate
        rise = float(axis @ velocity)
        center = pose.transform(self.scene.object.center_of_gravity_m)
        through = center + np.cross(axis, velocity - rise * axis) / rate
        is_turn = abs(rise) <= NO_TURN * max(speed, rate * float(self.body.radii.max()))
        return FreeMotion("turn" if is_turn else "screw", None, axis, through, 0.0 if is_turn else rise / rate)

    def _freedoms(self, pose: Pose, undetermined: FloatArray) -> tuple[str, ...]:
        """Name the freedoms, in the cage's frame, that a set of scaled twists holds."""
        if len(undetermined) == 0:
            return ()
        to_cage = self.scene.cage.pose_world_cage.rotation.T
        radius = float(self.body.radii.max())
        twists = [self._twist(pose, y) for y in undetermined]
        rows = np.array([np.concatenate([to_cage @ velocity, radius * (to_cage @ spin)]) for velocity, spin in twists])
        basis = np.linalg.svd(rows, full_matrices=False)[2]
        found = [name for k, name in enumerate(("x", "y", "z")) if _is_in_span(basis, np.eye(6)[k])]
        turning = np.linalg.svd(basis[:, 3:], full_matrices=False)
        turns = turning[2][turning[1] > IN_SPAN]
        found += [name for k, name in enumerate(("roll", "pitch", "yaw")) if _is_in_span(turns, np.eye(3)[k])]
        return tuple(found) if len(found) >= len(rows) else (*found, "and others" if found else "others")


def _is_in_span(basis: FloatArray, vector: FloatArray) -> bool:
    return bool(np.linalg.norm(vector - basis.T @ (basis @ vector)) < IN_SPAN) if len(basis) else False


def _force(contacts: ContactSet, point: int, box: int, normal: FloatArray) -> tuple[float, FloatArray]:
    """What the contact of a point with a face carries: zero where a flush face of another box stands for it."""
    for i in range(contacts.used[0]):
        contact = contacts.rows[i]
        same_face = contact.point == point and contact.box == box
        if same_face and np.linalg.norm(contact.normal - normal) <= SAME_NORMAL:
            tangential = contact.forces[1:] @ contact.columns[1:, :3]
            return float(contact.forces[0]), -tangential
    return 0.0, np.zeros(3)
