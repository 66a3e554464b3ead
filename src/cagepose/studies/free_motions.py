"""A tree of motions that are free of contact, grown at random until one leads out of the cage: `FreeMotions`."""

from __future__ import annotations

import numpy as np

from cagepose.kernels.algebra.record import Rows, empty_rows
from cagepose.kernels.algebra.tolerances import kernel_tolerances
from cagepose.kernels.collision.boxes import empty_placed_boxes
from cagepose.kernels.play.escape import N_RANDOM, Station, grow_tree
from cagepose.model.scene import Scene
from cagepose.studies.play_frame import PlayFrame

MOTIONS_OF_BATCH = 500
"""Motions that are tried at a time: some milliseconds."""
RANDOM_SEED = 20250101


class FreeMotions:
    """The tree, whose root is where the object starts. The same motions are tried each time.

    Attributes
    ----------
    stations, n_stations
        Where motions led, in the lengths of the frame, and how many of the rows are used.
    is_out
        Whether the last of them is out of the cage.
    n_tried
        Motions that were tried.
    """

    def __init__(
        self, scene: Scene, frame: PlayFrame, most_stations: int, motions_of_batch: int = MOTIONS_OF_BATCH
    ) -> None:
        self._frame, self._of_batch = frame, motions_of_batch
        self._tolerances = kernel_tolerances(scene.size_m / frame.length_m, scene.tolerances.touch)
        self._placement, self._random = empty_placed_boxes(frame.geometry), np.random.default_rng(RANDOM_SEED)
        self.stations: Rows[Station] = empty_rows(Station, most_stations)
        self.stations[0].parent = -1
        self.stations[0].quaternion[0] = 1.0
        self.n_stations, self.is_out, self.n_tried = 1, False, 0

    @property
    def has_room(self) -> bool:
        """Whether there is room for what another batch may add."""
        return self.n_stations + self._of_batch <= len(self.stations)

    def grow(self) -> None:
        """Try a batch of motions from stations that are there; the one that leads out, if one does, is the last."""
        samples = self._random.random((self._of_batch, N_RANDOM))
        self.n_stations, self.is_out = grow_tree(
            self._frame.geometry, samples, self.stations, self.n_stations, self._placement, self._tolerances
        )
        self.n_tried += self._of_batch

    def share(self) -> float:
        """Return another random number, from 0 to below 1."""
        return float(self._random.random())
