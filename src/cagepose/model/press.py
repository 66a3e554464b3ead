"""How a body of the cage presses: `Press`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from numpy.typing import ArrayLike

from cagepose.kernels.contact.pressing import MOST_PRESSING
from cagepose.model.checks import FloatArray, ProblemList, is_finite, unit_vector
from cagepose.model.wording import coordinates, few


@dataclass(frozen=True, init=False, eq=False)
class Press:
    """What pushes a body of the cage along a direction, the only one in which it can move: a force, or a spring.

    Attributes
    ----------
    along_cage
        Unit vector in which it is pushed, (3,), in the cage's frame.
    force_n
        How hard where the body stands in the scene, newtons: the force, or the spring's preload.
    stiffness_n_per_m
        How much less for each metre that the body has gone on, newtons per metre; 0: the force stays the same.
    """

    along_cage: FloatArray
    force_n: float
    stiffness_n_per_m: float

    def __init__(self, along: ArrayLike, force_n: float, stiffness_n_per_m: float = 0.0) -> None:
        """
        Raises
        ------
        SceneError
            A zero direction, a wrong shape, NaN or infinite, a stiffness below zero, or a force that is not above zero,
            but for a spring, which may also be slack or pull.
        """
        problems = ProblemList()
        if not (is_finite(stiffness_n_per_m) and stiffness_n_per_m >= 0.0):
            problems.add(("stiffness",), f"is {stiffness_n_per_m!r}; give a finite number that is not below zero")
        elif not (is_finite(force_n) and (force_n > 0.0 or stiffness_n_per_m > 0.0)):
            message = f"is {force_n!r}; a force that presses is finite and above zero (turn the direction instead)"
            problems.add(("force",), message)
        problems.raise_if_any()
        _set_field(self, "along_cage", unit_vector(along, "along"))
        _set_field(self, "force_n", float(force_n))
        _set_field(self, "stiffness_n_per_m", float(stiffness_n_per_m))

    def __repr__(self) -> str:
        spring = f", spring {self.stiffness_n_per_m:.6g} N/m" if self.stiffness_n_per_m else ""
        return f"<Press {self.force_n:.6g} N along {coordinates(self.along_cage, 4)}{spring}>"


_set_field = object.__setattr__


def presses_of(given: object, problems: ProblemList) -> dict[str, Press]:
    """Return how each body presses, by its name."""
    if given is None:
        return {}
    if not isinstance(given, Mapping):
        message = f"is of type {type(given).__name__}; give a dict of names of bodies, each with a cagepose.Press"
        problems.add(("press",), message)
        return {}
    found = {}
    for name, press in given.items():
        if not isinstance(name, str):
            problems.add(("press",), f"has the key {name!r}; give the name of a body of the cage")
        elif not isinstance(press, Press):
            problems.add(("press", name), f"is of type {type(press).__name__}; give a cagepose.Press")
        else:
            found[name] = press
    if len(found) > MOST_PRESSING:
        message = f"has {len(found)} bodies ({few(found)}); at most {MOST_PRESSING} may press in one phase"
        problems.add(("press",), message)
    return found
