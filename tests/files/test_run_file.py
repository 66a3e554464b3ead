"""A saved run comes back to the last digit; anything else that is called a saved run is refused by name."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import make_dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cagepose import Contact, Run, RunFileError, Scene, load_run, run, save_run, with_critical_friction
from cagepose.files.document import run_document
from cagepose.files.record import from_record, record_of
from cagepose.files.scene_file import parse_scene
from cagepose.model.checks import FloatArray
from cagepose.model.methods import METHODS

SAVED = sorted((Path(__file__).parent / "saved_runs").glob("*.json"))
PUSH = "  - {name: push, force: {direction: [1, 0.3, 0.2], at: [1, 2, 3], magnitude: 7}}\n"
FULL = """
friction: {angle_deg: 7}
method: stepwise
metric: drag
tolerances: {touch: 1.0e-8, grazing_band_deg: 2}
adjustable: {height: {key: object.pose.position.2, range: [5, 15]}}
"""


@pytest.fixture
def full_scene(sample_text: str) -> Scene:
    """A scene in which nothing is left to its default, and no number is round."""
    text = sample_text.replace("[0, 0, 0]", "[0.1, 0.2, 0.3]\n      euler_zyx_deg: [10, 20, 30]\n      name: cube")
    text = text.replace("cage:\n", "  mass: 0.3\n  inertia: [[5, 0, 0], [0, 6, 0], [0, 0, 7]]\ncage:\n")
    return parse_scene(text.replace("cage:\n", "cage:\n  pose: {euler_zyx_deg: [1, 2, 3]}\n") + PUSH + FULL)


def test_a_scene_is_the_same_after_a_record_and_back(full_scene: Scene) -> None:
    record = json.loads(json.dumps(record_of(full_scene)))
    again = from_record(Scene, record)
    assert record_of(again) == record
    assert again.size_m == full_scene.size_m
    assert np.array_equal(again.object.inertia_kg_m2, full_scene.object.inertia_kg_m2)  # type: ignore[arg-type]


def test_records_of_many_directions_and_turns_come_back_to_the_last_digit(sample_text: str) -> None:
    random = np.random.default_rng(20260)
    for _ in range(200):
        direction, angles = random.normal(size=3).tolist(), (random.uniform(-180, 180, 3)).tolist()
        changes = [
            "object.pose.position=[0, 0, 30]",
            f"loads[0].gravity={direction}",
            f"loads[0].force={{direction: {direction}, at: {direction}}}",
            f"cage.pose.euler_zyx_deg={angles}",
        ]
        scene = parse_scene(sample_text, set_values=changes)
        assert record_of(from_record(Scene, record_of(scene))) == record_of(scene)


@pytest.mark.parametrize("method", METHODS)
def test_a_run_is_the_same_after_saving_and_loading(full_scene: Scene, tmp_path: Path, method: str) -> None:
    before = with_critical_friction(run(full_scene, method))
    save_run(before, tmp_path / "run.json")
    after = load_run(tmp_path / "run.json")
    assert record_of(after) == record_of(before)
    assert (after.verdict, after.warnings, after.solve_s) == (before.verdict, before.warnings, before.solve_s)
    assert np.array_equal(after.pose.position_m, before.pose.position_m)
    assert [event.note for phase in after.phases for event in phase.events] == [
        event.note for phase in before.phases for event in phase.events
    ]
    for one, other in zip(before.frames(), after.frames(), strict=True):
        assert np.array_equal(one.pose_world_object.quaternion_wxyz, other.pose_world_object.quaternion_wxyz)


@pytest.mark.parametrize("method", METHODS)
def test_a_loaded_run_can_be_run_again_with_the_same_result(sample_text: str, tmp_path: Path, method: str) -> None:
    save_run(run(parse_scene(sample_text), method), tmp_path / "run.json")
    loaded = load_run(tmp_path / "run.json")
    again, first = record_of(run(loaded.scene, loaded.method)), record_of(loaded)
    assert {**again, "solve_s": 0.0} == {**first, "solve_s": 0.0}


@pytest.mark.parametrize("path", SAVED, ids=[path.stem for path in SAVED])
def test_a_run_that_an_earlier_version_saved_is_read_without_loss(path: Path) -> None:
    """They were written when each class had a record of its own, and a load one force: every key and number of theirs
    comes back.
    """
    record = record_of(load_run(path))
    for phase in record["phases"]:
        assert [phase["proof"].pop(key) for key in ("gap_work", "largest_force")] == [None, None]  # they are newer
        for key in ("place_m", "group"):
            assert [contact.pop(key) for contact in phase["contacts"]] == [None] * len(phase["contacts"])
        assert (phase.pop("drive"), phase.pop("press")) == (None, None)
        assert {event.pop("share") for event in phase["events"]} == {0.0}
    assert record["scene"].pop("friction_of") == {}  # so are these
    assert record["scene"].pop("planar") is None
    for key in ("shapes", "holes", "cage_shapes", "cage_holes", "cage_bodies", "left_out"):
        assert record["scene"].pop(key) == []
    for load in record["scene"]["loads"]:
        assert [load.pop(key) for key in ("forces", "moments", "springs")] == [[], [], []]
        assert (load.pop("drive"), load.pop("stop_at"), load.pop("press")) == ({}, None, {})
        newer = load["force"] and (load["force"].pop("follows"), load["force"].pop("at_world_m"))
        assert newer in (None, (False, None))
    assert record == json.loads(path.read_text(encoding="utf-8"))["exact"]


def test_a_field_that_is_added_to_a_class_is_saved_and_read_as_well() -> None:
    new_fields: list[Any] = [
        ("slack_m", float, 0.0),
        ("axis_world", FloatArray | None, None),
        ("partners", tuple[Contact, ...], ()),
        ("cell", tuple[int, int], (0, 0)),
    ]
    later: Any = make_dataclass("Later", new_fields, bases=(Contact,), frozen=True, eq=False)
    contact = Contact("C1", "box1", np.array([0.0, 0.0, -1.0]), 0.0, False)
    before = later("C2", "box1", np.array([0.0, 0.6, 0.8]), 1e-12, True, slack_m=math.inf,
                   axis_world=np.array([1.0, 0.0, 0.0]), partners=(contact, contact), cell=(3, 4))  # fmt: skip
    record = json.loads(json.dumps(record_of(before), allow_nan=False))
    after = from_record(later, record)
    assert (after.slack_m, after.cell, after.axis_world.tolist()) == (math.inf, (3, 4), [1.0, 0.0, 0.0])
    assert [partner.point for partner in after.partners] == ["C1", "C1"]
    assert record_of(after) == record
    older = from_record(later, record_of(contact))
    assert (older.point, older.slack_m, older.axis_world, older.partners) == ("C1", 0.0, None, ())


def test_the_way_of_a_sliding_contact_survives(sample_text: str, tmp_path: Path) -> None:
    """Without friction the first point slides under the turning cube: that event's motion alone is not its way."""
    before = run(parse_scene(sample_text), "quasistatic")
    save_run(before, tmp_path / "run.json")
    after = load_run(tmp_path / "run.json")
    assert max(len(event.path) for event in before.phases[0].events) > 10
    for one, other in zip(before.phases[0].events, after.phases[0].events, strict=True):
        for pose, again in zip(one.path, other.path, strict=True):
            assert np.array_equal(pose.position_m, again.position_m)
            assert np.array_equal(pose.quaternion_wxyz, again.quaternion_wxyz)


