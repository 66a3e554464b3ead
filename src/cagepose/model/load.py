"""What pushes, turns and pulls it: `Force`, `Moment`, `Spring` and `Load`."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from numpy.typing import ArrayLike

from cagepose.errors import Problem, SceneError
from cagepose.model.checks import (
    FloatArray,
    ProblemList,
    check_kind,
    check_kinds,
    check_text,
    finite_array,
    is_finite,
    unit_vector,
)
from cagepose.model.wording import coordinates, counted


@dataclass(frozen=True, init=False, eq=False)
class Force:
    """A push at a point of the object.

    Attributes
    ----------
    direction
        Unit vector, (3,): in the world, or in the object's frame if the force follows it.
    at_object_m
        Application point in the object's frame, (3,), metres. It need not lie on the object.
    magnitude_n
        Newtons; None: one unit of force.
    follows
        Whether it turns with the object (a follower force); else its direction stays fixed in the world (a dead load).
    """

    direction: FloatArray
    at_object_m: FloatArray
    magnitude_n: float | None
    follows: bool

    def __init__(
        self, direction: ArrayLike, at_m: ArrayLike, magnitude_n: float | None = None, *, follows: bool = False
    ) -> None:
        """
        Raises
        ------
        SceneError
            A zero direction, a wrong shape, NaN or infinite, or a magnitude that is not above zero.
        """
        _set_field(self, "direction", unit_vector(direction, "direction"))
        _set_field(self, "at_object_m", finite_array(at_m, (3,), "at"))
        _set_field(self, "magnitude_n", None if magnitude_n is None else _magnitude(magnitude_n))
        _set_field(self, "follows", bool(follows))

    def __repr__(self) -> str:
        size = "" if self.magnitude_n is None else f" {self.magnitude_n:.6g} N"
        follows = ", follows" if self.follows else ""
        return f"<Force{size} along {coordinates(self.direction, 4)} at {coordinates(self.at_object_m)} m{follows}>"


@dataclass(frozen=True, init=False, eq=False)
class Moment:
    """A pure moment on the object, the same about all points.

    Attributes
    ----------
    direction
        Unit vector along its axis, (3,), right-handed: in the world, or in the object's frame if the moment follows it.
    magnitude_nm
        Newton metres.
    follows
        Whether its axis turns with the object; else it stays fixed in the world.
    """

    direction: FloatArray
    magnitude_nm: float
    follows: bool

    def __init__(self, direction: ArrayLike, magnitude_nm: float, *, follows: bool = False) -> None:
        """
        Raises
        ------
        SceneError
            As for `Force`.
        """
        _set_field(self, "direction", unit_vector(direction, "direction"))
        _set_field(self, "magnitude_nm", _magnitude(magnitude_nm))
        _set_field(self, "follows", bool(follows))

    def __repr__(self) -> str:
        follows = ", follows" if self.follows else ""
        return f"<Moment {self.magnitude_nm:.6g} N m about {coordinates(self.direction, 4)}{follows}>"


@dataclass(frozen=True, init=False, eq=False)
class Spring:
    """A straight spring between a point of the object and a point of the world.

    It pulls the object's point towards the other with the tension ``preload_n + stiffness_n_per_m * (length - length at
    the object's start pose)``, and pushes where that is below zero.

    Attributes
    ----------
    at_object_m
        Where it holds the object, in the object's frame, (3,), metres. It need not lie on the object.
    to_world_m
        Where it is held itself, in the world, (3,), metres.
    stiffness_n_per_m
        Newtons for each metre, zero or more; zero: the tension is that of the preload, whatever the length.
    preload_n
        Tension at the object's start pose, newtons; below zero: it pushes.
    """

    at_object_m: FloatArray
    to_world_m: FloatArray
    stiffness_n_per_m: float
    preload_n: float

    def __init__(self, at_m: ArrayLike, to_m: ArrayLike, stiffness_n_per_m: float, preload_n: float = 0.0) -> None:
        """
        Raises
        ------
        SceneError
            A wrong shape, NaN or infinite, a stiffness below zero, or neither stiffness nor preload.
        """
        problems = ProblemList()
        if not (is_finite(stiffness_n_per_m) and stiffness_n_per_m >= 0.0):
            problems.add(("stiffness",), f"is {stiffness_n_per_m!r}; give a finite number, zero or above")
        if not is_finite(preload_n):
            problems.add(("preload",), f"is {preload_n!r}; give a finite number")
        if not problems.problems and stiffness_n_per_m == 0.0 and preload_n == 0.0:
            problems.add(("stiffness",), "is zero without a preload, so the spring does nothing; give one of them")
        problems.raise_if_any()
        _set_field(self, "at_object_m", finite_array(at_m, (3,), "at"))
        _set_field(self, "to_world_m", finite_array(to_m, (3,), "to"))
        _set_field(self, "stiffness_n_per_m", float(stiffness_n_per_m))
        _set_field(self, "preload_n", float(preload_n))

    def __repr__(self) -> str:
        preload = f", preload {self.preload_n:.6g} N" if self.preload_n else ""
        ends = f"{coordinates(self.at_object_m)} m to {coordinates(self.to_world_m)} m"
        return f"<Spring {ends}: {self.stiffness_n_per_m:.6g} N/m{preload}>"


@dataclass(frozen=True, init=False, eq=False)
class Load:
    """One phase of a run: gravity, forces, moments and springs, at least one of them. A phase without gravity has none.

    Attributes
    ----------
    name
        Shown with the phase's events.
    gravity_world
        Gravity as a vector, (3,); its length (m/s^2) counts only together with a mass. None: none in this phase.
    force
        The only push; None: there is none, or ``forces`` has them.
    forces
        Several pushes.
    moments, springs
        What else acts.
    pushes
        All forces, whether one or several.
    """

    name: str
    gravity_world: FloatArray | None
    force: Force | None
    forces: tuple[Force, ...]
    moments: tuple[Moment, ...]
    springs: tuple[Spring, ...]
    pushes: tuple[Force, ...]

    def __init__(
        self,
        name: str,
        *,
        gravity: ArrayLike | None = None,
        force: Force | None = None,
        forces: Iterable[Force] = (),
        moments: Iterable[Moment] = (),
        springs: Iterable[Spring] = (),
    ) -> None:
        """
        Raises
        ------
        SceneError
            Nothing that acts, a zero gravity, both ``force`` and ``forces``, arguments of other classes, or a force
            without a magnitude beside other forces, moments or springs.
        """
        problems = ProblemList()
        check_text(name, ("name",), problems)
        if force is not None:
            check_kind(force, Force, ("force",), problems)
        _set_field(self, "name", name)
        _set_field(self, "force", force)
        _set_field(self, "forces", check_kinds(forces, Force, "forces", problems))
        _set_field(self, "moments", check_kinds(moments, Moment, "moments", problems))
        _set_field(self, "springs", check_kinds(springs, Spring, "springs", problems))
        _set_field(self, "pushes", self.forces if force is None else (force,))
        if force is not None and self.forces:
            problems.add(("forces",), "stands beside force; put all of them into forces")
        problems.raise_if_any()
        if gravity is None and self.is_weight_alone:
            raise SceneError(
                [Problem((), "has neither gravity nor a force, a moment or a spring; give at least one of them")]
            )
        if gravity is not None:
            unit_vector(gravity, "gravity")
        for index, push in enumerate(self.pushes):
            if push.magnitude_n is None and self.needs_newtons:
                place = ("force",) if force is not None else ("forces", index)
                problems.add((*place, "magnitude"), "is missing, and other loads act beside this force; give newtons")
        problems.raise_if_any()
        _set_field(self, "gravity_world", None if gravity is None else finite_array(gravity, (3,), "gravity"))

    def __repr__(self) -> str:
        gravity = "" if self.gravity_world is None else f"gravity {coordinates(self.gravity_world, 4)}"
        counts = counted(
            (len(self.pushes), "force", "forces"),
            (len(self.moments), "moment", "moments"),
            (len(self.springs), "spring", "springs"),
        )
        return f"<Load {self.name!r}: {', '.join(part for part in (gravity, counts) if part)}>"

    @property
    def is_weight_alone(self) -> bool:
        """Whether nothing but gravity acts."""
        return not (self.pushes or self.moments or self.springs)

    @property
    def needs_newtons(self) -> bool:
        """Whether its parts only make sense together if all of them are in newtons: all but gravity and one force."""
        return len(self.pushes) > 1 or bool(self.moments) or bool(self.springs)


_set_field = object.__setattr__


def _magnitude(value: float) -> float:
    if not (is_finite(value) and value > 0.0):
        message = f"is {value!r}; a magnitude must be a finite number above zero (turn the direction instead)"
        raise SceneError([Problem(("magnitude",), message)])
    return float(value)
