"""MuJoCo on a peer body: `TimeStepper` over one model, built beforehand."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from bench.peer_body import SPHERE_RADIUS_MM, PeerBody
from bench.rail_case import FloatArray
from cagepose.exchange import mujoco_settings as exchange


@dataclass(frozen=True)
class MujocoSettings(exchange.MujocoSettings):
    """What was tuned (`bench.tune`); lengths in mm, mass 1.

    Attributes
    ----------
    loads
        Size of the load in each phase, as an acceleration in mm/s^2: the rest pose does not depend on it.
    friction
        0: contacts without friction (condim 1); above: condim 3.
    """

    loads: tuple[float, float] = (400.0, 400.0)
    friction: float = 0.1


class MujocoStepper:
    """See `bench.settle.TimeStepper`."""

    def __init__(self, body: PeerBody, settings: MujocoSettings) -> None:
        self._model = _model(body, settings)
        self._data = mujoco.MjData(self._model)
        self._settings = settings

    def restart(self) -> None:
        mujoco.mj_resetData(self._model, self._data)

    def push(self, phase: int, torque: FloatArray, force: FloatArray) -> None:
        size = self._settings.loads[phase]
        self._data.xfrc_applied[1, :3] = size * force
        self._data.xfrc_applied[1, 3:] = size * torque

    def advance(self) -> None:
        mujoco.mj_step(self._model, self._data, self._settings.window_steps)

    def pose(self) -> tuple[FloatArray, FloatArray]:
        rotation = np.empty(9)
        mujoco.mju_quat2Mat(rotation, self._data.qpos[3:7])
        return self._data.qpos[:3].copy(), rotation.reshape(3, 3)


def _model(body: PeerBody, settings: MujocoSettings) -> mujoco.MjModel:
    spec = mujoco.MjSpec()
    settings.set_options(spec.option)
    spec.compiler.balanceinertia = False
    held = spec.worldbody.add_body(name="object", pos=body.start_mm, quat=_quaternion(body.start_rotation))
    held.explicitinertial = True
    held.mass = 1.0
    held.ipos = [0.0, 0.0, 0.0]
    gyration = body.gyration_mm2
    held.fullinertia = [gyration[0, 0], gyration[1, 1], gyration[2, 2], gyration[0, 1], gyration[0, 2], gyration[1, 2]]
    held.add_freejoint()
    for index in range(len(body.half_sizes_mm)):
        held.add_geom(
            name=f"box{index}",
            type=mujoco.mjtGeom.mjGEOM_BOX,
            size=body.half_sizes_mm[index],
            pos=body.centers_mm[index],
            quat=_quaternion(body.box_rotations[index]),
            contype=0,
            conaffinity=0,
        )
    for index, sphere in enumerate(body.spheres_mm):
        spec.worldbody.add_geom(
            name=f"sphere{index}",
            type=mujoco.mjtGeom.mjGEOM_SPHERE,
            size=[SPHERE_RADIUS_MM, 0.0, 0.0],
            pos=sphere,
            contype=0,
            conaffinity=0,
        )
    for point, box in body.pairs:  # only pairs that can meet: MuJoCo need not look for them
        spec.add_pair(
            geomname1=f"sphere{point}",
            geomname2=f"box{box}",
            condim=3 if settings.friction > 0.0 else 1,
            friction=[settings.friction, settings.friction, 0.0, 0.0, 0.0],
            solref=settings.reference,
            solimp=settings.impedances,
        )
    model = spec.compile()
    model.dof_damping[:3] = settings.damping_per_s
    model.dof_damping[3:] = settings.damping_per_s * np.diag(gyration)
    return model


def _quaternion(rotation: FloatArray) -> FloatArray:
    quaternion = np.empty(4)
    mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(rotation).ravel())
    return quaternion
