"""The shape of the ``--json`` document, and that its numbers are those of the run in the file's units."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from cagepose import Box, Cage, Load, Object, Pose, Run, Scene, run, with_critical_friction
from cagepose.files.document import run_document
from cagepose.files.scene_file import parse_scene
from cagepose.files.units import LENGTH_UNITS, LengthUnit, from_metres, to_metres
from cagepose.model.methods import METHODS
from cagepose.model.shapes import Capsule, Sphere

TOP = ["version", "scene", "units", "method", "verdict", "warnings", "pose", "phases", "timing_s"]
POSE = ["position", "euler_zyx_deg", "quat_wxyz", "center_of_gravity"]
PHASE = ["name", "verdict", "force_unit", "pose", "events", "contacts", "proof"]
EVENT = ["rule", "motion", "direction", "axis", "through", "distance", "angle_deg", "hit", "contacts", "pose", "note"]
CONTACT = ["point", "box", "normal", "gap", "near_edge", "force_normal", "force_tangential", "at", "group"]
PROOF = [
    *("verdict", "reason", "residual", "needs_friction", "stability", "undetermined", "shared", "motion"),
    *("critical_friction", "gap_work", "largest_force", "uniqueness"),
]
MOTION = ["kind", "direction", "axis", "through", "pitch"]
VERDICTS = {"stepwise": "stable", "quasistatic": "rests"}
FLOOR = ["object.pose.position=[0, 0, 5]"]
BESIDE_THE_FLOOR = [*FLOOR, "object.center_of_gravity=[4.0001, 0, 0]"]
"""The paper's rules hold the cube (R3); no friction can."""


def sample_run(text: str, method: str, *changes: str) -> Run:
    return run(parse_scene(text, set_values=changes), method)


@pytest.mark.parametrize("method", METHODS)
def test_the_document_has_exactly_the_agreed_keys(sample_text: str, method: str) -> None:
    document = run_document(sample_run(sample_text, method))
    (phase,) = document["phases"]
    assert list(document) == TOP
    assert list(document["pose"]) == list(phase["pose"]) == POSE
    assert list(phase) == PHASE
    assert all(list(event) == EVENT and list(event["pose"]) == POSE for event in phase["events"])
    assert all(list(contact) == CONTACT for contact in phase["contacts"])
    assert list(phase["proof"]) == PROOF
    motion = phase["proof"]["motion"]
    assert motion is None or list(motion) == MOTION
    assert (document["version"], document["scene"], document["units"]) == (
        2,
        "sample",
        {"length": "mm", "force": "load"},
    )
    assert (document["method"], document["verdict"]) == (method, VERDICTS[method])
    assert list(document["timing_s"]) == ["solve"]


def test_travels_turns_and_findings_fill_what_they_have_and_null_what_not(sample_text: str) -> None:
    (phase,) = run_document(sample_run(sample_text, "stepwise"))["phases"]
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


def test_where_nothing_balances_the_load_forces_are_null_and_the_motion_is_shown(sample_text: str) -> None:
    """The cube on three points (docs/theory/right-and-wrong): no balance below a coefficient of 0.4569."""
    (phase,) = run_document(sample_run(sample_text, "stepwise"))["phases"]
    assert phase["contacts"]
    assert all(contact["force_normal"] is None and contact["force_tangential"] is None for contact in phase["contacts"])
    proof = phase["proof"]
    assert (proof["verdict"], proof["reason"]) == ("moves", "no contact forces balance the load")
    assert (proof["needs_friction"], proof["stability"]) == (False, None)
    assert (proof["undetermined"], proof["shared"], proof["critical_friction"]) == ([], [], None)
    assert 0.1 < proof["residual"] < 1.0
    assert proof["motion"]["kind"] == "screw"
    assert np.linalg.norm(proof["motion"]["axis"]) == pytest.approx(1.0)
    assert proof["motion"]["direction"] is None


def test_where_the_load_is_balanced_every_contact_has_its_force(sample_text: str) -> None:
    """A cube of 2 kg on four points: each may carry anything up to half of the weight, all of it together."""
    changes = [*FLOOR, "object.mass=2", "loads[0].gravity=[0, 0, -9.81]"]
    (phase,) = run_document(sample_run(sample_text, "quasistatic", *changes))["phases"]
    forces = [contact["force_normal"] for contact in phase["contacts"]]
    assert len(forces) == 4
    assert sum(forces) == pytest.approx(2 * 9.81, rel=1e-12)
    assert all(0.0 <= force <= 9.81 * (1.0 + 1e-12) for force in forces)
    assert all(contact["force_tangential"] == [0.0, 0.0, 0.0] for contact in phase["contacts"])
    proof = phase["proof"]
    assert (proof["verdict"], proof["reason"]) == ("rests", "the contacts balance the load without friction")
    assert proof["residual"] < 1e-12
    assert (proof["needs_friction"], proof["stability"], proof["motion"]) == (False, "marginal", None)
    assert (proof["undetermined"], proof["shared"]) == (["x", "y", "yaw"], ["C1", "C2", "C3", "C4"])


