"""Each scene of ``scenes/`` against its golden run: the same words, the same numbers to 1e-9 of their size."""

from __future__ import annotations

import pytest

from golden_runs import GOLDEN, SCENES, current, golden


def assert_same(found, expected, place=""):
    assert type(found) is type(expected), place
    if isinstance(expected, dict):
        assert found.keys() == expected.keys(), place
        for key in expected:
            assert_same(found[key], expected[key], f"{place}.{key}")
    elif isinstance(expected, list):
        assert len(found) == len(expected), place
        for index, (one, other) in enumerate(zip(found, expected, strict=True)):
            assert_same(one, other, f"{place}[{index}]")
    elif isinstance(expected, float):
        assert found == pytest.approx(expected, rel=1e-9, abs=1e-9), place
    else:
        assert found == expected, place


@pytest.mark.parametrize("scene_path", SCENES, ids=lambda path: path.stem)
def test_the_scene_still_runs_as_written_down(scene_path):
    assert_same(current(scene_path), golden(scene_path))


def test_every_golden_run_belongs_to_a_scene():
    names = {path.stem for path in SCENES}
    assert names
    assert {path.stem for path in GOLDEN.glob("*.json")} == names
