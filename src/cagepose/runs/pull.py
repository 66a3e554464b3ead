"""A hand that pulls at an object beside what acts on it in a phase: `pulled_load`, and what a pull compares to."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cagepose.model.checks import FloatArray
from cagepose.model.load import Force, Load
from cagepose.model.scene import Scene
from cagepose.runs.actions import wrenches_at
from cagepose.runs.drives import displaced_after, pressing_forces
from cagepose.runs.load_scaling import force_unit, scaled_load
from cagepose.runs.run import Run

LEAST_OF_GREATEST = 0.01
"""A weight below this part of the greatest force is nothing to compare a pull to."""


class Measure(NamedTuple):
    """What a pull compares to.

    Attributes
    ----------
    greatest
        The greatest force that acts on the object where a phase has ended, moments as forces at its reach; where none
        does, with how much the cage presses.
    unit
        "N", or "load" where neither mass nor magnitudes are given.
    of
        What forces are told in parts of, "weight" or the name of what acts, and how large that is; None: in newtons
        alone.
    """

    greatest: float
    unit: str
    of: tuple[str, float] | None


def pulled_load(scene: Scene, phase: int, name: str, force: FloatArray, at_object_m: FloatArray) -> Load:
    """Return the load of a phase without its drive, and with a force, (3,), beside it that pulls the object at a point
    in its frame, (3,), metres. The force is in the phase's own unit; zero: none does. Where that is not newtons, the
    weight becomes a force at the centre of gravity, as large beside the others as it is in the phase.

    Raises
    ------
    SceneError
        Nothing acts.
    """
    load = scene.loads[phase]
    weighed = scaled_load(scene, load)
    gravity = load.gravity_world if weighed.in_newtons else None
    pulls = [
        Force(
            push.direction,
            push.at_object_m,
            float(np.linalg.norm(row)),
            at_world_m=push.at_world_m,
            follows=push.follows,
        )
        for push, row in zip(load.pushes, weighed.forces, strict=True)
    ]
    if gravity is None and weighed.gravity.any():
        pulls.append(_force(weighed.gravity, scene.object.center_of_gravity_m))
    if force.any():
        pulls.append(_force(force, at_object_m))
    return Load(name, gravity=gravity, forces=pulls, moments=load.moments, springs=load.springs, press=load.press)


def measure(run: Run, phase: int) -> Measure | None:
    """Return what a pull compares to that goes on from the end of a phase of a run; None: nothing acts there."""
    scene, pose, displaced = run.scene, run.phases[phase].pose, displaced_after(run, phase)
    load, unit = scene.loads[phase], force_unit(scene, scene.loads[phase])
    forces = [float(np.linalg.norm(wrench.force)) for wrench in wrenches_at(scene, phase, pose, displaced)]
    turning = [moment.magnitude_nm / scene.object.reach_m for moment in load.moments]
    greatest = max([*forces, *turning]) or max(pressing_forces(scene, phase, displaced).values(), default=0.0)
    if greatest <= 0.0:
        return None
    if forces[0] > LEAST_OF_GREATEST * greatest:
        return Measure(greatest, unit, ("weight", forces[0]))
    return Measure(greatest, unit, None if unit == "N" else (load.name, greatest))


def _force(vector: FloatArray, at_object_m: FloatArray) -> Force:
    return Force(vector, at_object_m, float(np.linalg.norm(vector)))
