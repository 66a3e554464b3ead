"""What holds it: `Cage`."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from cagepose.errors import Key
from cagepose.model.box import Box
from cagepose.model.checks import FloatArray, ProblemList, check_kind, check_kinds, duplicates, finite_array
from cagepose.model.facets import Facets
from cagepose.model.hole import Hole, check_holes
from cagepose.model.naming import check_names, names_of, placed
from cagepose.model.pose import Pose
from cagepose.model.shapes import AnyShape, Shape
from cagepose.model.wording import counted


@dataclass(frozen=True, init=False, eq=False)
class Cage:
    """Fixed points and shapes in the world.

    Attributes
    ----------
    points_cage
        The points in the cage's own frame, (n, 3), metres; n may be zero.
    names
        One name for each point; left out: "C1", "C2", ...
    shapes
        Boxes and other shapes in the cage's own frame, every one with a name.
    holes
        What is cut out of them, and what stands alone; every one with a name.
    pose_world_cage
        Moves all points and shapes at once: the misaligned mechanism.
    shape_paths
        For each of the shapes, then of the holes, where its numbers were given: ``("shapes", 2, "cylinder")``.
    """

    points_cage: Annotated[FloatArray, (-1, 3)]
    names: tuple[str, ...]
    pose_world_cage: Pose
    shapes: tuple[Box | AnyShape | Facets, ...]
    holes: tuple[Hole, ...]
    shape_paths: tuple[tuple[Key, ...], ...]

    def __init__(
        self,
        points: ArrayLike = (),
        names: Sequence[str] | None = None,
        pose: Pose | None = None,
        shapes: Iterable[Shape] = (),
        holes: Iterable[Hole] = (),
    ) -> None:
        """
        Raises
        ------
        SceneError
            Neither points nor shapes, points that are not n x 3 finite numbers, a name used twice, not one name for
            each point, or a hole that is not in its shapes.
        """
        has_points = not (isinstance(points, Sequence | np.ndarray) and len(points) == 0)
        array = (
            finite_array(points, (-1, 3), "points") if has_points else finite_array(np.zeros((0, 3)), (0, 3), "points")
        )
        default_names = tuple(f"C{index + 1}" for index in range(len(array)))
        problems = ProblemList()
        given = default_names if names is None else check_kinds(names, str, "names", problems)
        pose = Pose() if pose is None else pose
        check_kind(pose, Pose, ("pose",), problems)
        listed = {
            "shapes": check_kinds(shapes, Shape, "shapes", problems),
            "holes": check_kinds(holes, Hole, "holes", problems),
        }
        problems.raise_if_any()
        paths, everything = placed(listed, lambda shape: isinstance(shape, Hole))
        solids = tuple(shape for shape in everything if not isinstance(shape, Hole))
        holes = tuple(shape for shape in everything if isinstance(shape, Hole))
        if not has_points and not everything:
            problems.add((), "has neither points nor shapes; give at least one of them")
        if len(given) != len(array):
            problems.add(("names",), f"holds {len(given)} names for {len(array)} points; give one for each")
        for name, indices in duplicates(given).items():
            problems.add(("points", name), f"is the name of {len(indices)} points; rename all but one")
        places: list[tuple[Key, ...]] = [("points", name) for name in dict.fromkeys(given)]
        places += [path[:2] for path in paths]
        check_names([*dict.fromkeys(given), *names_of(everything)], places, problems)
        check_holes(holes, paths[len(solids) :], solids, problems)
        problems.raise_if_any()
        object.__setattr__(self, "points_cage", array)
        object.__setattr__(self, "names", given)
        object.__setattr__(self, "pose_world_cage", pose)
        object.__setattr__(self, "shapes", solids)
        object.__setattr__(self, "holes", holes)
        object.__setattr__(self, "shape_paths", paths)

    def __repr__(self) -> str:
        return f"<Cage: {self._contents}>"

    @property
    def _contents(self) -> str:
        points, shapes = (len(self.names), "point", "points"), (len(self.shapes), "shape", "shapes")
        return counted(points, shapes, (len(self.holes), "hole", "holes"))

    @cached_property
    def element_names(self) -> tuple[str, ...]:
        """The names of all points, then of all shapes, then of all holes."""
        return (*self.names, *names_of(self.shapes), *names_of(self.holes))

    def points_world(self) -> FloatArray:
        """The points in the world, (n, 3), metres."""
        return self.pose_world_cage.transform(self.points_cage)

    def nodes_cage(self) -> FloatArray:
        """The points and those that tell where the shapes lie, in the cage's own frame, (n, 3), metres."""
        return np.concatenate([self.points_cage, *(shape.nodes_body() for shape in (*self.shapes, *self.holes))])
