"""Where each of many runs ended: `Endings`."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.pose import Quaternion, write_upright
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.vector import Vector
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.outcome.cases import Part, Start, object_position

NOT_RUN = -1
"""Verdict code of a phase that was not reached."""
INVALID = 100
"""Verdict code of a first phase that has no valid start; the others are those of `cagepose.kernels.outcome.trace`."""


class Endings(NamedTuple):
    """Where each phase of each run ended.

    Attributes
    ----------
    verdicts, n_steps
        Codes, and how many events (stepwise) or steps (quasistatic) it took, (n, n_phases).
    proofs
        Code where a quasistatic phase comes to rest, (n, n_phases).
    positions, quaternions
        The object's pose in the world, (n, n_phases, 3) metres and (n, n_phases, 4).
    shares, greatest, least_jams
        How much of a drive is done, (n, n_phases); the greatest sum of the drivers' forces along their ways, and the
        least friction with which the object could jam: NaN without a drive.
    touching
        Which of the cage's points and shapes touch, (n, n_phases, n_elements).
    """

    verdicts: NDArray[np.int64]
    proofs: NDArray[np.int64]
    n_steps: NDArray[np.int64]
    positions: FloatArray
    quaternions: FloatArray
    shares: FloatArray
    greatest: FloatArray
    least_jams: FloatArray
    touching: NDArray[np.bool_]


def empty_endings(n_runs: int, n_phases: int, n_elements: int) -> Endings:
    """Return memory for the ends of many runs (plain Python)."""
    return Endings(
        np.full((n_runs, n_phases), NOT_RUN),
        np.full((n_runs, n_phases), NOT_RUN),
        np.zeros((n_runs, n_phases), np.int64),
        np.full((n_runs, n_phases, 3), np.nan),
        np.full((n_runs, n_phases, 4), np.nan),
        np.zeros((n_runs, n_phases)),
        np.full((n_runs, n_phases), np.nan),
        np.full((n_runs, n_phases), np.nan),
        np.zeros((n_runs, n_phases, n_elements), np.bool_),
    )


@kernel
def write_ending(
    endings: Endings,
    case: int,
    phase: int,
    verdict: int,
    n_steps: int,
    position: Vector,
    quaternion: Quaternion,
    start: Start,
    part: Part,
) -> None:
    """Write how a phase ended, the pose in the world; `Endings.touching` is left to the method."""
    placed = object_position(start, part, position, quaternion)
    endings.verdicts[case, phase] = verdict
    endings.n_steps[case, phase] = n_steps
    for k in range(3):
        endings.positions[case, phase, k] = placed[k]
    write_upright(quaternion, endings.quaternions[case, phase])
