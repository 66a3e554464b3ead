"""Where many runs ended, as arrays: `Outcomes`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cagepose.model.checks import FloatArray
from cagepose.model.pose import placed
from cagepose.model.scene import Scene
from cagepose.runs.cases import greatest_friction
from cagepose.runs.many import Runs
from cagepose.runs.methods import chosen_method
from cagepose.runs.run import AT_REST, STOPPED, Run

REFUSED = "refused"
"""Verdict of a row whose scene cannot be right."""


@dataclass(eq=False)
class Outcomes:
    """Rows are runs.

    Attributes
    ----------
    phase_verdicts
        (n, n_phases); "" where a phase was not reached; `REFUSED` in the first where the scene was.
    position_m, quaternion_wxyz, euler_zyx
        The object's pose at the end of the last phase that was reached, (n, 3), (n, 4) and (n, 3); NaN: none.
    touching
        Which points and shapes of the cage touch there, (n, n_elements).
    forces
        What each of them carries there, the sum of its normal forces, (n, n_elements); NaN where no forces balance the
        load. None: not asked for.
    answers
        What is asked of each run, (n, n_columns of `cagepose.sampling.asked.AskedColumns`); NaN: no answer. None:
        nothing is asked.
    measured
        What is measured between features there, (n, n_columns of `cagepose.sampling.measured.MeasuredColumns`); NaN: no
        such number. None: nothing is.
    drive_shares, greatest_along, jam_possible
        What came of the drive of each phase, (n, n_phases), as in `cagepose.runs.many.Runs`.
    errors
        Why a row was refused; None: it was not.
    solve_us
        Microseconds, (n,): of each run, or the mean of those that ran together.
    """

    phase_verdicts: NDArray[Any]
    position_m: FloatArray
    quaternion_wxyz: FloatArray
    euler_zyx: FloatArray
    touching: NDArray[np.bool_]
    forces: FloatArray | None
    answers: FloatArray | None
    measured: FloatArray | None
    drive_shares: FloatArray
    greatest_along: FloatArray
    jam_possible: NDArray[np.bool_]
    errors: NDArray[np.object_]
    solve_us: FloatArray

    def __len__(self) -> int:
        return len(self.phase_verdicts)

    @property
    def verdict(self) -> NDArray[Any]:
        """The verdict of the last phase that was reached, (n,)."""
        found: NDArray[Any] = self.phase_verdicts[np.arange(len(self)), _last_reached(self.phase_verdicts)]
        return found

    def points_world_m(self, point_object_m: FloatArray) -> FloatArray:
        """Return where a point of the object, (3,), is at the end, (n, 3)."""
        return placed(point_object_m, self.position_m, self.quaternion_wxyz)

    def clear(self, rows: NDArray[np.bool_]) -> None:
        """Make rows as if nothing was written to them."""
        self.phase_verdicts[rows], self.touching[rows], self.solve_us[rows] = "", False, 0.0
        self.jam_possible[rows] = False
        for numbers in (
            self.position_m,
            self.quaternion_wxyz,
            self.euler_zyx,
            self.drive_shares,
            self.greatest_along,
        ):
            numbers[rows] = np.nan

    def write_run(self, row: int, run: Run) -> None:
        """Write what `cagepose.run` says into a row."""
        verdicts, pose = [phase.verdict for phase in run.phases], run.pose
        self.phase_verdicts[row, : len(verdicts)] = verdicts
        self.position_m[row], self.quaternion_wxyz[row] = pose.position_m, pose.quaternion_wxyz
        self.euler_zyx[row], self.solve_us[row] = pose.euler_zyx, run.solve_s * 1e6
        places = {name: place for place, name in enumerate(run.scene.cage.element_names)}
        touched = [places[contact.point] for contact in run.contacts]
        self.touching[row, touched] = True
        self._write_drives(row, run)
        if self.forces is not None:
            known = [contact.force_normal_n for contact in run.contacts]
            if None not in known:
                self.forces[row] = 0.0
                np.add.at(self.forces[row], touched, np.array(known, dtype=np.float64))

    def _write_drives(self, row: int, run: Run) -> None:
        friction = greatest_friction(run.scene, chosen_method(run.scene, run.method).friction(run.scene))
        for place, (phase, load) in enumerate(zip(run.phases, run.scene.loads, strict=False)):
            if not load.drive:
                continue
            drive = phase.drive
            self.drive_shares[row, place] = 0.0 if drive is None else drive.share
            if drive is not None and (drive.share > 0.0 or phase.verdict in STOPPED):
                self.greatest_along[row, place] = drive.greatest_along
                least = drive.critical_jam_friction
                self.jam_possible[row, place] = least is not None and least <= friction

    def write_refusal(self, row: int, message: str) -> None:
        """Write that the scene of a row cannot be run."""
        self.phase_verdicts[row], self.phase_verdicts[row, 0] = "", REFUSED
        self.errors[row] = message


def at_rest(verdicts: NDArray[Any]) -> NDArray[np.bool_]:
    """Return which verdicts, (n,), are those of runs that came to rest: (n,)."""
    return np.isin(verdicts, sorted(AT_REST))


def empty_outcomes(scene: Scene, n_runs: int, *, with_forces: bool, n_answers: int, n_measured: int) -> Outcomes:
    """Return memory for runs of scenes that are like ``scene``, and for so many answers about each and measures."""
    n_phases, n_elements = len(scene.loads), len(scene.cage.element_names)
    return Outcomes(
        np.full((n_runs, n_phases), "", dtype="<U10"),
        np.full((n_runs, 3), np.nan),
        np.full((n_runs, 4), np.nan),
        np.full((n_runs, 3), np.nan),
        np.zeros((n_runs, n_elements), np.bool_),
        np.full((n_runs, n_elements), np.nan) if with_forces else None,
        np.full((n_runs, n_answers), np.nan) if n_answers else None,
        np.full((n_runs, n_measured), np.nan) if n_measured else None,
        np.full((n_runs, n_phases), np.nan),
        np.full((n_runs, n_phases), np.nan),
        np.zeros((n_runs, n_phases), np.bool_),
        np.full(n_runs, None, dtype=object),
        np.zeros(n_runs),
    )


def outcomes_of(runs: Runs, *, n_measured: int = 0) -> Outcomes:
    """Return what `run_many` found, with memory for measures; rows without a valid start have "invalid" as their first
    verdict.
    """
    n_runs = len(runs)
    rows, last = np.arange(n_runs), _last_reached(runs.phase_verdicts)
    return Outcomes(
        runs.phase_verdicts,
        runs.position_m[rows, last],
        runs.quaternion_wxyz[rows, last],
        runs.euler_zyx[rows, last],
        runs.touching[rows, last],
        None,
        None,
        np.full((n_runs, n_measured), np.nan) if n_measured else None,
        runs.drive_shares,
        runs.greatest_along,
        runs.jam_possible,
        np.full(n_runs, None, dtype=object),
        np.full(n_runs, runs.solve_s / max(n_runs, 1) * 1e6),
    )


def _last_reached(phase_verdicts: NDArray[Any]) -> NDArray[np.int64]:
    found: NDArray[np.int64] = np.maximum((phase_verdicts != "").sum(axis=1) - 1, 0)
    return found
