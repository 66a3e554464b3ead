"""What a study watches: its points, and what is measured between features of the cage and of the object."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TypeVar

from cagepose.errors import Key, Problem
from cagepose.files.schema_study import WatchModel
from cagepose.files.units import LengthUnit, to_metres
from cagepose.model.checks import FloatArray
from cagepose.model.scene import Scene
from cagepose.studies.between_features import AxesAngle, Measure, PlacesDistance
from cagepose.studies.named_features import (
    ObjectFeature,
    cage_axis,
    cage_elements,
    cage_place,
    object_axis,
    object_parts,
    object_place,
)
from cagepose.studies.part_gap import PartGap

One = TypeVar("One")
Other = TypeVar("Other")

Watched = Mapping[str, WatchModel]
"""By the names of columns, as a study gives them."""


def watched_points(watched: Watched, unit: LengthUnit) -> dict[str, FloatArray]:
    """Return the points of the object that are watched, by their names, (3,) each, metres."""
    return {name: to_metres(watch.point, unit) for name, watch in watched.items() if watch.point is not None}


def measures_of(scene: Scene, watched: Watched, unit: LengthUnit, problems: list[Problem]) -> dict[str, Measure]:
    """Return what is measured in a scene, by the names of its columns; note names that stand for nothing there."""
    points = watched_points(watched, unit)

    def place(scene: Scene, name: str) -> ObjectFeature:
        return object_place(scene, name, points)

    found = dict[str, Measure]()
    for name, watch in watched.items():
        reader = _Names(scene, watch.pair, ("watch", name, watch.kind), problems)
        measure: Measure | None = None
        if watch.gap is not None and (sides := reader.read(cage_elements, object_parts)) is not None:
            measure = PartGap(scene, sides[1], sides[0])
        elif watch.angle is not None and (axes := reader.read(cage_axis, object_axis)) is not None:
            measure = AxesAngle(*axes)
        elif watch.distance is not None and (places := reader.read(cage_place, place)) is not None:
            measure = PlacesDistance(*places)
            if None not in (measure.of_cage.axis, measure.of_object.axis):
                reader.note("names two axes, whose distance is another one at every place; name a place on one side")
        if measure is not None:
            found[name] = measure
    return found


class _Names:
    """Reads the two names of one measure, and notes what is wrong with them at their places in the file."""

    def __init__(self, scene: Scene, pair: list[str], path: tuple[Key, ...], problems: list[Problem]) -> None:
        self._scene, self._pair, self._path, self._problems = scene, pair, path, problems

    def note(self, message: str) -> None:
        self._problems.append(Problem(self._path, message))

    def read(
        self, of_cage: Callable[[Scene, str], One], of_object: Callable[[Scene, str], Other]
    ) -> tuple[One, Other] | None:
        """Return what they stand for; None: one of them for nothing."""
        one, other = self._read(0, of_cage), self._read(1, of_object)
        return None if one is None or other is None else (one, other)

    def _read(self, side: int, reader: Callable[[Scene, str], One]) -> One | None:
        try:
            return reader(self._scene, self._pair[side])
        except ValueError as error:
            self._problems.append(Problem((*self._path, side), str(error)))
            return None
