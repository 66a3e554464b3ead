"""MuJoCo on a scene that drives bodies of its cage: `DrivenMujoco`, slowly pushed mocap bodies.

The model is that of `cagepose export`, holes as walls of wedges. What a scene has and that format has not:

- a driven body is a mocap body, moved a little before each time step. MuJoCo takes it to stand still in between, so
  that friction with it would see no slip; where there is friction here it is with what does stand still;
- a spring is a spatial tendon, as stiff and as long where it is slack;
- a weight acts as it is, and a force at its point, turned anew a few hundred times.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any
from xml.etree.ElementTree import Element, SubElement, fromstring, tostring

import numpy as np

from bench.rail_case import FloatArray
from cagepose import Load, Pose, Scene, Spring
from cagepose.exchange import mujoco_settings as exchange
from cagepose.exchange.extra import mujoco
from cagepose.exchange.mjcf import mjcf_text, numbers
from cagepose.exchange.mujoco_run import MANY, MEMORY_BYTES
from cagepose.exchange.solids import assembly_of
from cagepose.runs.actions import load_size

LOOKS = 2000
"""So often along a drive its force is looked at, at most."""
AT_END = 0.1
"""Over this last part of the way the force is a mean: it trembles."""
BLOCKED_AT_LOADS = 3.0
LASTING = 5
"""Where the driver pushes with so many times the sum of all loads, and at so many looks in a row, it is blocked or
jams: from the first of them on. A single one is a knock."""


@dataclass(frozen=True)
class DriveSettings(exchange.MujocoSettings):
    """What is tuned (`bench.tune_drives`).

    Attributes
    ----------
    drive_s
        How long a drive takes, seconds.
    settle_s
        For how long each load acts before.
    mass_times
        By how much more mass a part has on which no gravity acts.
    ccd_tolerance
        Of the distances between convex shapes, metres.
    """

    drive_s: float = 2.0
    settle_s: float = 0.3
    mass_times: float = 1.0
    ccd_tolerance: float = 1e-6
    cone: str = "elliptic"


@dataclass(frozen=True, eq=False)
class DriveEnd:
    """How a drive ended.

    Attributes
    ----------
    share, pose
        How much of it was done, and where the object is then.
    along_n
        The sum of the drivers' forces along their ways, where it was blocked: before that.
    is_blocked
        Whether it was.
    look
        The share between two looks at the force: so near it can tell where it is blocked.
    steps
        Of time, in the drive.
    penetration_m
        The depth of the deepest contact there; at the end of the way: over its last part.
    """

    share: float
    pose: Pose
    along_n: float
    is_blocked: bool
    look: float
    steps: int
    penetration_m: float


class DrivenMujoco:
    """A scene whose last phase drives bodies, each by one travel; its model is built here, and run by `run`.

    Raises
    ------
    CageposeError
        As `cagepose.exchange.solids.assembly_of`.
    """

    def __init__(self, scene: Scene, settings: DriveSettings) -> None:
        library = mujoco()
        self._scene, self._settings = scene, settings
        assembly = assembly_of(scene)
        root = fromstring(mjcf_text(assembly))
        _move_bodies(root, scene, {f"cage/{solid.name}": solid.element for solid in assembly.cage})
        self._springs = _add_springs(root, scene)
        description = library.MjSpec.from_string(tostring(root, encoding="unicode"))
        description.memory = MEMORY_BYTES
        self._model = model = description.compile()
        settings.set_options(model.opt)
        model.opt.ccd_tolerance, model.opt.ccd_iterations = settings.ccd_tolerance, MANY
        model.geom_solref[:], model.geom_solimp[:] = settings.reference, settings.impedances
        self._body = model.body("object").id
        model.body_mass[self._body] *= settings.mass_times
        model.body_inertia[self._body] *= settings.mass_times
        mass = float(model.body_mass[self._body])
        model.dof_damping[:3] = settings.damping_per_s * mass
        model.dof_damping[3:6] = settings.damping_per_s * mass * np.diag(scene.object.gyration_m2)
        self._data = library.MjData(model)
        self._library = library
        bodies = {body.name: model.body(_mocap(body.name)).id for body in scene.cage.bodies}
        turn = scene.cage.pose_world_cage.rotation
        self._ways, units = np.zeros((len(bodies), 3)), np.zeros((model.nbody, 3))
        for name, (leg,) in scene.loads[-1].drive.items():
            way = turn @ np.asarray(leg.travel_m)
            self._ways[int(model.body_mocapid[bodies[name]])] = way
            units[bodies[name]] = way / np.linalg.norm(way)
        self._units_of_geoms = units[model.geom_bodyid]
        self._meets = bool(self._units_of_geoms.any())
        self._tendons = [
            (which, model.site(_near(which)).id, model.site(_far(which)).id, units[bodies[spring.of]])
            for which, spring in enumerate(self._springs)
            if spring.of is not None and spring in scene.loads[-1].springs
        ]
        self.error_m = assembly.error_m

    def run(self) -> DriveEnd:
        """Bring the object to rest under each load, then drive."""
        data, settings, scene = self._data, self._settings, self._scene
        self._library.mj_resetData(self._model, data)
        for load in scene.loads:
            self._apply(load)
            for _ in range(round(settings.settle_s / settings.step_s)):
                self._library.mj_step(self._model, data)
        start, steps = data.mocap_pos.copy(), max(round(settings.drive_s / settings.step_s), 1)
        limit = BLOCKED_AT_LOADS * load_size(scene, len(scene.loads) - 1, self._pose())
        every = -(-steps // LOOKS)
        looks = list[tuple[int, float, FloatArray, float]]()
        for step in range(1, steps + 1):
            data.mocap_pos[:] = start + step / steps * self._ways
            self._library.mj_step(self._model, data)
            if step % every:
                continue
            looks.append((step, self._along(), data.qpos.copy(), -float(data.contact.dist.min(initial=0.0))))
            if len(looks) >= LASTING and all(along > limit for _, along, _, _ in looks[-LASTING:]):
                first, _, place, deep_m = looks[-LASTING]
                before = looks[-LASTING - 1][1] if len(looks) > LASTING else 0.0
                return DriveEnd(first / steps, Pose(place[:3], place[3:]), before, True, every / steps, step, deep_m)
            if scene.loads[-1].pushes:
                self._apply(scene.loads[-1])
        last = [look for look in looks if look[0] >= (1.0 - AT_END) * steps]
        along, deep_m = float(np.mean([look[1] for look in last])), max(look[3] for look in last)
        return DriveEnd(1.0, self._pose(), along, False, every / steps, steps, deep_m)

    def _apply(self, load: Load) -> None:
        model, data, pose = self._model, self._data, self._pose()
        model.opt.gravity = np.zeros(3) if load.gravity_world is None else load.gravity_world
        for which, spring in enumerate(self._springs):
            model.tendon_stiffness[which] = spring.stiffness_n_per_m if spring in load.springs else 0.0
        force, moment = np.zeros(3), np.zeros(3)
        for push in load.pushes:
            one = float(push.magnitude_n or 1.0) * push.direction
            force += one
            moment += np.cross(pose.rotation @ (push.at_object(pose) - self._scene.object.center_of_gravity_m), one)
        data.xfrc_applied[self._body] = *force, *moment

    def _along(self) -> float:
        """Return what drives the bodies along their ways, newtons: against contacts and springs."""
        model, data, found = self._model, self._data, 0.0
        wrench = np.zeros(6)
        if self._meets:
            units = self._units_of_geoms[data.contact.geom]
            across = units[:, 0] - units[:, 1]
            for index in np.flatnonzero(across.any(axis=1)).tolist():
                self._library.mj_contactForce(model, data, index, wrench)
                on_second: FloatArray = wrench[:3] @ data.contact.frame[index].reshape(3, 3)
                found += float(on_second @ across[index])
        for which, near, far, unit in self._tendons:
            way = data.site_xpos[far] - data.site_xpos[near]
            length = float(np.linalg.norm(way))
            tension = model.tendon_stiffness[which] * (length - model.tendon_lengthspring[which, 0])
            found += float(tension * way @ unit) / length
        return found

    def _pose(self) -> Pose:
        return Pose(self._data.qpos[:3], self._data.qpos[3:7])


def _mocap(name: str) -> str:
    return f"driven/{name}"


def _near(spring: int) -> str:
    return f"near {spring}"


def _far(spring: int) -> str:
    return f"far {spring}"


def _move_bodies(root: Element, scene: Scene, elements: dict[str, str]) -> None:
    """Move the geoms of each body of the cage from what stands still to a mocap body of its own."""
    world, cage = root.find("worldbody"), root.find("worldbody/body[@name='cage']")
    assert world is not None
    assert cage is not None
    places = {key: cage.attrib[key] for key in ("pos", "quat")}
    numbers_of = dict(zip(scene.cage.element_names, scene.cage.element_bodies, strict=True))
    mocaps = [SubElement(world, "body", {"name": _mocap(b.name), "mocap": "true", **places}) for b in scene.cage.bodies]
    for geom in list(cage):
        number = numbers_of[elements[geom.attrib["name"]]]
        if number:
            cage.remove(geom)
            mocaps[number - 1].append(geom)


def _add_springs(root: Element, scene: Scene) -> list[Spring]:
    """Add a tendon for each spring, with a site at each of its ends, and return the springs in this order."""
    world, held = root.find("worldbody"), root.find("worldbody/body[@name='object']")
    assert world is not None
    assert held is not None
    springs = [spring for load in scene.loads for spring in load.springs]
    tendons: Any = SubElement(root, "tendon") if springs else None
    for which, spring in enumerate(springs):
        start, end = scene.object.pose_world_object.transform(spring.at_object_m), scene.cage.spring_end_world(spring)
        slack_m = float(np.linalg.norm(end - start)) - spring.preload_n / spring.stiffness_n_per_m
        far: Element | None = world
        if spring.of is not None:
            far = root.find(f"worldbody/body[@name='{_mocap(spring.of)}']")
            end = scene.cage.pose_world_cage.inverse_transform(end)
        assert far is not None
        SubElement(held, "site", name=_near(which), pos=numbers(spring.at_object_m))
        SubElement(far, "site", name=_far(which), pos=numbers(end))
        own = {"stiffness": repr(spring.stiffness_n_per_m), "springlength": repr(max(slack_m, 0.0))}
        tendon = SubElement(tendons, "spatial", own)
        SubElement(tendon, "site", site=_near(which))
        SubElement(tendon, "site", site=_far(which))
    return springs