def test_forces_and_their_proof_survive(sample_text: str, tmp_path: Path) -> None:
    """On a floor of 20 deg, held by friction: no number of it is round."""
    gravity = f"loads[0].gravity=[{math.sin(math.radians(20.0))}, 0, {-math.cos(math.radians(20.0))}]"
    changes = ["object.pose.position=[0, 0, 5]", "friction.coefficient=0.5", gravity]
    before = with_critical_friction(run(parse_scene(sample_text, set_values=changes), "quasistatic"))
    save_run(before, tmp_path / "run.json")
    after = load_run(tmp_path / "run.json")
    assert [contact.force_normal_n for contact in after.contacts] == [
        contact.force_normal_n for contact in before.contacts
    ]
    for one, other in zip(before.contacts, after.contacts, strict=True):
        assert one.force_tangential_n is not None
        assert other.force_tangential_n is not None
        assert np.linalg.norm(one.force_tangential_n) > 0.0
        assert np.array_equal(one.force_tangential_n, other.force_tangential_n)
    proof, again = before.phases[0].proof, after.phases[0].proof
    assert proof.critical_friction == pytest.approx(math.tan(math.radians(20.0)), rel=1e-9)
    for name in ("verdict", "reason", "residual", "needs_friction", "stability", "undetermined", "shared"):
        assert getattr(again, name) == getattr(proof, name)
    assert again.critical_friction == proof.critical_friction
    assert again.motion is proof.motion is None


