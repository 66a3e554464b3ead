"""What holds it: `Cage`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

from numpy.typing import ArrayLike

from cagepose.model.checks import FloatArray, ProblemList, duplicates, finite_array
from cagepose.model.pose import Pose


@dataclass(frozen=True, init=False, eq=False)
class Cage:
    """Fixed points in the world.

    Attributes
    ----------
    points_cage
        The points in the cage's own frame, (n, 3), metres.
    names
        One name for each; left out: "C1", "C2", ...
    pose_world_cage
        Moves all points at once: the misaligned mechanism.
    """

    points_cage: Annotated[FloatArray, (-1, 3)]
    names: tuple[str, ...]
    pose_world_cage: Pose

    def __init__(self, points: ArrayLike, names: Sequence[str] | None = None, pose: Pose | None = None) -> None:
        """
        Raises
        ------
        SceneError
            No points, not n x 3 finite numbers, a name used twice, or not one name for each point.
        """
        array = finite_array(points, (-1, 3), "points")
        default_names = tuple(f"C{index + 1}" for index in range(len(array)))
        given = default_names if names is None else tuple(str(name) for name in names)
        problems = ProblemList()
        if len(given) != len(array):
            problems.add(("names",), f"holds {len(given)} names for {len(array)} points; give one for each")
        for name, indices in duplicates(given).items():
            problems.add(("points", name), f"is the name of {len(indices)} points; rename all but one")
        problems.raise_if_any()
        object.__setattr__(self, "points_cage", array)
        object.__setattr__(self, "names", given)
        object.__setattr__(self, "pose_world_cage", pose or Pose())

    def points_world(self) -> FloatArray:
        """The points in the world, (n, 3), metres."""
        return self.pose_world_cage.transform(self.points_cage)
