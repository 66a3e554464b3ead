"""What acts in a phase: `Force`, `Moment` and `Load`; springs, drives and presses stand beside it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
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
from cagepose.model.drive import Drive, drives_of
from cagepose.model.pose import Pose
from cagepose.model.press import Press, presses_of
from cagepose.model.spring import Spring
from cagepose.model.wording import coordinates, counted, few


@dataclass(frozen=True, init=False, eq=False)
class Force:
    """A push at a point that rides on the object, or at a point of the world.

    Attributes
    ----------
    direction
        Unit vector, (3,): in the world, or in the object's frame if the force follows it.
    at_object_m
        Application point in the object's frame, (3,), metres. It need not lie on the object. None: `at_world_m` has it.
    at_world_m
        Application point in the world, (3,), metres, where it stays while the object moves on below it. None: it rides
        on the object.
    magnitude_n
        Newtons; None: one unit of force.
    follows
        Whether it turns with the object (a follower force); else its direction stays fixed in the world (a dead load).
    """

    direction: FloatArray
    at_object_m: FloatArray | None
    at_world_m: FloatArray | None
    magnitude_n: float | None
    follows: bool

    def __init__(
        self,
        direction: ArrayLike,
        at_m: ArrayLike | None = None,
        magnitude_n: float | None = None,
        *,
        at_world_m: ArrayLike | None = None,
        follows: bool = False,
    ) -> None:
        """
        Raises
        ------
        SceneError
            A zero direction, a wrong shape, NaN or infinite, both points or none, a point of the world for a force that
            follows the object, or a magnitude that is not above zero.
        """
        if (at_m is None) == (at_world_m is None):
            wrong = "has neither at nor at_world" if at_m is None else "has both at and at_world"
            raise SceneError([Problem((), f"{wrong}; give one point: at rides on the object, at_world does not")])
        if follows and at_world_m is not None:
            message = "is a point of the world, and the force follows the object; give at, or let it not follow"
            raise SceneError([Problem(("at_world",), message)])
        _set_field(self, "direction", unit_vector(direction, "direction"))
        _set_field(self, "at_object_m", None if at_m is None else finite_array(at_m, (3,), "at"))
        _set_field(self, "at_world_m", None if at_world_m is None else finite_array(at_world_m, (3,), "at_world"))
        _set_field(self, "magnitude_n", None if magnitude_n is None else _magnitude(magnitude_n))
        _set_field(self, "follows", bool(follows))

    def at_object(self, pose: Pose) -> FloatArray:
        """Return where it acts while the object is at a pose: a point in the object's frame, (3,), metres."""
        if self.at_object_m is not None:
            return self.at_object_m
        assert self.at_world_m is not None  # it has one of the two
        return pose.inverse_transform(self.at_world_m)

    @property
    def has_potential(self) -> bool:
        """Whether what it does hangs on the poses alone: it keeps its direction and rides on the object."""
        return self.at_object_m is not None and not self.follows

    def __repr__(self) -> str:
        size = "" if self.magnitude_n is None else f" {self.magnitude_n:.6g} N"
        follows = ", follows" if self.follows else ""
        if self.at_object_m is not None:
            at = f"at {coordinates(self.at_object_m)} m"
        else:
            assert self.at_world_m is not None
            at = f"at {coordinates(self.at_world_m)} m of the world"
        return f"<Force{size} along {coordinates(self.direction, 4)} {at}{follows}>"


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
class Load:
    """One phase of a run: gravity, forces, moments, springs, and bodies of the cage that are driven or that press, at
    least one of these. A phase without gravity has none.

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
    drive
        The legs of each body that is driven, one after the other, by its name; all bodies move together. Empty: none is
        driven.
    stop_at
        At which force of the drive, newtons along the travel, or moment, newton metres about the axis where all legs
        are turns alone, it stops. None: it has no limit.
    press
        How bodies press, by their names; empty: none does. They go on, or give way, until all is at rest.
    pushes
        All forces, whether one or several.
    """

    name: str
    gravity_world: FloatArray | None
    force: Force | None
    forces: tuple[Force, ...]
    moments: tuple[Moment, ...]
    springs: tuple[Spring, ...]
    drive: dict[str, tuple[Drive, ...]]
    stop_at: float | None
    press: dict[str, Press]
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
        drive: Mapping[str, Drive | Sequence[Drive]] | None = None,
        stop_at: float | None = None,
        press: Mapping[str, Press] | None = None,
    ) -> None:
        """
        Raises
        ------
        SceneError
            Nothing that acts, a zero gravity, both ``force`` and ``forces``, arguments of other classes, a force
            without a magnitude beside other forces, moments, springs, a limit or a press, a body without legs, a limit
            that is not above zero, without a drive, or of travels and turns at once, a press of a body that is driven
            along its direction or turned, or a spring that rides on a body that presses.
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
        _set_field(self, "drive", drives_of(drive, problems))
        _set_field(self, "stop_at", stop_at)
        _set_field(self, "press", presses_of(press, problems))
        _set_field(self, "pushes", self.forces if force is None else (force,))
        if force is not None and self.forces:
            problems.add(("forces",), "stands beside force; put all of them into forces")
        problems.raise_if_any()
        self._check_limit(problems)
        self._check_press(problems)
        if gravity is None and self.is_weight_alone:
            nothing = "has no gravity, force, moment, spring, drive or press; give at least one of them"
            raise SceneError([*problems.problems, Problem((), nothing)])
        if gravity is not None:
            unit_vector(gravity, "gravity")
        for index, push in enumerate(self.pushes):
            if push.magnitude_n is None and self.needs_newtons:
                place = ("force",) if force is not None else ("forces", index)
                is_alone = len(self.pushes) == 1 and not self.moments and not self.springs
                beside = "the drive has a limit" if is_alone else "other loads act beside this force"
                beside = "bodies press beside this force" if is_alone and self.press else beside
                problems.add((*place, "magnitude"), f"is missing, and {beside}; give newtons")
        problems.raise_if_any()
        _set_field(self, "gravity_world", None if gravity is None else finite_array(gravity, (3,), "gravity"))

    def __repr__(self) -> str:
        gravity = "" if self.gravity_world is None else f"gravity {coordinates(self.gravity_world, 4)}"
        counts = counted(
            (len(self.pushes), "force", "forces"),
            (len(self.moments), "moment", "moments"),
            (len(self.springs), "spring", "springs"),
        )
        driven = f"drives {few(self.drive)}" if self.drive else ""
        pressed = f"presses {few(self.press)}" if self.press else ""
        return f"<Load {self.name!r}: {', '.join(part for part in (gravity, counts, driven, pressed) if part)}>"

    def _check_limit(self, problems: ProblemList) -> None:
        if self.stop_at is None:
            return
        if not (is_finite(self.stop_at) and self.stop_at > 0.0):
            problems.add(("stop_at",), f"is {self.stop_at!r}; give a finite number above zero")
        elif not self.drive:
            problems.add(("stop_at",), "stands without a drive; leave it out, or drive a body of the cage")
        elif len({leg.is_turn for legs in self.drive.values() for leg in legs}) == 2:
            message = "is of travels and of turns alone, and newtons are no newton metres; leave it out, or give them"
            problems.add(("stop_at",), f"{message} phases of their own")
        else:
            _set_field(self, "stop_at", float(self.stop_at))

    def _check_press(self, problems: ProblemList) -> None:
        for number, spring in enumerate(self.springs):
            if spring.of in self.press:
                message = f"rides on {spring.of}, which presses in this phase; hold it in the world, or on another body"
                problems.add(("springs", number, "of"), message)
        for name, press in self.press.items():
            if any(leg.about_cage is not None for leg in self.drive.get(name, ())):
                message = "presses in a direction that stays, and the drive turns it; let it turn in another phase"
                problems.add(("press", name), message)
            elif any(leg.goes_along(press.along_cage) for leg in self.drive.get(name, ())):
                message = "is driven along the direction in which it presses; there it has its way or its force"
                problems.add(("press", name), message)

    @property
    def is_weight_alone(self) -> bool:
        """Whether nothing but gravity acts, and nothing is driven or presses."""
        return not (self.pushes or self.moments or self.springs or self.drive or self.press)

    @property
    def stops_at_moment(self) -> bool:
        """Whether `stop_at` is a moment, as all legs are turns alone."""
        return all(leg.is_turn for legs in self.drive.values() for leg in legs)

    @property
    def needs_newtons(self) -> bool:
        """Whether its parts only make sense together if all of them are in newtons: all but gravity, one force and a
        drive without a limit.
        """
        has_others = bool(self.moments or self.springs or self.press)
        return len(self.pushes) > 1 or has_others or self.stop_at is not None


_set_field = object.__setattr__


def _magnitude(value: float) -> float:
    if not (is_finite(value) and value > 0.0):
        message = f"is {value!r}; a magnitude must be a finite number above zero (turn the direction instead)"
        raise SceneError([Problem(("magnitude",), message)])
    return float(value)