def test_the_motion_of_a_proof_survives(sample_text: str, tmp_path: Path) -> None:
    """The cube on three points, which no friction of the default holds: it begins to move by a screw."""
    before = run(parse_scene(sample_text), "stepwise")
    save_run(before, tmp_path / "run.json")
    motion, again = before.phases[0].proof.motion, load_run(tmp_path / "run.json").phases[0].proof.motion
    assert motion is not None
    assert again is not None
    assert (again.kind, again.pitch_m) == (motion.kind, motion.pitch_m)
    assert again.direction_world is motion.direction_world is None
    assert np.array_equal(again.axis_world, motion.axis_world)  # type: ignore[arg-type]
    assert np.array_equal(again.through_world, motion.through_world)  # type: ignore[arg-type]


def test_a_critical_friction_without_bound_survives(sample_text: str, tmp_path: Path) -> None:
    """The centre of gravity is a hair beside the floor's points: held by the paper's R3, by no friction."""
    changes = ["object.pose.position=[0, 0, 5]", "object.center_of_gravity=[4.0001, 0, 0]"]
    held = with_critical_friction(run(parse_scene(sample_text, set_values=changes), "stepwise"))
    assert held.phases[0].proof.critical_friction == math.inf
    save_run(held, tmp_path / "run.json")
    assert load_run(tmp_path / "run.json").phases[0].proof.critical_friction == math.inf


@pytest.mark.parametrize("method", METHODS)
def test_an_escape_without_end_survives(sample_text: str, method: str) -> None:
    away = run(parse_scene(sample_text, set_values=["loads[0].gravity=[0, 0, 1]"]), method)
    assert away.verdict == "escapes"
    again = from_record(Run, json.loads(json.dumps(record_of(away), allow_nan=False)))
    assert record_of(again) == record_of(away)
    json.dumps(run_document(away), allow_nan=False)
    distances = [event.motion.distance_m for event in again.phases[0].events if event.motion is not None]
    assert distances in ([], [math.inf])


def test_the_saved_file_begins_with_the_document(sample_text: str, tmp_path: Path) -> None:
    result = run(parse_scene(sample_text))
    save_run(result, tmp_path / "run.json", "in")
    content = json.loads((tmp_path / "run.json").read_text(encoding="utf-8"))
    exact, certificates = content.pop("exact"), content.pop("certificates")
    assert content == run_document(result, "in")
    assert exact["scene"]["name"] == "sample"
    assert [found["uniqueness"] for found in certificates] == ["strong"]


def test_saving_replaces_a_file_whole_and_leaves_nothing_else(sample_text: str, tmp_path: Path) -> None:
    path = tmp_path / "run.json"
    path.write_text('{"version": 0}', encoding="utf-8")
    save_run(run(parse_scene(sample_text)), path)
    assert load_run(path).verdict == "rests"
    assert list(tmp_path.iterdir()) == [path]


