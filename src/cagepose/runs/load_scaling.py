"""How gravity and force are scaled against each other when both act."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cagepose.model.checks import FloatArray, unit_vector
from cagepose.model.load import Load
from cagepose.model.scene import Scene

WEIGHT_BESIDE_FORCE = 1e-6
"""Weight of an object beside a force, as a fraction of it, where mass or magnitude is not given: the force dominates,
and gravity settles only what the force leaves open."""


class ScaledLoad(NamedTuple):
    """Gravity and force of one phase: vectors in the world, (3,). In newtons if all that needs is given, else per unit
    load.
    """

    gravity: FloatArray
    force: FloatArray
    in_newtons: bool


def scaled_load(scene: Scene, load: Load) -> ScaledLoad:
    """Return the two loads of a phase, at the scale in which they act together."""
    none = np.zeros(3)
    mass = scene.object.mass_kg
    if load.force is None:
        assert load.gravity_world is not None
        if mass is None:
            return ScaledLoad(unit_vector(load.gravity_world, "gravity"), none, in_newtons=False)
        return ScaledLoad(mass * load.gravity_world, none, in_newtons=True)
    magnitude = load.force.magnitude_n
    force = load.force.direction_world * (1.0 if magnitude is None else magnitude)
    if load.gravity_world is None:
        return ScaledLoad(none, force, in_newtons=magnitude is not None)
    if mass is not None and magnitude is not None:
        return ScaledLoad(mass * load.gravity_world, force, in_newtons=True)
    weight = WEIGHT_BESIDE_FORCE * float(np.linalg.norm(force))
    return ScaledLoad(weight * unit_vector(load.gravity_world, "gravity"), force, in_newtons=False)
