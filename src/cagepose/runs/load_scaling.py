"""How gravity and force are scaled against each other when both act."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np

from cagepose.model.checks import FloatArray, unit_vector
from cagepose.model.load import Load
from cagepose.model.scene import Scene

WEIGHT_BESIDE_FORCE = 1e-6
"""Weight of an object beside a force, as a fraction of it, where mass or magnitude is not given: the force dominates,
and gravity settles only what the force leaves open."""


class ScaledLoad(NamedTuple):
    """Gravity and force of one phase: vectors in the world, (3,), or rows of them. In newtons if all that needs is
    given, else per unit load.
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
    magnitudes = None if magnitude is None else np.array([magnitude])
    gravity, force, in_newtons = scaled_pushes(mass, load.gravity_world, load.force.direction_world[None], magnitudes)
    return ScaledLoad(gravity[0], force[0], in_newtons)


def scaled_pushes(
    mass_kg: float | None, gravity: FloatArray | None, directions: FloatArray, magnitudes: FloatArray | None
) -> ScaledLoad:
    """Return the two loads of phases that differ in their force, one row for each: unit vectors (n, 3) by (n,) newtons,
    or None, of which each may also be one row for all. Number by number, so that a row has the same bits as alone.
    """
    lengths = np.ones((1, 1)) if magnitudes is None else magnitudes[:, None]
    forces = lengths * directions
    if gravity is None:
        return ScaledLoad(np.zeros((1, 3)), forces, in_newtons=magnitudes is not None)
    if mass_kg is not None and magnitudes is not None:
        return ScaledLoad((mass_kg * gravity)[None], forces, in_newtons=True)
    # Where newtons do not count, the weight is a part of the force.
    weights = WEIGHT_BESIDE_FORCE * lengths * unit_vector(gravity, "gravity")
    return ScaledLoad(weights, forces, in_newtons=False)


def force_unit(scene: Scene, load: Load) -> Literal["N", "load"]:
    """Return the unit of the forces that balance a load."""
    return "N" if scaled_load(scene, load).in_newtons else "load"
