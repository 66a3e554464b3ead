"""The studies in ``scenes/studies`` run, and the page that explains them shows what is there."""

from __future__ import annotations

from pathlib import Path

import pytest

from cagepose import Design, load_scene, run
from cagepose.files.scene_edit import with_values
from cagepose.files.study_file import parse_study
from cagepose.sampling.runner import Runner
from our_studies import RAIL

FOLDER = RAIL.parent / "studies"
TEXTS = {path: path.read_text(encoding="utf-8") for path in sorted(FOLDER.glob("*.yaml"))}
DESIGNS = [path for path, text in TEXTS.items() if "wish:" in text]
STUDIES = [path for path, text in TEXTS.items() if "vary:" in text and path not in DESIGNS]


@pytest.mark.parametrize("path", STUDIES, ids=[path.stem for path in STUDIES])
def test_a_worked_study_is_right_and_fast(path: Path) -> None:
    text = with_values(path.read_text(encoding="utf-8"), {("sample", "runs"): 32})
    study = parse_study(text, str(path))
    assert study.model.sample.runs == 32
    assert Runner(study).is_batch == (path.stem != "clutch-tolerances")  # which varies shapes


@pytest.mark.parametrize("path", DESIGNS, ids=[path.stem for path in DESIGNS])
def test_a_worked_design_finds_what_the_page_says(path: Path) -> None:
    sentence = Design.load(path).run().sentence()
    page = (FOLDER.parent.parent / "docs" / "studies.md").read_text(encoding="utf-8")
    assert sentence in page


def test_the_rail_with_parameters_is_the_rail() -> None:
    one, other = run(load_scene(RAIL)), run(load_scene(FOLDER / "rail.yaml"))
    assert [phase.verdict for phase in one.phases] == [phase.verdict for phase in other.phases]
    assert one.pose.as_tuples() == other.pose.as_tuples()
