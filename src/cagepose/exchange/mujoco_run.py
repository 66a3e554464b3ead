"""A scene in MuJoCo: `MujocoScene` brings the object to rest, phase by phase.

The exported model is run, without its gravity: what acts is applied as force and moment at the centre of gravity, as
large as lets the object fall a third of the scene's size in a second squared. What drags is in proportion to mass and
inertia, so that it changes how fast the object goes and not which way: much of it for fast motions, which then go as
slowly as those of cagepose, and little for slow ones, which would take long. How far contacts give, which is all that
stands for stiffness here, does not depend on the mass then.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cagepose.errors import CageposeError
from cagepose.exchange.extra import mujoco
from cagepose.exchange.joints import ObjectJoints
from cagepose.exchange.mjcf import mjcf_text
from cagepose.exchange.mujoco_settings import MujocoSettings
from cagepose.exchange.settle import Settled, windows_until_quiet
from cagepose.exchange.solids import Assembly
from cagepose.exchange.tolerances import QUIET_OF_SIZE
from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.runs.actions import load_size, wrench_at

SETTINGS = MujocoSettings(cone="elliptic", noslip_iterations=50)
"""As the benchmark's, but that friction has to hold: its cones are round, and what sticks does not creep."""
FALL_OF_SIZE = 1.0 / 3.0
"""Size of the load as an acceleration, in sizes of the scene for each second squared: the rail's in the benchmark."""
SPEED_OF_SIZE = 1.0 / 15.0
"""At this speed, in sizes for each second, drag is as large as the load."""
WINDOW_LIMIT = 600
RAMP_WINDOWS = 7
"""Windows in which the load grows, to double in each: contacts that first have to give would slip under all of it."""
MEMORY_BYTES = 1 << 28
"""For contacts: holes are hundreds of parts, and MuJoCo's own guess is too small for them."""
FEW, MANY = 1e-14, 200
"""Tolerance (metres) and iterations of MuJoCo's distances between convex shapes; its own end at micrometres."""


@dataclass(frozen=True, eq=False)
class MujocoRest:
    """How MuJoCo ended a phase.

    Attributes
    ----------
    pose
        Of the object in the world.
    penetration_m
        The greatest depth of a contact, metres.
    n_contacts
        How many contacts it has.
    settled
        Whether it came to rest.
    """

    pose: Pose
    penetration_m: float
    n_contacts: int
    settled: Settled


class MujocoScene:
    """The exported model of a scene, with the settings of this module.

    Parameters
    ----------
    assembly
        Of the scene.
    points_object_m
        Points of the object that tell how far it moves, (n, 3), in its frame and in metres.
    """

    def __init__(self, assembly: Assembly, points_object_m: FloatArray) -> None:
        library = mujoco()
        self._scene, self._points, self._joints = assembly.scene, points_object_m, ObjectJoints(assembly.scene)
        description = library.MjSpec.from_string(mjcf_text(assembly))
        description.memory = MEMORY_BYTES
        self._model = description.compile()
        SETTINGS.set_options(self._model.opt)
        self._model.opt.ccd_tolerance, self._model.opt.ccd_iterations = FEW, MANY
        self._model.geom_solref[:], self._model.geom_solimp[:] = SETTINGS.reference, SETTINGS.impedances
        self._body = self._model.body("object").id
        self._data = library.MjData(self._model)
        self._step = library.mj_step
        self._failure = library.FatalError
        self._no_room = (library.mjtWarning.mjWARN_CNSTRFULL, library.mjtWarning.mjWARN_CONTACTFULL)

    def settle(self, phase: int, start: Pose) -> MujocoRest:
        """Bring the object to rest under the load of a phase, from a pose at which it is let go.

        Raises
        ------
        CageposeError
            MuJoCo's pose is no longer a number, or it has no room for all contacts.
        """
        data, scene = self._data, self._scene
        data.qpos[:] = self._joints.coordinates(start)
        data.qvel[:], data.qacc_warmstart[:] = 0.0, 0.0
        mass = float(self._model.body_mass[self._body])
        whole = mass * FALL_OF_SIZE * scene.size_m / load_size(scene, phase, start)

        def advance(share: float = whole) -> FloatArray:
            wrench = wrench_at(scene, phase, self._pose())
            for _ in range(SETTINGS.window_steps):
                self._drag(mass, share * wrench.force, share * wrench.moment)
                self._step(self._model, data)
            return self._pose().transform(self._points)

        try:
            for window in range(RAMP_WINDOWS):
                places = advance(whole * 0.5 ** (RAMP_WINDOWS - window))
            settled = windows_until_quiet(advance, places, QUIET_OF_SIZE * scene.size_m, WINDOW_LIMIT)
        except self._failure as error:
            raise CageposeError(f"MuJoCo gave up: {error}") from error
        if any(data.warning[kind].number > 0 for kind in self._no_room):  # it goes on without some
            raise CageposeError(f"MuJoCo has no room for all contacts of this scene in {MEMORY_BYTES} bytes")
        depth_m = max((-float(distance) for distance in data.contact.dist), default=0.0)
        return MujocoRest(self._pose(), max(depth_m, 0.0), int(data.ncon), settled)

    def _pose(self) -> Pose:
        if not np.isfinite(self._data.qpos).all():
            raise CageposeError("MuJoCo's pose is no longer a number: this scene is too stiff for its time steps")
        return self._joints.pose(self._data.qpos)

    def _drag(self, mass: float, force: FloatArray, moment: FloatArray) -> None:
        """Apply force and moment at the centre of gravity, less drag."""
        data, size_m = self._data, self._scene.size_m
        turn = np.reshape(data.xmat[self._body], (3, 3))
        gyration, (velocity, spin) = self._scene.object.gyration_m2, self._joints.speeds(data.qvel, turn)
        speed = velocity + np.cross(turn @ spin, turn @ self._scene.object.center_of_gravity_m)
        inertial = gyration @ spin
        fast = float(np.sqrt(speed @ speed + spin @ inertial))
        rate = SETTINGS.damping_per_s + FALL_OF_SIZE / SPEED_OF_SIZE**2 * fast / size_m
        data.xfrc_applied[self._body, :3] = force - rate * mass * speed
        data.xfrc_applied[self._body, 3:] = moment - rate * mass * (turn @ inertial)
