from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from cagepose import Study, StudyResults
from our_scenes import SCENES

(RAIL,) = (path for path in SCENES if path.name == "rail-pitch.yaml")
"""A rail between rollers, out of line by 0.1 deg in pitch."""

RUN_STUDY = Callable[..., StudyResults]


@pytest.fixture
def run_study(tmp_path: Path) -> RUN_STUDY:
    """Run a study of the rail, or of another scene, into a folder of its own."""

    def run(vary: dict[str, Any], runs: int | None = None, **given: Any) -> StudyResults:
        scene, folder = given.pop("scene", RAIL), given.pop("folder", "out")
        workers, resume = given.pop("workers", None), given.pop("resume", False)
        sample = {"method": given.pop("method", "sobol"), "seed": given.pop("seed", 1)}
        if runs is not None:
            sample["runs"] = runs
        return Study(scene, vary, sample, **given).run(tmp_path / folder, workers=workers, resume=resume)

    return run
