"""The shape of the ``--json`` document, and that its numbers are those of the run in the file's units."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from cagepose import run
from cagepose.files.document import run_document
from cagepose.files.scene_file import parse_scene
from cagepose.files.units import LENGTH_UNITS, LengthUnit, from_metres, to_metres

TOP = ["version", "scene", "units", "method", "verdict", "warnings", "pose", "phases", "timing_s"]
POSE = ["position", "euler_zyx_deg", "quat_wxyz", "center_of_gravity"]
PHASE = ["name", "verdict", "pose", "events", "contacts", "proof"]
EVENT = ["rule", "motion", "direction", "axis", "through", "distance", "angle_deg", "hit", "contacts", "pose"]
CONTACT = ["point", "box", "normal", "gap", "force_normal", "force_tangential"]


def test_the_document_has_exactly_the_agreed_keys(sample_text: str) -> None:
    document = run_document(run(parse_scene(sample_text)))
    (phase,) = document["phases"]
    assert list(document) == TOP
    assert list(document["pose"]) == list(phase["pose"]) == POSE
    assert list(phase) == PHASE
    assert all(list(event) == EVENT and list(event["pose"]) == POSE for event in phase["events"])
    assert all(list(contact) == CONTACT for contact in phase["contacts"])
    assert (document["version"], document["scene"], document["units"]) == (1, "sample", {"length": "mm"})
    assert (document["method"], document["verdict"]) == ("stepwise", "stable")
    assert list(document["timing_s"]) == ["solve"]


def test_travels_turns_and_findings_fill_what_they_have_and_null_what_not(sample_text: str) -> None:
    (phase,) = run_document(run(parse_scene(sample_text)))["phases"]
    travel, turn, _, stable = phase["events"]
    assert (travel["motion"], travel["direction"], travel["axis"], travel["through"]) == (
        "travel",
        [0, 0, -1],
        None,
        None,
    )
    assert (travel["distance"], travel["angle_deg"], travel["hit"]) == (pytest.approx(5.0), 0.0, ["C1"])
    assert (turn["motion"], turn["direction"], turn["axis"]) == ("turn", None, [0, -1, 0])
    assert turn["through"] == pytest.approx([4, 4, 0])
    assert (turn["distance"], turn["angle_deg"]) == (0.0, pytest.approx(math.degrees(math.acos(7 / 8)), abs=1e-9))
    assert [stable[key] for key in EVENT[1:8]] == [None, None, None, None, 0.0, 0.0, []]
    assert stable["contacts"] == ["C1", "C3", "C4"]


def test_what_stepwise_cannot_know_is_null(sample_text: str) -> None:
    (phase,) = run_document(run(parse_scene(sample_text)))["phases"]
    assert phase["proof"] is None
    assert phase["contacts"]
    assert all(contact["force_normal"] is None and contact["force_tangential"] is None for contact in phase["contacts"])


def test_the_final_pose_is_that_of_the_last_phase(sample_text: str) -> None:
    push = "  - {name: push, force: {direction: [1, 0, 0], at: [0, 0, 0]}}\n"
    document = run_document(run(parse_scene(sample_text + push)))
    assert document["pose"] == document["phases"][-1]["pose"] == document["phases"][-1]["events"][-1]["pose"]


@pytest.mark.parametrize("changes", [[], ["loads[0].gravity=[0, 0, 1]"], ["loads[0].gravity=[1, 2, -3]"]])
def test_the_document_is_plain_json_without_nan_or_infinity(sample_text: str, changes: list[str]) -> None:
    document = run_document(run(parse_scene(sample_text, set_values=changes)))
    assert json.loads(json.dumps(document, allow_nan=False)) == document


def test_no_number_is_minus_zero(sample_text: str) -> None:
    text = json.dumps(run_document(run(parse_scene(sample_text))))
    assert "-0.0," not in text
    assert "-0.0]" not in text


def test_a_results_pose_can_be_pasted_back_into_the_scene(sample_text: str) -> None:
    pose = run_document(run(parse_scene(sample_text)))["pose"]
    for keys in (("position", "euler_zyx_deg"), ("position", "quat_wxyz")):
        start = json.dumps({key: pose[key] for key in keys})
        again = run(parse_scene(sample_text, set_values=[f"object.pose={start}", "tolerances.touch=1e-8"]))
        (phase,) = run_document(again)["phases"]
        assert phase["contacts"]  # it starts in touch
        assert phase["pose"]["position"] == pytest.approx(pose["position"], abs=1e-6)


def test_lengths_are_in_the_unit_that_was_asked_for(sample_text: str) -> None:
    result = run(parse_scene(sample_text))
    millimetres, inches = run_document(result), run_document(result, "in")
    assert inches["units"] == {"length": "in"}
    one, other = millimetres["phases"][0]["events"][1], inches["phases"][0]["events"][1]
    assert one["through"] == pytest.approx([25.4 * value for value in other["through"]])
    assert one["angle_deg"] == other["angle_deg"]
    assert one["pose"]["center_of_gravity"] == pytest.approx([25.4 * v for v in other["pose"]["center_of_gravity"]])


@pytest.mark.parametrize("unit", LENGTH_UNITS)
def test_lengths_of_a_file_come_back_to_rounding(unit: LengthUnit) -> None:
    lengths = np.random.default_rng(7).uniform(-1e3, 1e3, 1000)
    assert np.allclose(from_metres(to_metres(lengths, unit), unit), lengths, rtol=5e-16, atol=0.0)
    assert float(to_metres(1.0, unit)) == {"mm": 0.001, "m": 1.0, "in": 0.0254}[unit]
