"""What pulls a part towards the world or a body of the cage: `Spring`."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from cagepose.model.checks import FloatArray, ProblemList, check_text, finite_array, is_finite
from cagepose.model.wording import coordinates


@dataclass(frozen=True, init=False, eq=False)
class Spring:
    """A straight spring between a point of the object and a point of the world, or of a body of the cage.

    It pulls the object's point towards the other with the tension ``preload_n + stiffness_n_per_m * (length - length at
    the object's start pose)``, and pushes where that is below zero.

    Attributes
    ----------
    at_object_m
        Where it holds the object, in the object's frame, (3,), metres. It need not lie on the object.
    to_m
        Where it is held itself, (3,), metres: in the world, or in the frame of the body it rides on.
    stiffness_n_per_m
        Newtons for each metre, zero or more; zero: the tension is that of the preload, whatever the length.
    preload_n
        Tension at the object's start pose, newtons; below zero: it pushes.
    of
        Name of the body of the cage that its far end rides on; None: it is held in the world.
    """

    at_object_m: FloatArray
    to_m: FloatArray
    stiffness_n_per_m: float
    preload_n: float
    of: str | None

    def __init__(
        self,
        at_m: ArrayLike,
        to_m: ArrayLike,
        stiffness_n_per_m: float,
        preload_n: float = 0.0,
        *,
        of: str | None = None,
    ) -> None:
        """
        Raises
        ------
        SceneError
            A wrong shape, NaN or infinite, a stiffness below zero, neither stiffness nor preload, or a body that is no
            name.
        """
        problems = ProblemList()
        if not (is_finite(stiffness_n_per_m) and stiffness_n_per_m >= 0.0):
            problems.add(("stiffness",), f"is {stiffness_n_per_m!r}; give a finite number, zero or above")
        if not is_finite(preload_n):
            problems.add(("preload",), f"is {preload_n!r}; give a finite number")
        if not problems.problems and stiffness_n_per_m == 0.0 and preload_n == 0.0:
            problems.add(("stiffness",), "is zero without a preload, so the spring does nothing; give one of them")
        if of is not None:
            check_text(of, ("of",), problems)
        problems.raise_if_any()
        _set_field(self, "at_object_m", finite_array(at_m, (3,), "at"))
        _set_field(self, "to_m", finite_array(to_m, (3,), "to"))
        _set_field(self, "stiffness_n_per_m", float(stiffness_n_per_m))
        _set_field(self, "preload_n", float(preload_n))
        _set_field(self, "of", of)

    def starting_longer(self, by_m: float) -> Spring:
        """Return the same spring for a start at which it is so much longer: with the tension that it has there."""
        tension = self.preload_n + self.stiffness_n_per_m * by_m
        return Spring(self.at_object_m, self.to_m, self.stiffness_n_per_m, tension, of=self.of)

    def __repr__(self) -> str:
        preload = f", preload {self.preload_n:.6g} N" if self.preload_n else ""
        of = "" if self.of is None else f" of {self.of}"
        ends = f"{coordinates(self.at_object_m)} m to {coordinates(self.to_m)} m{of}"
        return f"<Spring {ends}: {self.stiffness_n_per_m:.6g} N/m{preload}>"


_set_field = object.__setattr__
