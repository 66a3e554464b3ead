"""The paper, run anew: its cases by one method after the other, its numbers beside ours, and its range of angles."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from cagepose.model.scene import Scene
from cagepose.paper.paper_rows import MISALIGNMENT_RAD, CaseRuns, Question, questions
from cagepose.paper.printed import PAPER_METHOD, Row, compared
from cagepose.paper.rail import PAPER_RAIL, rail_scene
from cagepose.paper.range_study import ANGLES, RangeStudy, range_study
from cagepose.paper.sample import sample_scene
from cagepose.runs.run import Run
from cagepose.runs.solve import run

METHODS = (PAPER_METHOD, "quasistatic")
"""Those that the report compares: each gets its column in the table and its pictures."""
TIMED_RUNS = 9
"""Runs of each case whose median is the measured time."""
RANGE_RAD = np.radians(np.linspace(-0.5, 0.5, 21))
"""Misalignments of the range study."""

Progress = Callable[[str], None]
"""Is told what begins."""


@dataclass(frozen=True, eq=False)
class Reproduction:
    """All of it.

    Attributes
    ----------
    runs
        The paper's cases, by method.
    rows
        Every number that the paper prints.
    ranges
        By method: for each angle, both pins.
    """

    runs: dict[str, CaseRuns]
    rows: tuple[Row, ...]
    ranges: dict[str, tuple[RangeStudy, ...]]

    @property
    def methods(self) -> tuple[str, ...]:
        return tuple(self.runs)


def reproduce(methods: Sequence[str], progress: Progress) -> Reproduction:
    """Run the paper's cases and its range of misalignments by each of ``methods``."""
    runs, ranges = {}, {}
    for method in methods:
        runs[method] = run_cases(method, progress)
        progress(f"{method}: the rail at {len(RANGE_RAD)} misalignments in each of 3 angles, both pins")
        half = PAPER_RAIL.pin_spacing_m / 2.0
        ranges[method] = tuple(
            range_study(angle, RANGE_RAD, pin_y_m, method) for angle in ANGLES for pin_y_m in (half, -half)
        )
    return Reproduction(runs, tuple(_row(question, runs) for question in questions()), ranges)


def run_cases(method: str, progress: Progress) -> CaseRuns:
    """Run the sample and the rail with its rollers out of line in each of three angles."""
    cases = {}
    for scene in case_scenes():
        progress(f"{method}: {scene.name}")
        cases[scene.name] = [run(scene, method) for _ in range(TIMED_RUNS)]
    sample, yaw, pitch, roll = cases.values()
    return CaseRuns(
        sample=sample[0],
        pitch=pitch[0],
        yaw=yaw[0],
        roll=roll[0],
        pitch_s=_median_s(pitch),
        slowest_s=max(_median_s(results) for results in cases.values()),
    )


def case_scenes() -> list[Scene]:
    """Return the sample, then the rail out of line in yaw, pitch and roll."""
    rails = [
        rail_scene(
            misalignment_zyx=(
                MISALIGNMENT_RAD * (angle == "yaw"),
                MISALIGNMENT_RAD * (angle == "pitch"),
                MISALIGNMENT_RAD * (angle == "roll"),
            ),
            name=f"rail, {angle} 0.1 deg",
        )
        for angle in ANGLES
    ]
    return [sample_scene(), *rails]


def _median_s(results: Sequence[Run]) -> float:
    return statistics.median(result.solve_s for result in results)


def _row(question: Question, runs: dict[str, CaseRuns]) -> Row:
    found = {method: question.measure(cases) for method, cases in runs.items()}
    status = question.status or compared(found, question.closed_form, question.printed)
    return Row(
        question.section,
        question.quantity,
        question.printed,
        found,
        question.closed_form,
        status,
        question.explanation,
    )
