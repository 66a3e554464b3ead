"""How gravity and forces are scaled against each other, and forces that one force stands for."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np

from cagepose.model.checks import FloatArray, unit_vector
from cagepose.model.load import Force, Load
from cagepose.model.scene import Scene
from cagepose.runs.tolerances import MOMENT_ABOUT_POINT

WEIGHT_BESIDE_FORCE = 1e-6
"""Weight of an object beside a force, as a fraction of it, where mass or magnitude is not given: the force dominates,
and gravity settles only what the force leaves open."""


class ScaledLoad(NamedTuple):
    """Weight and forces of a phase at the scale in which they act together.

    Attributes
    ----------
    gravity
        The weight in the world, (3,).
    forces
        One row for each of `Load.pushes`, (n, 3): in the world, or in the object's frame where the force follows it.
    in_newtons
        Whether these are newtons; else per unit load.
    """

    gravity: FloatArray
    forces: FloatArray
    in_newtons: bool


def scaled_load(scene: Scene, load: Load) -> ScaledLoad:
    """Return the weight and the forces of a phase."""
    mass, gravity, pushes = scene.object.mass_kg, load.gravity_world, load.pushes
    if len(pushes) == 1 and not load.needs_newtons:
        magnitude = pushes[0].magnitude_n
        magnitudes = None if magnitude is None else np.array([magnitude])
        weights, forces, in_newtons = scaled_pushes(mass, gravity, pushes[0].direction[None], magnitudes)
        return ScaledLoad(weights[0], forces, in_newtons)
    forces = np.array([_newtons(push) * push.direction for push in pushes]).reshape(-1, 3)
    if gravity is None:
        return ScaledLoad(np.zeros(3), forces, in_newtons=True)
    if mass is None:  # gravity alone
        return ScaledLoad(unit_vector(gravity, "gravity"), forces, in_newtons=False)
    return ScaledLoad(mass * gravity, forces, in_newtons=True)


def _newtons(push: Force) -> float:
    assert push.magnitude_n is not None  # a load in newtons has been checked for that
    return push.magnitude_n


def scaled_pushes(
    mass_kg: float | None, gravity: FloatArray | None, directions: FloatArray, magnitudes: FloatArray | None
) -> tuple[FloatArray, FloatArray, bool]:
    """Return the weights and forces of phases that differ in their one force, one row for each, and whether they are in
    newtons: unit vectors (n, 3) by (n,) newtons, or None, of which each may also be one row for all. Number by number,
    so that a row has the same bits as alone.
    """
    lengths = np.ones((1, 1)) if magnitudes is None else magnitudes[:, None]
    forces = lengths * directions
    if gravity is None:
        return np.zeros((1, 3)), forces, magnitudes is not None
    if mass_kg is not None and magnitudes is not None:
        return (mass_kg * gravity)[None], forces, True
    # Where newtons do not count, the weight is a part of the force.
    return WEIGHT_BESIDE_FORCE * lengths * unit_vector(gravity, "gravity"), forces, False


def one_force(forces: FloatArray, points: FloatArray) -> tuple[FloatArray, FloatArray] | None:
    """Return (force, point) of the one force that dead forces are equal to however the object turns; None: there is
    none.

    It exists where sum a_i f_i' = a (sum f_i)': for parallel forces, whose point a is their astatic centre, and for
    forces through one point. Forces and points are (n, 3); the points are in the object's frame, as is the one found.
    """
    total = forces.sum(axis=0)
    middle = points.mean(axis=0)
    moments = (points - middle).T @ forces
    size = float(np.linalg.norm(points - middle, axis=1) @ np.linalg.norm(forces, axis=1))
    square = float(total @ total)
    if square <= (MOMENT_ABOUT_POINT * float(np.linalg.norm(forces, axis=1).sum())) ** 2:
        return None
    point = moments @ total / square
    if np.linalg.norm(moments - np.outer(point, total)) > MOMENT_ABOUT_POINT * size:
        return None
    return total, middle + point


def force_unit(scene: Scene, load: Load) -> Literal["N", "load"]:
    """Return the unit of the forces that balance a load."""
    return "N" if scaled_load(scene, load).in_newtons else "load"
