from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from cagepose import Study, StudyResults
from cagepose.files.key_path import parse_key_path
from cagepose.files.scene_edit import with_values
from cagepose.files.yaml_source import parse_yaml
from cagepose.sampling import report, sensitivity
from our_studies import PEG, RAIL, RunStudy


@pytest.fixture
def run_study(tmp_path: Path) -> RunStudy:
    """Run a study of the rail, or of another scene, into a folder of its own."""

    def run(vary: dict[str, Any], runs: int | None = None, **given: Any) -> StudyResults:
        scene, folder = given.pop("scene", RAIL), given.pop("folder", "out")
        how = {name: given.pop(name) for name in ("workers", "resume", "dask") if name in given}
        sample = {"method": given.pop("method", "sobol"), "seed": given.pop("seed", 1)}
        if runs is not None:
            sample["runs"] = runs
        return Study(scene, vary, sample, **given).run(tmp_path / folder, **how)

    return run


@pytest.fixture
def small_designs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Runs beside the rows are few, where a test asks for something else of the report."""
    monkeypatch.setattr(sensitivity, "BASE_ROWS", 16)
    monkeypatch.setattr(sensitivity, "BASE_ONE_BY_ONE", 16)


@pytest.fixture
def no_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """The pictures of a report are left blank, where a test asks for its numbers: they take a second each time."""
    monkeypatch.setattr(report, "figure_bytes", lambda *_: b"<svg></svg>")
    monkeypatch.setattr(report, "png_bytes", lambda _: b"")


@pytest.fixture
def scene_with(tmp_path: Path) -> Callable[..., Path]:
    """Write the rail's scene with other values, given as ``key.path=value``, into a file."""

    def write(*settings: str) -> Path:
        split = [setting.partition("=") for setting in settings]
        changes = {parse_key_path(key): parse_yaml(value, "value").data for key, _, value in split}
        path = tmp_path / "rail.yaml"
        path.write_text(with_values(RAIL.read_text(encoding="utf-8"), changes), encoding="utf-8")
        return path

    return write


@pytest.fixture
def peg(tmp_path: Path) -> Path:
    path = tmp_path / "peg.yaml"
    path.write_text(PEG, encoding="utf-8")
    return path
