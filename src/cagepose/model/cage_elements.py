"""What a cage is made of: the points, shapes and holes of one that stands still, or of a body of one."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cagepose.errors import Key
from cagepose.model.box import Box
from cagepose.model.checks import FloatArray, ProblemList, check_kinds, duplicates, finite_array
from cagepose.model.facets import Facets
from cagepose.model.hole import Hole, check_holes
from cagepose.model.naming import check_names, names_of, place_of, placed
from cagepose.model.pose import Pose
from cagepose.model.shapes import AnyShape, Shape
from cagepose.model.wording import number_of


class Elements(NamedTuple):
    """Points, shapes and holes that move as one, each with a name.

    Attributes
    ----------
    points_m
        (n, 3), metres; n may be zero.
    names
        One for each point.
    shapes, holes
        Each with a name of its own.
    shape_paths, hole_paths
        For each of them where its numbers were given: ``("shapes", 2, "cylinder")``.
    """

    points_m: FloatArray
    names: tuple[str, ...]
    shapes: tuple[Box | AnyShape | Facets, ...]
    holes: tuple[Hole, ...]
    shape_paths: tuple[tuple[Key, ...], ...]
    hole_paths: tuple[tuple[Key, ...], ...]

    @property
    def is_empty(self) -> bool:
        return not (self.names or self.shapes or self.holes)

    def moved(self, pose: Pose) -> Elements:
        """Return the same elements seen from the frame that ``pose`` places theirs in."""
        points = pose.transform(self.points_m)
        points.setflags(write=False)
        return self._replace(
            points_m=points,
            shapes=tuple(shape.moved(pose @ shape.pose_body_shape) for shape in self.shapes),
            holes=tuple(hole.moved(pose @ hole.pose_body_shape) for hole in self.holes),
        )

    def under(self, *prefix: Key) -> Elements:
        """Return the same elements, seen from a noun that holds theirs at ``prefix``."""
        shape_paths, hole_paths = (
            tuple((*prefix, *path) for path in paths) for paths in (self.shape_paths, self.hole_paths)
        )
        return self._replace(shape_paths=shape_paths, hole_paths=hole_paths)


def elements_of(
    points: ArrayLike,
    names: Sequence[str] | None,
    shapes: Iterable[Shape],
    holes: Iterable[Hole],
    problems: ProblemList,
    prefix: str = "",
) -> Elements:
    """Return elements with names; those left out are "C1", "C2", ... and the kinds of shapes, behind ``prefix``.

    Raises
    ------
    SceneError
        What ``problems`` hold; points that are not n x 3 finite numbers, a name used twice, not one name for each
        point, or a hole that is not in its shapes.
    """
    has_points = not (isinstance(points, Sequence | np.ndarray) and len(points) == 0)
    array = finite_array(points, (-1, 3), "points") if has_points else finite_array(np.zeros((0, 3)), (0, 3), "points")
    default_names = tuple(f"{prefix}C{index + 1}" for index in range(len(array)))
    given = default_names if names is None else check_kinds(names, str, "names", problems)
    listed = {
        "shapes": check_kinds(shapes, Shape, "shapes", problems),
        "holes": check_kinds(holes, Hole, "holes", problems),
    }
    problems.raise_if_any()
    paths, everything = placed(listed, lambda shape: isinstance(shape, Hole), prefix)
    solids = tuple(shape for shape in everything if not isinstance(shape, Hole))
    cut = tuple(shape for shape in everything if isinstance(shape, Hole))
    if len(given) != len(array):
        problems.add(
            ("names",), f"holds {number_of(len(given), 'name')} for {number_of(len(array), 'point')}; give one for each"
        )
    for name, indices in duplicates(given).items():
        problems.add(("points", name), f"is the name of {len(indices)} points; rename all but one")
    unique = list(dict.fromkeys(given))
    places: list[tuple[Key, ...]] = [*(("points", name) for name in unique), *map(place_of, paths)]
    check_names([*unique, *names_of(everything)], places, problems)
    shape_paths, hole_paths = paths[: len(solids)], paths[len(solids) :]
    check_holes(cut, hole_paths, solids, problems)
    problems.raise_if_any()
    return Elements(array, given, solids, cut, shape_paths, hole_paths)
