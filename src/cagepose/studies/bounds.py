"""What no motion inside the cage can pass, of boxes among points: `Bounds`."""

from __future__ import annotations

from time import perf_counter

import numpy as np

from cagepose.kernels.algebra.record import Rows
from cagepose.kernels.native.slots import Slots
from cagepose.kernels.play.certificate import CAGED, certify, empty_certificate_workspace
from cagepose.kernels.play.goal import SHIFT, Goal
from cagepose.kernels.play.polytope import empty_play_workspace
from cagepose.studies.play_frame import PlayFrame


class Bounds:
    """The certificate of a frame's boxes among its points, with a bound for each goal: (7.7) to (7.10).

    Attributes
    ----------
    proof
        As the kernel leaves it.
    is_caged
        Whether it proves that the object is caged.
    ends
        That no motion passes, one for each goal, metres or radians; None: not proven.
    certificate_s
        How long it took, seconds.
    """

    def __init__(self, frame: PlayFrame, goals: Rows[Goal], touch_m: float) -> None:
        work = empty_play_workspace(frame.geometry, frame.held)
        self.proof = empty_certificate_workspace(len(work.faces))
        greatest = np.full(len(goals), np.inf)
        started = perf_counter()
        certify(Slots(frame.geometry), touch_m / frame.length_m, goals, greatest, Slots(work), self.proof)
        self.certificate_s = perf_counter() - started
        self.is_caged = bool(self.proof.certificate.outcome == CAGED)
        columns = np.asarray(goals)
        values = np.where(columns["kind"] == SHIFT, frame.length_m, 1.0) * columns["sign"] * greatest
        self.ends = [value if self.is_caged and np.isfinite(value) else None for value in values.tolist()]
