"""What tests of studies share: the rail, and how a study of it is run."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cagepose import StudyResults
from our_scenes import SCENES

(RAIL,) = (path for path in SCENES if path.name == "rail-pitch.yaml")
"""A rail between rollers, out of line by 0.1 deg in pitch."""


def rows_of(results: StudyResults) -> list[dict[str, Any]]:
    """All that must not depend on who ran it: everything but the time."""
    names = [name for name in results.table().column_names if name != "solve_us"]
    return results.table(names).to_pylist()


RunStudy = Callable[..., StudyResults]

PEG = """\
name: peg
units: {length: m}
object:
  boxes: [{size: [1, 1, 1], position: [0, 0, 0]}]
  pose: {position: [0.0, 0.02, 3]}
cage:
  points: [[0.4, 0.4, 0], [0.4, -0.4, 0], [-0.4, -0.4, 0], [-0.4, 0.4, 0]]
  pose: {position: [0, 0, 0]}
loads: [{name: weight, gravity: [0, 0, -1]}]
"""
"""A cube falls straight down onto four points: its height afterwards is theirs and a half, to rounding."""
