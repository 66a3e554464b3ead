"""What differs from run to run of one scene: `Variation`."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import ArrayLike

from cagepose.model.checks import FloatArray, ProblemList, finite_array
from cagepose.model.load import Force
from cagepose.model.scene import Scene
from cagepose.model.wording import number_of


@dataclass(frozen=True, eq=False)
class Variation:
    """Values that stand in the place of the scene's own, one row for each run; None: as in the scene.

    Attributes
    ----------
    cage_position_m, cage_euler_zyx
        The cage's pose in the world, (n, 3) each: metres, and intrinsic ZYX angles in radians.
    points_cage_m
        All cage points in the cage's frame, (n, n_points, 3), metres: to vary a gap, move its point.
    object_position_m, object_euler_zyx
        The object's pose in the world at the start, as for the cage.
    friction_coefficient
        (n,).
    force_direction_world, force_at_object_m, force_magnitude_n
        Of the one force of all phases: (n, 3) of any length but zero, in the object's frame if it follows; (n, 3)
        metres, of a force that rides on the object; and (n,) newtons.
    """

    cage_position_m: ArrayLike | None = None
    cage_euler_zyx: ArrayLike | None = None
    points_cage_m: ArrayLike | None = None
    object_position_m: ArrayLike | None = None
    object_euler_zyx: ArrayLike | None = None
    friction_coefficient: ArrayLike | None = None
    force_direction_world: ArrayLike | None = None
    force_at_object_m: ArrayLike | None = None
    force_magnitude_n: ArrayLike | None = None

    def __repr__(self) -> str:
        given = {field.name: value for field in fields(self) if (value := getattr(self, field.name)) is not None}
        rows = ", ".join(f"{name} {np.shape(value)}" for name, value in given.items())
        return f"<Variation of {rows or 'nothing'}>"

    def columns(self, scene: Scene) -> tuple[int, dict[str, FloatArray]]:
        """Return the number of runs and what is given, checked, by name.

        Raises
        ------
        SceneError
            Another shape than a scene needs, NaN or infinite, unequal numbers of rows, a negative friction, a force
            that is zero, one where the scene has none or more than one, or a point on the object of one that acts at a
            point of the world.
        """
        given = {field.name: getattr(self, field.name) for field in fields(self)}
        shapes: dict[str, tuple[int, ...]] = {"points_cage_m": (-1, len(scene.cage.names), 3)}
        shapes |= {"friction_coefficient": (-1,), "force_magnitude_n": (-1,)}
        found = {
            name: finite_array(value, shapes.get(name, (-1, 3)), name)
            for name, value in given.items()
            if value is not None
        }
        problems = ProblemList()
        n_runs = len(next(iter(found.values()))) if found else 1
        for name, array in found.items():
            if len(array) != n_runs:
                problems.add(
                    (name,),
                    f"has {number_of(len(array), 'row')} and {next(iter(found))} {n_runs}; give one for each run",
                )
        n_forces = len(_pushes(scene))
        if n_forces != 1 and any(name.startswith("force_") for name in found):
            problems.add(("force",), f"varies, but the scene has {n_forces}; it must be one")
        elif "force_at_object_m" in found and any(push.at_world_m is not None for push in _pushes(scene)):
            problems.add(("force_at_object_m",), "varies, but the force acts at a point of the world; leave it out")
        if "friction_coefficient" in found:
            _check_all(found["friction_coefficient"] >= 0.0, "friction_coefficient", "is below zero", problems)
        if "force_magnitude_n" in found:
            _check_all(found["force_magnitude_n"] > 0.0, "force_magnitude_n", "is not above zero", problems)
        if "force_direction_world" in found:
            is_vector = np.abs(found["force_direction_world"]).max(axis=1) > 0.0
            _check_all(is_vector, "force_direction_world", "is zero, so it has no direction", problems)
        problems.raise_if_any()
        return n_runs, found


def _pushes(scene: Scene) -> list[Force]:
    return [push for load in scene.loads for push in load.pushes]


def _check_all(holds: np.ndarray, name: str, message: str, problems: ProblemList) -> None:
    broken = np.flatnonzero(~holds)
    if len(broken):
        problems.add((name, int(broken[0])), f"{message} ({len(broken)} of {len(holds)} rows are); change or leave out")
