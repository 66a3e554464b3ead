"""The scene files in ``scenes/``, and the methods that run each of them."""

from __future__ import annotations

from pathlib import Path

from cagepose import load_scene
from cagepose.model.methods import METHODS

SCENES = sorted((Path(__file__).resolve().parent.parent / "scenes").glob("*.yaml"))
OF_BOXES_AND_POINTS = [path for path in SCENES if not load_scene(path).has_other_shapes]
CASES = [
    (path, method) for path in SCENES for method in METHODS if path in OF_BOXES_AND_POINTS or method == "quasistatic"
]
"""Each scene with each method that runs its shapes."""
