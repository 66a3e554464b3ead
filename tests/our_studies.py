"""What tests of studies share: the rail, and how a study of it is run."""

from __future__ import annotations

from collections.abc import Callable

from cagepose import StudyResults
from our_scenes import SCENES

(RAIL,) = (path for path in SCENES if path.name == "rail-pitch.yaml")
"""A rail between rollers, out of line by 0.1 deg in pitch."""

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
