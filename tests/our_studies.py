"""What tests of studies share: the rail, and how a study of it is run."""

from __future__ import annotations

from collections.abc import Callable

from cagepose import StudyResults
from our_scenes import SCENES

(RAIL,) = (path for path in SCENES if path.name == "rail-pitch.yaml")
"""A rail between rollers, out of line by 0.1 deg in pitch."""

RunStudy = Callable[..., StudyResults]
