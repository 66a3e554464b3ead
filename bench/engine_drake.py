"""Drake on a peer body: `TimeStepper` over one diagram, built beforehand."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pydrake.geometry import AddContactMaterial, Box, ProximityProperties, Sphere
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import (
    AddMultibodyPlantSceneGraph,
    CoulombFriction,
    DiscreteContactApproximation,
    ExternallyAppliedSpatialForce,
)
from pydrake.multibody.tree import QuaternionFloatingJoint, SpatialInertia, UnitInertia
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from bench.peer_body import SPHERE_RADIUS_MM, PeerBody
from bench.rail_case import FloatArray


@dataclass(frozen=True)
class DrakeSettings:
    """What was tuned (`bench.tune`); lengths in mm, mass 1.

    Attributes
    ----------
    step_s, window_steps, loads, damping_per_s, friction
        As in `bench.engine_mujoco.MujocoSettings`.
    stiffness, dissipation
        Of a point contact: force for each mm, and Hunt and Crossley's dissipation, s/mm.
    approximation
        Drake's discrete contact approximation and so its solver: "sap", "tamsi", "similar", "lagged".
    near_rigid
        SAP's threshold, dimensionless, below which a contact is softened; Drake's default is 1.
    """

    step_s: float = 0.08
    window_steps: int = 3
    loads: tuple[float, float] = (100.0, 200.0)
    damping_per_s: float = 2.0
    friction: float = 0.1
    stiffness: float = 1e7
    dissipation: float = 0.1
    approximation: str = "lagged"
    near_rigid: float = 0.0


class DrakeStepper:
    """See `bench.settle.TimeStepper`."""

    def __init__(self, body: PeerBody, settings: DrakeSettings) -> None:
        self._settings = settings
        builder = DiagramBuilder()
        self._plant, _ = AddMultibodyPlantSceneGraph(builder, settings.step_s)
        self._body = _fill(self._plant, body, settings)
        diagram = builder.Build()
        self._simulator = Simulator(diagram)
        context = self._simulator.get_mutable_context()
        self._plant_context = self._plant.GetMyMutableContextFromRoot(context)
        self._force = ExternallyAppliedSpatialForce()
        self._force.body_index = self._body.index()
        self._start = RigidTransform(RotationMatrix(body.start_rotation), body.start_mm)
        self._windows = 0

    def restart(self) -> None:
        context = self._simulator.get_mutable_context()
        context.SetTime(0.0)
        self._plant.SetFreeBodyPose(self._plant_context, self._body, self._start)
        self._plant.SetVelocities(self._plant_context, np.zeros(6))
        self._windows = 0
        self._force.F_Bq_W = SpatialForce.Zero()
        self._write_force()
        self._simulator.Initialize()

    def push(self, phase: int, torque: FloatArray, force: FloatArray) -> None:
        size = self._settings.loads[phase]
        self._force.F_Bq_W = SpatialForce(size * torque, size * force)
        self._write_force()

    def advance(self) -> None:
        self._windows += 1
        self._simulator.AdvanceTo(self._windows * self._settings.window_steps * self._settings.step_s)

    def pose(self) -> tuple[FloatArray, FloatArray]:
        pose = self._plant.EvalBodyPoseInWorld(self._plant_context, self._body)
        return pose.translation().copy(), pose.rotation().matrix().copy()

    def _write_force(self) -> None:
        self._plant.get_applied_spatial_force_input_port().FixValue(self._plant_context, [self._force])


def _fill(plant, body: PeerBody, settings: DrakeSettings):  # type: ignore[no-untyped-def]
    """Add the object and the spheres to a plant; return the object."""
    plant.mutable_gravity_field().set_gravity_vector(np.zeros(3))
    plant.set_discrete_contact_approximation(
        getattr(DiscreteContactApproximation, f"k{settings.approximation.title()}")
    )
    if settings.approximation == "sap":
        plant.set_sap_near_rigid_threshold(settings.near_rigid)
    g = body.gyration_mm2
    inertia = UnitInertia(g[0, 0], g[1, 1], g[2, 2], g[0, 1], g[0, 2], g[1, 2])
    held = plant.AddRigidBody("object", SpatialInertia(1.0, np.zeros(3), inertia))
    angular_damping = settings.damping_per_s * float(g.diagonal().max())
    plant.AddJoint(
        QuaternionFloatingJoint("free", plant.world_frame(), held.body_frame(), angular_damping, settings.damping_per_s)
    )
    properties = ProximityProperties()
    friction = CoulombFriction(settings.friction, settings.friction)
    # Two equal stiffnesses in a row make half of one.
    AddContactMaterial(settings.dissipation, 2.0 * settings.stiffness, friction, properties)
    for index in range(len(body.half_sizes_mm)):
        place = RigidTransform(RotationMatrix(body.box_rotations[index]), body.centers_mm[index])
        plant.RegisterCollisionGeometry(held, place, Box(*(2.0 * body.half_sizes_mm[index])), f"box{index}", properties)
    for index, sphere in enumerate(body.spheres_mm):
        plant.RegisterCollisionGeometry(
            plant.world_body(), RigidTransform(sphere), Sphere(SPHERE_RADIUS_MM), f"sphere{index}", properties
        )
    plant.Finalize()
    return held
