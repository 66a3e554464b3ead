"""Where the bodies of a cage are at any place of a run: `CageAt`. All that draws a cage asks here."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cagepose.model.cage import Cage
from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.runs.drives import displaced_bodies, way_in
from cagepose.runs.run import Run


@dataclass(frozen=True, eq=False)
class CageAt:
    """A cage with its bodies where they are at one moment.

    Attributes
    ----------
    cage
        The cage as it starts.
    displaced
        How what stands still, which is not at all, and then each body is displaced from its start, in the world.
    """

    cage: Cage
    displaced: tuple[Pose, ...]

    def of_element(self, element: int) -> Pose:
        """Return how one of `Cage.element_names` is displaced from its start, in the world."""
        return self.displaced[self.cage.element_bodies[element]]

    def pose_of_shape(self, which: int) -> Pose:
        """Return where one of the shapes, or of the holes behind them, is in the world."""
        shape = (*self.cage.shapes, *self.cage.holes)[which]
        return self.of_element(len(self.cage.names) + which) @ self.cage.pose_world_cage @ shape.pose_body_shape

    def pose_of_cage(self, which: int) -> Pose:
        """Return where the frame of the cage is that has gone along with one of the shapes, or of the holes."""
        return self.of_element(len(self.cage.names) + which) @ self.cage.pose_world_cage

    @cached_property
    def points_world(self) -> FloatArray:
        """The points in the world, (n, 3), metres."""
        points = self.cage.points_world()
        bodies = np.array(self.cage.element_bodies[: len(points)], dtype=np.int64)
        for body in np.unique(bodies[bodies > 0]).tolist():
            points[bodies == body] = self.displaced[body].transform(points[bodies == body])
        return points


def cage_at_start(cage: Cage) -> CageAt:
    """Return a cage with all its bodies where they start."""
    return CageAt(cage, (Pose(),) * (1 + len(cage.bodies)))


def cage_at(run: Run, phase_index: int, share: float) -> CageAt:
    """Return the cage in a phase of a run in which so much of its drive is done, see `Frame`."""
    scene = run.scene
    ways = [way_in(phase) for phase in run.phases[:phase_index]]
    if share:  # else it is where the phase before ended
        ways.append(way_in(run.phases[phase_index], share))
    in_cage = displaced_bodies(scene, ways)
    to_world = scene.cage.pose_world_cage
    to_cage = to_world.inverse()
    of_bodies = (to_world @ in_cage[body.name] @ to_cage for body in scene.cage.bodies)
    return CageAt(scene.cage, (Pose(), *of_bodies))


def cage_at_end(run: Run, phase_index: int = -1) -> CageAt:
    """Return the cage at the end of a phase; left out: of the run."""
    index = phase_index % len(run.phases)
    phase = run.phases[index]
    if phase.drive is not None:
        return cage_at(run, index, phase.drive.share)
    return cage_at(run, index, 0.0 if phase.press is None else 1.0)
