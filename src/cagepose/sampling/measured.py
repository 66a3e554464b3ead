"""What is measured between features at the end of each run of a study, as its columns: `MeasuredColumns`."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from cagepose.errors import Problem, SceneError
from cagepose.files.schema_study import WatchModel
from cagepose.files.units import LengthUnit, from_metres
from cagepose.files.watched import measures_of
from cagepose.model.cage import Cage
from cagepose.model.geometry import sizes_with_points
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.driven_cage import CageAt, cage_at_end, cage_at_start
from cagepose.runs.run import FAILURES, Run
from cagepose.runs.variation import Variation
from cagepose.sampling.outcome import Outcomes
from cagepose.studies.between_features import Instant, Measure


class MeasuredColumns:
    """What a study watches between features of the cage and of the object.

    Parameters
    ----------
    watched
        All that it watches, points as well.
    length_unit
        Of the scene's file.

    Attributes
    ----------
    names
        Of the columns, in the order of the file.
    """

    def __init__(self, watched: Mapping[str, WatchModel], length_unit: LengthUnit) -> None:
        self._watched, self._unit = watched, length_unit
        self.names = tuple(name for name, watch in watched.items() if watch.kind != "point")

    def __len__(self) -> int:
        return len(self.names)

    def takes(self, scene: Scene) -> bool:
        """Whether rows of the batch kernel can be measured: none of the cage's bodies moves."""
        return not (len(self) and scene.cage.bodies)

    def write_run(self, outcomes: Outcomes, row: int, run: Run) -> None:
        """Measure the end of a run, which is in a row of outcomes; one that failed has none."""
        if outcomes.measured is not None and not run.failed:
            self._write(outcomes, row, self._measures(run.scene), cage_at_end(run), run.scene.touch_m)

    def write_rows(self, outcomes: Outcomes, rows: list[int], scene: Scene, variation: Variation) -> None:
        """Measure the ends of rows of a variation of a scene that it `takes`."""
        if outcomes.measured is None:
            return
        measures, failed = self._measures(scene), np.isin(outcomes.verdict, sorted(FAILURES))
        cages = _Cages(scene, variation)
        for row in rows:
            if not failed[row]:
                self._write(outcomes, row, measures, cage_at_start(cages.of(row)), cages.touch_m(row))

    def _measures(self, scene: Scene) -> list[Measure]:
        problems = list[Problem]()
        found = measures_of(scene, self._watched, self._unit, problems)
        if problems:
            raise SceneError(problems)
        return [found[name] for name in self.names]

    def _write(self, outcomes: Outcomes, row: int, measures: list[Measure], cage: CageAt, touch_m: float) -> None:
        assert outcomes.measured is not None
        pose = Pose.from_unit(outcomes.position_m[row].copy(), outcomes.quaternion_wxyz[row].copy())
        for place, (name, measure) in enumerate(zip(self.names, measures, strict=True)):
            found = measure.at(Instant(pose, cage, touch_m))
            is_angle = self._watched[name].kind == "angle"
            outcomes.measured[row, place] = np.degrees(found) if is_angle else from_metres(found, self._unit)


class _Cages:
    """The cages of the rows of a variation, as their scenes have them to the last digit."""

    def __init__(self, scene: Scene, variation: Variation) -> None:
        self._scene, (_, columns) = scene, variation.columns(scene)
        self._positions, self._angles = columns.get("cage_position_m"), columns.get("cage_euler_zyx")
        self._points, self._sizes_m = columns.get("points_cage_m"), None
        if self._points is not None:
            self._sizes_m = sizes_with_points(scene.object, scene.cage, self._points)

    def touch_m(self, row: int) -> float:
        """Return within which distance parts touch, metres."""
        if self._sizes_m is None:
            return self._scene.touch_m
        return self._scene.tolerances.touch * float(self._sizes_m[row])

    def of(self, row: int) -> Cage:
        cage = self._scene.cage if self._points is None else self._scene.cage.with_points(self._points[row])
        start = cage.pose_world_cage
        position = start.position_m if self._positions is None else self._positions[row]
        if self._angles is None:
            return cage.placed_at(Pose(position, start.quaternion_wxyz))
        return cage.placed_at(Pose(position, euler_zyx=self._angles[row]))
