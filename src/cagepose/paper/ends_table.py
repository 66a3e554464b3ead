"""How the paper's cases end by each method, as a table."""

from __future__ import annotations

import math
from collections.abc import Mapping

from cagepose.paper.blocks import Table
from cagepose.paper.paper_rows import CaseRuns
from cagepose.paper.rail import relative_tilt_rad
from cagepose.runs.run import Run


def ends_table(runs: Mapping[str, CaseRuns]) -> Table:
    """Return verdicts and final angles of every case, method beside method."""
    lines = []
    for case in ("sample", "pitch", "yaw", "roll"):
        for method, cases in runs.items():
            run: Run = getattr(cases, case)
            lines.append([run.scene.name, method, *_end(run), *(_swing(run) if len(run.phases) > 1 else "---")])
    return Table(
        "How the runs end; angles in deg",
        [
            "case", "method", "verdict", "by the mechanics", "yaw", "pitch", "roll",
            "relative pitch: weight", "push", "swing",
        ],
        lines,
    )  # fmt: skip


def _end(run: Run) -> list[str]:
    proof = run.phases[-1].proof
    judged = proof.verdict if proof.stability is None else f"{proof.verdict}, {proof.stability}"
    return [run.verdict, judged, *(f"{math.degrees(angle) + 0.0:.4f}" for angle in run.pose.euler_zyx)]


def _swing(run: Run) -> list[str]:
    """The rail's pitch relative to its rollers after the weight, after the push, and how far it swings between."""
    before, after = (math.degrees(relative_tilt_rad(run, phase)) for phase in range(2))
    return [f"{before:+.6f}", f"{after:+.6f}", f"{before - after:.6f}"]