def test_a_contact_says_where_it_is_also_where_round_shapes_touch() -> None:
    """A ball of 10 mm radius rolls over a floor at z = 2 mm against an upright pin of 5 mm radius at x = 30 mm."""
    weight = Load("weight", gravity=(0.3, 0, -1))
    ball = Object(
        shapes=[Sphere(0.01)], center_of_gravity_m=(0, 0, 0), mass_kg=1.0, inertia_kg_m2=np.eye(3) * 4e-5,
        pose=Pose((0, 0, 0.02)),
    )  # fmt: skip
    upright = Capsule(0.005, 0.04, Pose((0.03, 0, 0.02)))
    cage = Cage(shapes=[Box((0.2, 0.2, 0.02), Pose((0, 0, -0.008)), "floor"), upright])
    (phase,) = run_document(run(Scene(ball, cage, [weight])))["phases"]
    places = {contact["point"]: contact["at"] for contact in phase["contacts"]}
    assert places == {"floor": pytest.approx([15, 0, 2]), "capsule1": pytest.approx([25, 0, 12])}


def test_the_place_of_a_point_is_its_own(sample_text: str) -> None:
    scene = parse_scene(sample_text, set_values=FLOOR)
    (phase,) = run_document(run(scene))["phases"]
    points = dict(zip(scene.cage.names, (scene.cage.points_world() * 1000.0).tolist(), strict=True))
    assert phase["contacts"]
    for contact in phase["contacts"]:
        assert contact["at"] == pytest.approx(points[contact["point"]], abs=1e-12)


def test_a_force_with_friction_has_its_part_along_the_face(sample_text: str) -> None:
    """On a floor of 20 deg: one part of load gives cos 20 deg onto the faces, and sin 20 deg along them, uphill."""
    slope = math.radians(20.0)
    changes = [*FLOOR, "friction.coefficient=0.5", f"loads[0].gravity=[{math.sin(slope)}, 0, {-math.cos(slope)}]"]
    (phase,) = run_document(sample_run(sample_text, "quasistatic", *changes))["phases"]
    assert phase["proof"]["needs_friction"] is True
    contacts = phase["contacts"]
    assert sum(contact["force_normal"] for contact in contacts) == pytest.approx(math.cos(slope), rel=1e-9)
    along = np.sum([contact["force_tangential"] for contact in contacts], axis=0)
    assert along == pytest.approx([-math.sin(slope), 0.0, 0.0], abs=1e-9)


@pytest.mark.parametrize(("unit", "per_mm"), [("mm", 1.0), ("in", 1.0 / 25.4)])
def test_a_free_motion_is_in_the_unit_that_was_asked_for(sample_text: str, unit: LengthUnit, per_mm: float) -> None:
    result = sample_run(sample_text, "stepwise")
    motion = result.phases[0].proof.motion
    assert motion is not None
    assert motion.through_world is not None
    shown = run_document(result, unit)["phases"][0]["proof"]["motion"]
    assert shown["through"] == pytest.approx((motion.through_world * 1000.0 * per_mm).tolist())
    assert shown["pitch"] == pytest.approx(motion.pitch_m * 1000.0 * per_mm)


def test_the_critical_friction_is_a_number_or_none_or_null(sample_text: str) -> None:
    """Null where it was not asked for; JSON has no infinity, so "none" where no friction is enough."""
    held = sample_run(sample_text, "stepwise")
    assert run_document(held)["phases"][0]["proof"]["critical_friction"] is None
    found = run_document(with_critical_friction(held))["phases"][0]["proof"]["critical_friction"]
    assert found == pytest.approx(0.4569067464, abs=1e-9)
    level = with_critical_friction(sample_run(sample_text, "quasistatic", *FLOOR))
    assert run_document(level)["phases"][0]["proof"]["critical_friction"] == 0.0
    hopeless = with_critical_friction(sample_run(sample_text, "stepwise", *BESIDE_THE_FLOOR))
    assert hopeless.verdict == "stable"
    assert hopeless.phases[0].proof.critical_friction == math.inf
    assert run_document(hopeless)["phases"][0]["proof"]["critical_friction"] == "none"


@pytest.mark.parametrize("method", METHODS)
def test_the_final_pose_is_that_of_the_last_phase(sample_text: str, method: str) -> None:
    push = "  - {name: push, force: {direction: [1, 0, 0], at: [0, 0, 0]}}\n"
    document = run_document(sample_run(sample_text + push, method))
    assert document["pose"] == document["phases"][-1]["pose"] == document["phases"][-1]["events"][-1]["pose"]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("changes", [[], ["loads[0].gravity=[0, 0, 1]"], ["loads[0].gravity=[1, 2, -3]"]])
