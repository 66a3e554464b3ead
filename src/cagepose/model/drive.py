"""How a body of the cage is driven: `Drive`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from cagepose.errors import Problem, SceneError
from cagepose.model.checks import FloatArray, ProblemList, check_kinds, finite_array, is_finite, unit_vector
from cagepose.model.pose import Pose
from cagepose.model.tolerances import PARALLEL_SINE
from cagepose.model.wording import coordinates


@dataclass(frozen=True, init=False, eq=False)
class Drive:
    """One leg of a body's way: a straight travel, a turn about an axis, or both together, which is a screw.

    Attributes
    ----------
    travel_m
        In the cage's frame, (3,), metres; of a screw it is along the axis. None: a turn alone.
    about_cage
        Unit vector along the axis of the turn, (3,), in the cage's frame. None: a travel alone.
    through_cage_m
        A point of the axis in the cage's frame, (3,), metres; left out: the origin. None: a travel alone.
    angle_rad
        By which the body turns, right-handed about the axis, radians; below zero: the other way round. None: a travel
        alone.
    """

    travel_m: FloatArray | None
    about_cage: FloatArray | None
    through_cage_m: FloatArray | None
    angle_rad: float | None

    def __init__(
        self,
        travel: ArrayLike | None = None,
        about: ArrayLike | None = None,
        through: ArrayLike | None = None,
        angle: float | None = None,
    ) -> None:
        """
        Raises
        ------
        SceneError
            Neither travel nor turn, a travel or an angle of zero, an axis without an angle or an angle or a point of it
            without an axis, a travel aslant to the axis, a wrong shape, NaN or infinite.
        """
        problems = ProblemList()
        if travel is None and about is None and angle is None:
            problems.add((), "has neither a travel nor a turn; give travel, or about and angle, or all three")
        if about is None and angle is not None:
            problems.add(("about",), "is missing beside an angle; give the axis of the turn")
        if about is not None and angle is None:
            problems.add(("angle",), "is missing beside about; give the angle of the turn")
        if through is not None and about is None:
            problems.add(("through",), "stands without about; give the axis of the turn, or leave it out")
        if angle is not None and not (is_finite(angle) and angle != 0.0):
            problems.add(("angle",), f"is {angle!r}; a turn has a finite angle other than zero")
        problems.raise_if_any()
        if travel is not None and not finite_array(travel, (3,), "travel").any():
            problems.add(("travel",), "is zero, so nothing moves; give a vector of any other length")
        axis = None if about is None else unit_vector(about, "about")
        problems.raise_if_any()
        if travel is not None and axis is not None:
            aslant = float(np.linalg.norm(np.cross(unit_vector(travel, "travel"), axis)))
            if aslant > PARALLEL_SINE:
                message = "is aslant to about, and a screw travels along its axis; give a list of two: travel and turn"
                raise SceneError([Problem(("travel",), message)])
        _set_field(self, "travel_m", None if travel is None else finite_array(travel, (3,), "travel"))
        _set_field(self, "about_cage", axis)
        point = np.zeros(3) if through is None else through
        _set_field(self, "through_cage_m", None if axis is None else finite_array(point, (3,), "through"))
        _set_field(self, "angle_rad", None if angle is None else float(angle))

    def __repr__(self) -> str:
        travel = "" if self.travel_m is None else f"travel {coordinates(self.travel_m)} m"
        turn = ""
        if self.about_cage is not None and self.through_cage_m is not None and self.angle_rad is not None:
            angle = f"{np.degrees(self.angle_rad):.6g} deg about {coordinates(self.about_cage, 4)}"
            turn = f"turn {angle} through {coordinates(self.through_cage_m)} m"
        return f"<Drive: {', '.join(part for part in (travel, turn) if part)}>"

    def moved(self, pose: Pose) -> Drive:
        """Return the same leg of a body whose whole way was moved by a pose, in the cage's frame."""
        through = None if self.through_cage_m is None else pose.transform(self.through_cage_m)
        travel, about = (
            None if vector is None else pose.rotation @ vector for vector in (self.travel_m, self.about_cage)
        )
        return Drive(travel, about, through, self.angle_rad)

    def goes_along(self, direction: FloatArray) -> bool:
        """Whether its travel is not square to a unit vector."""
        if self.travel_m is None:
            return False
        return abs(float(self.travel_m @ direction)) > PARALLEL_SINE * float(np.linalg.norm(self.travel_m))

    @property
    def is_turn(self) -> bool:
        """Whether it is a turn alone, which is driven by a moment."""
        return self.travel_m is None


_set_field = object.__setattr__


def drives_of(given: object, problems: ProblemList) -> dict[str, tuple[Drive, ...]]:
    """Return the legs of each body that is driven, by its name, from one `Drive` or a list of them for each."""
    if given is None:
        return {}
    if not isinstance(given, Mapping):
        message = f"is of type {type(given).__name__}; give a dict of names of bodies, each with a cagepose.Drive"
        problems.add(("drive",), message)
        return {}
    found = {}
    for name, legs in given.items():
        if not isinstance(name, str):
            problems.add(("drive",), f"has the key {name!r}; give the name of a body of the cage")
            continue
        own = ProblemList()
        found[name] = (legs,) if isinstance(legs, Drive) else check_kinds(legs, Drive, name, own)
        if not own.problems and not found[name]:
            own.add((name,), "has no legs; give at least one cagepose.Drive, or leave the body out: it stands still")
        problems.problems += [problem.under("drive") for problem in own.problems]
    return found
