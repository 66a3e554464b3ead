"""PyBullet on a peer body: `TimeStepper` over one client, built beforehand."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pybullet

from bench.peer_body import SPHERE_RADIUS_MM, PeerBody
from bench.rail_case import FloatArray


@dataclass(frozen=True)
class PybulletSettings:
    """What was tuned (`bench.tune`); mass 1.

    Attributes
    ----------
    step_s, window_steps, loads, friction
        As in `bench.engine_mujoco.MujocoSettings`.
    linear_damping, angular_damping
        Part of the velocity lost in a second, 0 to 1.
    units_per_mm
        Bullet's margins and thresholds are lengths, so its results depend on the unit.
    erp, iterations, slop, residual
        contactERP, numSolverIterations, contactSlop and solverResidualThreshold.
    """

    step_s: float = 0.007
    window_steps: int = 20
    loads: tuple[float, float] = (100.0, 200.0)
    linear_damping: float = 0.2
    angular_damping: float = 0.9
    friction: float = 0.1
    units_per_mm: float = 10.0
    erp: float = 1.0
    iterations: int = 50
    slop: float = 0.0
    residual: float = 1e-5


class PybulletStepper:
    """See `bench.settle.TimeStepper`."""

    def __init__(self, body: PeerBody, settings: PybulletSettings) -> None:
        self._settings = settings
        self._client = pybullet.connect(pybullet.DIRECT)
        self._unit = settings.units_per_mm
        self._start_mm, self._start = body.start_mm, body.start_rotation
        # Bullet wants principal axes.
        self._squares, self._axes = np.linalg.eigh(body.gyration_mm2)
        if np.linalg.det(self._axes) < 0.0:
            self._axes[:, 0] *= -1.0
        self._body = self._fill(body)

    def __del__(self) -> None:
        if pybullet.isConnected(self._client):
            pybullet.disconnect(self._client)

    def restart(self) -> None:
        pybullet.resetBasePositionAndOrientation(
            self._body,
            self._unit * self._start_mm,
            _quaternion(self._start @ self._axes),
            physicsClientId=self._client,
        )
        pybullet.resetBaseVelocity(self._body, [0.0] * 3, [0.0] * 3, physicsClientId=self._client)

    def push(self, phase: int, torque: FloatArray, force: FloatArray) -> None:
        size = self._settings.loads[phase] * self._unit
        position, _ = pybullet.getBasePositionAndOrientation(self._body, physicsClientId=self._client)
        frame = pybullet.WORLD_FRAME
        pybullet.applyExternalForce(self._body, -1, size * force, position, frame, physicsClientId=self._client)
        pybullet.applyExternalTorque(self._body, -1, size * self._unit * torque, frame, physicsClientId=self._client)

    def advance(self) -> None:
        pybullet.stepSimulation(physicsClientId=self._client)  # `window_steps` substeps with the same force

    def pose(self) -> tuple[FloatArray, FloatArray]:
        position, quaternion = pybullet.getBasePositionAndOrientation(self._body, physicsClientId=self._client)
        rotation = np.array(pybullet.getMatrixFromQuaternion(quaternion)).reshape(3, 3)
        return np.array(position) / self._unit, rotation @ self._axes.T

    def _fill(self, body: PeerBody) -> int:
        settings, client, unit = self._settings, self._client, self._unit
        pybullet.setGravity(0.0, 0.0, 0.0, physicsClientId=client)
        pybullet.setPhysicsEngineParameter(
            fixedTimeStep=settings.step_s * settings.window_steps,
            numSubSteps=settings.window_steps,
            numSolverIterations=settings.iterations,
            contactERP=settings.erp,
            contactSlop=settings.slop * unit,
            solverResidualThreshold=settings.residual,
            physicsClientId=client,
        )
        turned = self._axes.T
        n_boxes = len(body.half_sizes_mm)
        boxes = pybullet.createCollisionShapeArray(
            shapeTypes=[pybullet.GEOM_BOX] * n_boxes,
            halfExtents=(unit * body.half_sizes_mm).tolist(),
            collisionFramePositions=(unit * body.centers_mm @ turned.T).tolist(),
            collisionFrameOrientations=[_quaternion(turned @ rotation) for rotation in body.box_rotations],
            physicsClientId=client,
        )
        held = pybullet.createMultiBody(1.0, boxes, physicsClientId=client)
        pybullet.changeDynamics(
            held,
            -1,
            localInertiaDiagonal=(unit**2 * self._squares).tolist(),
            linearDamping=settings.linear_damping,
            angularDamping=settings.angular_damping,
            lateralFriction=settings.friction,
            restitution=0.0,
            activationState=pybullet.ACTIVATION_STATE_DISABLE_SLEEPING,
            physicsClientId=client,
        )
        ball = pybullet.createCollisionShape(
            pybullet.GEOM_SPHERE, radius=unit * SPHERE_RADIUS_MM, physicsClientId=client
        )
        for sphere in body.spheres_mm:
            fixed = pybullet.createMultiBody(0.0, ball, basePosition=(unit * sphere).tolist(), physicsClientId=client)
            pybullet.changeDynamics(fixed, -1, lateralFriction=1.0, restitution=0.0, physicsClientId=client)
        return int(held)


def _quaternion(rotation: FloatArray) -> list[float]:
    """Return (x, y, z, w)."""
    from scipy.spatial.transform import Rotation

    return [float(part) for part in Rotation.from_matrix(rotation).as_quat()]