def test_the_document_is_plain_json_without_nan_or_infinity(sample_text: str, changes: list[str], method: str) -> None:
    document = run_document(sample_run(sample_text, method, *changes))
    assert json.loads(json.dumps(document, allow_nan=False)) == document


@pytest.mark.parametrize("method", METHODS)
def test_no_number_is_minus_zero(sample_text: str, method: str) -> None:
    text = json.dumps(run_document(sample_run(sample_text, method)))
    assert "-0.0," not in text
    assert "-0.0]" not in text


@pytest.mark.parametrize("method", METHODS)
def test_a_results_pose_can_be_pasted_back_into_the_scene(sample_text: str, method: str) -> None:
    pose = run_document(sample_run(sample_text, method))["pose"]
    for keys in (("position", "euler_zyx_deg"), ("position", "quat_wxyz")):
        start = json.dumps({key: pose[key] for key in keys})
        again = sample_run(sample_text, method, f"object.pose={start}", "tolerances.touch=1e-8")
        (phase,) = run_document(again)["phases"]
        assert phase["contacts"]  # it starts in touch
        assert phase["pose"]["position"] == pytest.approx(pose["position"], abs=1e-6)


def test_lengths_are_in_the_unit_that_was_asked_for(sample_text: str) -> None:
    result = sample_run(sample_text, "stepwise")
    millimetres, inches = run_document(result), run_document(result, "in")
    assert inches["units"] == {"length": "in", "force": "load"}
    one, other = millimetres["phases"][0]["events"][1], inches["phases"][0]["events"][1]
    assert one["through"] == pytest.approx([25.4 * value for value in other["through"]])
    assert one["angle_deg"] == other["angle_deg"]
    assert one["pose"]["center_of_gravity"] == pytest.approx([25.4 * v for v in other["pose"]["center_of_gravity"]])


@pytest.mark.parametrize("unit", LENGTH_UNITS)
def test_lengths_of_a_file_come_back_to_rounding(unit: LengthUnit) -> None:
    lengths = np.random.default_rng(7).uniform(-1e3, 1e3, 1000)
    assert np.allclose(from_metres(to_metres(lengths, unit), unit), lengths, rtol=5e-16, atol=0.0)
    assert float(to_metres(1.0, unit)) == {"mm": 0.001, "m": 1.0, "in": 0.0254}[unit]


PUSH = "  - {name: push, force: {direction: [0, 0, -1], at: [0, 0, 0], magnitude: 3}}\n"


def test_the_unit_of_forces_is_told_and_of_each_phase_where_they_differ(sample_text: str) -> None:
    mass = ["object.mass=2", *FLOOR]
    newtons = run_document(sample_run(sample_text, "quasistatic", *mass))
    assert (newtons["units"]["force"], newtons["phases"][0]["force_unit"]) == ("N", "N")
    both = run_document(sample_run(sample_text + PUSH, "quasistatic", *FLOOR))
    assert both["units"]["force"] is None
    assert [phase["force_unit"] for phase in both["phases"]] == ["load", "N"]


@pytest.mark.parametrize("method", METHODS)
def test_an_escape_has_a_motion_of_its_own(sample_text: str, method: str) -> None:
    """Off its corner, and from there along the load: its last event says so, from the pose before it."""
    document = run_document(sample_run(sample_text, method, "loads[0].gravity=[0, 0.6, 0.8]"))
    assert document["verdict"] == "escapes"
    last = document["phases"][0]["events"][-1]
    assert (last["motion"], last["distance"], last["angle_deg"]) == ("travel", None, 0.0)
    assert last["direction"] == pytest.approx([0, 0.6, 0.8])
    assert (last["hit"], last["contacts"], last["pose"]) == ([], [], document["pose"])
    assert last["rule"] == ("A-1" if method == "stepwise" else "escapes")


def test_what_led_to_an_escape_is_an_event_before_it(sample_text: str) -> None:
    document = run_document(sample_run(sample_text, "quasistatic", "object.center_of_gravity=[9, 4, 0]"))
    rules = [event["rule"] for event in document["phases"][0]["events"]]
    assert rules == ["free", "slide", "escapes"]
    assert document["phases"][0]["events"][1]["motion"] == "screw"


def test_a_proof_says_how_strong_it_is(sample_text: str) -> None:
    held = run_document(sample_run(sample_text, "quasistatic", *FLOOR))["phases"][0]["proof"]
    assert held["uniqueness"] == "strong"
    moving = run_document(sample_run(sample_text, "stepwise"))["phases"][0]["proof"]
    assert [moving[key] for key in ("uniqueness", "gap_work", "largest_force")] == [None, None, None]
