"""Each scene of ``scenes/`` by each method against its golden run: the same words, the same numbers to 1e-9.

What a machine's rounding may change is held to what it means: a residual is rounding, forces that are one way of many
are a balance, and a vector has its digits in parts of its length (the axis of a turn that is nearly a travel lies 97 m
away, and its components across the way there are not known to 1e-9 mm).
"""

from __future__ import annotations

import math

import pytest

from audit.balance import imbalance
from cagepose.kernels.native.library import kernel_library
from golden_runs import CASES, GOLDEN, current, golden, golden_path
from processors import HAS_AVX512

FORCES = ("force_normal", "force_tangential")
IDS = [f"{path.stem}, {method}" for path, method in CASES]
TOLERANCE = 1e-9
SOLVED = 1e-6
"""For what Newton's method found: forces with friction, and the motion that a proof shows."""

SAMPLED = {} if HAS_AVX512 else {"critical_jam_friction": 1e-4}
"""By the key: the least over places on the way. Which places a run asks hangs on last digits: 2.3e-5 was found."""


def assert_same(found, expected, place="", tolerance=TOLERANCE):
    assert type(found) is type(expected), place
    if isinstance(expected, dict):
        assert found.keys() == expected.keys(), place
        for key in expected:
            assert_same(found[key], expected[key], f"{place}.{key}", SAMPLED.get(key, tolerance))
    elif isinstance(expected, list):
        assert len(found) == len(expected), place
        if expected and all(isinstance(part, float) for part in expected):
            allowed = tolerance * max(1.0, math.dist(expected, [0.0] * len(expected)))
            assert found == pytest.approx(expected, rel=tolerance, abs=allowed), place
            return
        for index, (one, other) in enumerate(zip(found, expected, strict=True)):
            assert_same(one, other, f"{place}[{index}]", tolerance)
    elif isinstance(expected, float):
        assert found == pytest.approx(expected, rel=tolerance, abs=tolerance), place
    else:
        assert found == expected, place


def without_solved(document):
    """Take out of each phase what was found by iteration, or is one of many: residual, forces, motion of the proof."""
    phases, solved = [], []
    for phase in document["phases"]:
        contacts = [{key: contact[key] for key in contact if key not in FORCES} for contact in phase["contacts"]]
        sizes = ("residual", "motion", "gap_work", "largest_force")
        proof = {key: value for key, value in phase["proof"].items() if key not in sizes}
        phases.append({**phase, "contacts": contacts, "proof": proof})
        forces = [[contact[key] for key in FORCES] for contact in phase["contacts"]]
        solved.append({"forces": forces, "motion": phase["proof"]["motion"], "residual": phase["proof"]["residual"]})
    return {**document, "phases": phases}, solved


@pytest.fixture(autouse=True)
def short_search_as_plain_python():
    """Not here: a golden run is whole."""


SLOW = ("tapered-pin", "plate-on-pins", "peg-in-hole", "rail", "ladder", "drawer")
"""With friction, their proofs take a minute as plain Python."""


@pytest.mark.parametrize(("scene_path", "method"), CASES, ids=IDS)
def test_the_scene_still_runs_as_written_down(scene_path, method):
    if kernel_library() is None and scene_path.stem.startswith(SLOW):
        pytest.skip("takes a minute as plain Python")
    result, document = current(scene_path, method)
    found, solved = without_solved(document)
    expected, was_solved = without_solved(golden(scene_path, method))
    assert_same(found, expected)
    for phase, one, other in zip(result.phases, solved, was_solved, strict=True):
        assert_same(one["motion"], other["motion"], f"{phase.name}.motion", SOLVED)
        if phase.proof.verdict == "moves":
            assert one["residual"] == pytest.approx(other["residual"], rel=SOLVED)
            assert all(force == [None, None] for force in one["forces"])
            continue
        assert max(one["residual"], other["residual"], abs(phase.proof.gap_work)) < TOLERANCE
        assert imbalance(result.scene, phase) < TOLERANCE
        if not phase.proof.shared:
            assert_same(one["forces"], other["forces"], f"{phase.name}.forces", SOLVED)


def test_every_golden_run_belongs_to_a_scene_and_a_method():
    assert CASES
    assert set(GOLDEN.glob("*.json")) == {golden_path(scene_path, method) for scene_path, method in CASES}
