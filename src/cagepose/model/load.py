"""What pushes it: `Force` and `Load`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from cagepose.errors import Problem, SceneError
from cagepose.model.checks import FloatArray, finite_array, unit_vector


@dataclass(frozen=True, init=False, eq=False)
class Force:
    """A push with a direction fixed in the world, at a point fixed on the object (a dead load).

    Attributes
    ----------
    direction_world
        Unit vector, (3,).
    at_object_m
        Application point in the object's frame, (3,), metres. It need not lie on the object.
    magnitude_n
        Newtons; None: one unit of force.
    """

    direction_world: FloatArray
    at_object_m: FloatArray
    magnitude_n: float | None

    def __init__(self, direction: ArrayLike, at_m: ArrayLike, magnitude_n: float | None = None) -> None:
        """
        Raises
        ------
        SceneError
            A zero direction, a wrong shape, NaN or infinite, or a magnitude that is not above zero.
        """
        if magnitude_n is not None and not (np.isfinite(magnitude_n) and magnitude_n > 0.0):
            message = f"is {magnitude_n!r}; a magnitude must be a finite number above zero (turn the direction instead)"
            raise SceneError([Problem(("magnitude",), message)])
        object.__setattr__(self, "direction_world", unit_vector(direction, "direction"))
        object.__setattr__(self, "at_object_m", finite_array(at_m, (3,), "at"))
        object.__setattr__(self, "magnitude_n", None if magnitude_n is None else float(magnitude_n))


@dataclass(frozen=True, init=False, eq=False)
class Load:
    """One phase of a run: gravity, or a force, or both. A phase without gravity has none.

    Attributes
    ----------
    name
        Shown with the phase's events.
    gravity_world
        Gravity as a vector, (3,); its length (m/s^2) counts only together with a mass. None: none in this phase.
    force
        The push; None: gravity alone.
    """

    name: str
    gravity_world: FloatArray | None
    force: Force | None

    def __init__(self, name: str, *, gravity: ArrayLike | None = None, force: Force | None = None) -> None:
        """
        Raises
        ------
        SceneError
            Neither gravity nor a force, or a zero gravity.
        """
        if gravity is None and force is None:
            raise SceneError([Problem((), "has neither gravity nor a force; give at least one of them")])
        if gravity is not None:
            unit_vector(gravity, "gravity")
        object.__setattr__(self, "name", str(name))
        object.__setattr__(self, "gravity_world", None if gravity is None else finite_array(gravity, (3,), "gravity"))
        object.__setattr__(self, "force", force)