def test_a_failed_save_leaves_the_old_file_and_nothing_else(
    sample_text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    result = run(parse_scene(sample_text))
    path = tmp_path / "run.json"
    path.write_text('{"version": 0}', encoding="utf-8")

    def full_disk(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full_disk)
    with pytest.raises(OSError, match="No space left"):
        save_run(result, path)
    assert path.read_text(encoding="utf-8") == '{"version": 0}'
    assert list(tmp_path.iterdir()) == [path]


def test_saving_through_a_link_keeps_the_link(sample_text: str, tmp_path: Path) -> None:
    target, link = tmp_path / "target.json", tmp_path / "link.json"
    target.write_text('{"version": 0}', encoding="utf-8")
    link.symlink_to(target)
    save_run(run(parse_scene(sample_text)), link)
    assert link.is_symlink()
    assert load_run(target).verdict == "rests"


def test_a_device_is_not_replaced_by_a_file(sample_text: str) -> None:
    with pytest.raises(OSError, match="is not a regular file"):
        save_run(run(parse_scene(sample_text)), "/dev/null")
    assert Path("/dev/null").is_char_device()


def _changed(change: Callable[[dict[str, Any]], None]) -> Callable[[dict[str, Any]], str]:
    def text(content: dict[str, Any]) -> str:
        change(content)
        return json.dumps(content)

    return text


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda _: "",
         "is not JSON (Expecting value: line 1 column 1 (char 0)); it is no saved run, or it was cut short"),
        (lambda content: json.dumps(content)[:-20], "is not JSON ("),
        (lambda _: "[" * 200_000, "is JSON nested too deep; it is no saved run"),
        (lambda _: "[1, 2]", "is JSON, but not a run; name a file that cagepose run --out wrote"),
        (lambda _: '{"a": 1}', "is JSON, but not a run; name a file that cagepose run --out wrote"),
        (_changed(lambda content: content.update(version=1)), "has format version 1, and this cagepose knows 2;"
         " read it with the cagepose that wrote it, or run the scene again"),
        (_changed(lambda content: content.update(version=True)), "has format version True, and this cagepose knows 2;"),
        (_changed(lambda content: content.pop("exact")), "is what --json prints, without the exact numbers;"
         " save the run with --out FILE instead"),
        (_changed(lambda content: content.update(exact=3)), "is damaged: exact: "),
        (_changed(lambda content: content["exact"].pop("method")),
         "is damaged: exact.method: field required; run the scene"),
        (_changed(lambda content: content["exact"]["phases"].clear()), "is damaged: exact.phases: "),
        (_changed(lambda content: content["exact"]["phases"][0].update(verdict="fine")), "exact.phases[0].verdict: "),
        (_changed(lambda content: content["exact"]["phases"][0]["start_pose"]["position_m"].pop()),
         "is damaged: exact.phases[0].start_pose.position_m: "),
        (_changed(lambda content: content["exact"]["phases"][0]["start_pose"].update(position_m=[0, 0, math.inf])),
         "is damaged: exact.phases[0].start_pose.position_m[2]: "),
        (_changed(lambda content: content["exact"]["phases"][0]["events"][0]["motion"].update(direction=None)),
         "is damaged: exact.phases[0].events[0].motion: "),
        (_changed(lambda content: content["exact"]["phases"][0].pop("proof")),
         "is damaged: exact.phases[0].proof: field required; run the scene"),
        (_changed(lambda content: content["exact"]["phases"][0]["proof"].update(verdict="fine")),
         "is damaged: exact.phases[0].proof.verdict: "),
        (_changed(lambda content: content["exact"]["phases"][0]["proof"].update(critical_friction="plenty")),
         "is damaged: exact.phases[0].proof.critical_friction"),
        (_changed(lambda content: content["exact"]["phases"][0]["contacts"][0].update(force_tangential_n=[0, 0])),
         "is damaged: exact.phases[0].contacts[0].force_tangential_n: "),
        (_changed(lambda content: content["exact"]["phases"][0]["events"][0]["path"].append(3)),
         "is damaged: exact.phases[0].events[0].path["),
        (_changed(lambda content: content["exact"]["scene"].update(touch=3.0)),
         "is damaged: its scene cannot be right ("),
        (_changed(lambda content: content["exact"]["scene"]["point_names"].pop()),
         "is damaged: its scene cannot be right ("),
    ],
)  # fmt: skip
def test_what_is_no_saved_run_is_refused_by_name(
    sample_text: str, tmp_path: Path, make: Callable[[dict[str, Any]], str], message: str
) -> None:
    path = tmp_path / "run.json"
    save_run(run(parse_scene(sample_text)), path)
    path.write_text(make(json.loads(path.read_text(encoding="utf-8"))), encoding="utf-8")
    with pytest.raises(RunFileError) as caught:
        load_run(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("content", [None, b"\xff\xfe\x00"])
def test_what_cannot_be_read_is_refused_by_name(tmp_path: Path, content: bytes | None) -> None:
    path = tmp_path / "run.json"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(
        RunFileError, match=r"run\.json: cannot be read \((No such file or directory|it is not UTF-8 text)\)"
    ):
        load_run(path)


def test_loading_checks_the_type_of_every_number(sample_text: str) -> None:
    result: Run = run(parse_scene(sample_text))
    record = record_of(result)
    record["solve_s"] = "0.1"
    with pytest.raises(ValueError, match="solve_s"):
        from_record(Run, record)


def test_a_file_that_holds_something_else_is_not_replaced(full_scene: Scene, tmp_path: Path) -> None:
    result, points = run(full_scene), tmp_path / "points.csv"
    points.write_text("C1,1,2,3\n")
    with pytest.raises(OSError, match="holds something else than a saved run"):
        save_run(result, points)
    assert points.read_text() == "C1,1,2,3\n"
    save_run(result, tmp_path / "run.json")
    save_run(result, tmp_path / "run.json")  # a run of before may go
