"""Many runs at once: `run_many`, its columns, and the threads that fill them."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cagepose.errors import Problem, SceneError
from cagepose.kernels.algebra.pose import write_euler_zyx
from cagepose.kernels.outcome.endings import INVALID, NOT_RUN
from cagepose.kernels.outcome.trace import RESTS, VERDICT_NAMES
from cagepose.kernels.stability.proof import OTHER_ONSET, TOO_MANY_CHOICES, UNIQUENESS_NOT_SHOWN
from cagepose.model.checks import FloatArray, ProblemList, check_kind, check_kinds, expect_count, finite_array
from cagepose.model.methods import DEFAULT_METHOD
from cagepose.model.pose import placed
from cagepose.model.scene import Scene
from cagepose.runs.batch import Batch
from cagepose.runs.frames import ANGLES, POSITION, data_frame
from cagepose.runs.methods import chosen_method
from cagepose.runs.scene_rows import SceneRows
from cagepose.runs.variation import Variation

LONGEST_PIECE = 256
"""Runs of one call of a kernel: some 10 ms of work, so that progress is seen."""
PIECES_FOR_A_THREAD = 8
"""At least, if there are so many runs: so that all threads end at about the same time."""


@dataclass(frozen=True, eq=False)
class Runs:
    """The results of `run_many`: columns with one row for each run.

    Attributes
    ----------
    methods
        "stepwise" or "quasistatic", (n,).
    phase_verdicts
        Of each phase, (n, n_phases): as `PhaseRun.verdict`; "invalid" where no run could begin (a cage point inside the
        object at the start, two points that are one, or a start too far from the cage); "" where it was not reached.
    n_steps
        Of each phase, (n, n_phases). A step of the stepwise method is an event; the quasistatic method joins steps of
        one kind to one.
    position_m, quaternion_wxyz
        The object's pose in the world after each phase, (n, n_phases, 3) and (n, n_phases, 4); NaN where not reached.
    touching
        Which cage points and shapes touch after each phase, (n, n_phases, n_elements).
    drive_shares
        How much of each phase's drive was done, (n, n_phases), 0 to 1; NaN where it drives nothing or was not reached.
    greatest_along
        As `DriveRun.greatest_along`, (n, n_phases); NaN where the drive did not begin, too.
    jam_possible
        Whether it could jam at one of the places that were asked along each drive, (n, n_phases).
    solve_s
        How long all runs took together, seconds.
    phases, elements
        Names of the phases, and of the cage's points and shapes; of scenes that differ in them, numbers from 1.
    """

    methods: NDArray[np.str_]
    phase_verdicts: NDArray[np.str_]
    n_steps: NDArray[np.int64]
    position_m: FloatArray
    quaternion_wxyz: FloatArray
    touching: NDArray[np.bool_]
    drive_shares: FloatArray
    greatest_along: FloatArray
    jam_possible: NDArray[np.bool_]
    solve_s: float
    phases: tuple[str, ...]
    elements: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.phase_verdicts)

    def __repr__(self) -> str:
        ended = ", ".join(
            f"{n} {verdict}" for verdict, n in zip(*np.unique(self.verdict, return_counts=True), strict=True)
        )
        return f"<{len(self)} Runs: {ended}>"

    @property
    def verdict(self) -> NDArray[np.str_]:
        """Verdict of the last phase that was reached, (n,): as `Run.verdict`."""
        last = np.maximum((self.phase_verdicts != "").sum(axis=1) - 1, 0)
        found: NDArray[np.str_] = self.phase_verdicts[np.arange(len(self)), last]
        return found

    @property
    def euler_zyx(self) -> FloatArray:
        """Yaw, pitch and roll after each phase, (n, n_phases, 3), radians."""
        angles = np.empty(self.position_m.shape)
        write_euler_zyx(self.quaternion_wxyz.reshape(-1, 4), angles.reshape(-1, 3))
        return angles

    def points_world(self, points_object_m: ArrayLike) -> FloatArray:
        """Return where points of the object are after each phase, (n, n_phases, n_points, 3), metres; NaN where it was
        not reached. ``points_object_m``: in the object's frame, (n_points, 3).

        Raises
        ------
        SceneError
            Points of another shape, NaN or infinite.
        """
        points = finite_array(points_object_m, (-1, 3), "points")
        return placed(points, self.position_m[:, :, None], self.quaternion_wxyz[:, :, None])

    def to_frame(self) -> Any:
        """Return a ``pandas.DataFrame`` with a row for each phase of each run that was reached: the run's row, the
        phase's name, verdict, steps, pose in metres and radians, where runs drive bodies the share, greatest force and
        whether it could jam, and whether each point and shape of the cage touches.

        Raises
        ------
        MissingExtraError
            There is no pandas.
        """
        rows, phases = np.nonzero(self.phase_verdicts != "")
        columns: dict[str, object] = {
            "run": rows,
            "phase": np.array(self.phases)[phases],
            "method": self.methods[rows],
            "verdict": self.phase_verdicts[rows, phases],
            "n_steps": self.n_steps[rows, phases],
            **dict(zip(POSITION, self.position_m[rows, phases].T, strict=True)),
            **dict(zip(ANGLES, self.euler_zyx[rows, phases].T, strict=True)),
        }
        if not np.isnan(self.drive_shares).all():
            columns |= {
                "share": self.drive_shares[rows, phases],
                "greatest_along": self.greatest_along[rows, phases],
                "jam_possible": self.jam_possible[rows, phases],
            }
        columns |= {f"touches {name}": self.touching[rows, phases, place] for place, name in enumerate(self.elements)}
        return data_frame(columns)


def run_many(
    scenes: Scene | Sequence[Scene],
    variation: Variation | None = None,
    *,
    method: str | None = None,
    threads: int | None = None,
    progress: bool | Callable[[float], None] = False,
) -> Runs:
    """Run one scene many times with values that vary, or many scenes, on several threads without Python between runs.

    Poses and verdicts are those of `cagepose.run`, to the last bit. Left out are events, contact forces, warnings, and
    what a proof says beyond the verdict: run the few rows that matter one by one.

    Parameters
    ----------
    scenes
        One scene, or several.
    variation
        What differs, if it is one scene: that is built and checked only once.
    method
        As for `cagepose.run`.
    threads
        How many; None: one for each core.
    progress
        True: on standard error, a bar on a terminal and four lines elsewhere. A function: called with the share of the
        runs that are done.

    Raises
    ------
    SceneError
        An unknown method, no scene, a variation of several scenes, or one that no scene could have.
    KeyboardInterrupt
        Ctrl-C was pressed; no thread goes on.
    """
    problems = ProblemList()
    all_scenes = [scenes] if isinstance(scenes, Scene) else check_kinds(scenes, Scene, "scenes", problems)
    if variation is not None:
        check_kind(variation, Variation, ("variation",), problems)
    problems.raise_if_any()
    if not all_scenes:
        raise SceneError([Problem(("scenes",), "is empty; give at least one scene")])
    if variation is not None and not isinstance(scenes, Scene):
        raise SceneError([Problem(("variation",), f"is of one scene, and {len(all_scenes)} are given; give one scene")])
    if threads is not None:
        expect_count(threads, "threads")
    methods = [chosen_method(scene, method) for scene in all_scenes]
    batches = [
        Batch(scene, chosen, variation or Variation()) for scene, chosen in zip(all_scenes, methods, strict=True)
    ]
    began = time.perf_counter()
    _run_all(batches, threads or os.cpu_count() or 1, _Progress() if progress is True else progress or None)
    solve_s = time.perf_counter() - began
    return _columns(all_scenes, [chosen.name for chosen in methods], batches, solve_s)


def runs_of_rows(scene: Scene, rows: SceneRows) -> Runs:
    """Return the results of runs of scenes that differ from one in numbers, which are done."""
    return _columns([scene], [scene.method or DEFAULT_METHOD], [rows], float(rows.solve_s.sum()))


def _run_all(batches: Sequence[Batch], n_threads: int, progress: Callable[[float], None] | None) -> None:
    n_runs, n_done = sum(batch.n_runs for batch in batches), 0
    length = max(1, min(LONGEST_PIECE, n_runs // (PIECES_FOR_A_THREAD * n_threads)))
    executor = ThreadPoolExecutor(n_threads)
    try:
        pieces = [
            executor.submit(batch.run_piece, first, min(first + length, batch.n_runs))
            for batch in batches
            for first in range(0, batch.n_runs, length)
        ]
        for piece in as_completed(pieces):
            n_done += piece.result()
            if progress is not None:
                progress(n_done / n_runs)
    except BaseException:  # Ctrl-C is heard here, not in the threads
        for batch in batches:
            batch.stop()
        raise
    finally:
        executor.shutdown(cancel_futures=True)


def _columns(scenes: Sequence[Scene], methods: list[str], batches: Sequence[Batch | SceneRows], solve_s: float) -> Runs:
    names = np.full(max(INVALID, len(VERDICT_NAMES)) + 2, "", dtype="<U10")
    names[: len(VERDICT_NAMES)] = VERDICT_NAMES
    names[INVALID], names[NOT_RUN] = "invalid", ""
    endings = [batch.endings for batch in batches]
    codes = _stacked([found.verdicts for found in endings], NOT_RUN)
    proofs = _stacked([found.proofs for found in endings], NOT_RUN)
    verdicts = names[codes]
    drives = [batch.drives() for batch in batches]
    verdicts[(codes == RESTS) & np.isin(proofs, (OTHER_ONSET, UNIQUENESS_NOT_SHOWN, TOO_MANY_CHOICES))] = "may rest"
    return Runs(
        np.repeat(methods, [batch.n_runs for batch in batches]),
        verdicts,
        _stacked([found.n_steps for found in endings], 0),
        _stacked([found.positions for found in endings], np.nan),
        _stacked([found.quaternions for found in endings], np.nan),
        _stacked([found.touching for found in endings], False),
        _stacked([found.shares for found in drives], np.nan),
        _stacked([found.greatest for found in drives], np.nan),
        _stacked([found.jam_possible for found in drives], False),
        solve_s,
        _common([tuple(load.name for load in scene.loads) for scene in scenes]),
        _common([scene.cage.element_names for scene in scenes]),
    )


def _common(names: list[tuple[str, ...]]) -> tuple[str, ...]:
    """Return names that are the same for all scenes, else numbers."""
    if len(set(names)) == 1:
        return names[0]
    return tuple(str(number) for number in range(1, max(map(len, names)) + 1))


def _stacked(arrays: list[NDArray[Any]], filling: Any) -> NDArray[Any]:
    """One below the other; where scenes differ in phases or points, the smaller ones are filled up."""
    if len(arrays) == 1:
        return arrays[0]
    shape = np.max([array.shape[1:] for array in arrays], axis=0)
    whole = np.full((sum(map(len, arrays)), *shape), filling, arrays[0].dtype)
    first = 0
    for array in arrays:
        whole[(slice(first, first + len(array)), *map(slice, array.shape[1:]))] = array
        first += len(array)
    return whole


class _Progress:
    """Shows the share of the runs that are done on standard error: a bar on a terminal, a line a quarter elsewhere."""

    def __init__(self) -> None:
        self.on_screen, self.shown = sys.stderr.isatty(), 0
        self.steps = 100 if self.on_screen else 4

    def __call__(self, share: float) -> None:
        done = int(self.steps * share)
        if done == self.shown:
            return
        self.shown = done
        bar = f"\rcagepose: {'#' * int(30 * share):30} {share:4.0%}" if self.on_screen else f"cagepose: {share:.0%}\n"
        sys.stderr.write(f"{bar}\n" if self.on_screen and share >= 1.0 else bar)
        sys.stderr.flush()
