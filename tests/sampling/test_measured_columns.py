"""Gaps, angles and distances between named features are columns: those of closed forms, and of each row alone."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from cagepose import Design, SceneFileError, Study, load_scene, run
from cagepose.files.units import from_metres
from cagepose.runs.driven_cage import cage_at_end
from cagepose.sampling import runner
from cagepose.sampling.findings import findings_of
from cagepose.sampling.measured import MeasuredColumns
from cagepose.sampling.runner import Runner
from cagepose.studies.between_features import Instant
from cagepose.studies.part_gap import PartGap
from our_scenes import SCENES
from our_studies import PEG, RAIL, RunStudy, rows_of

PEG_SCENE, GRIP, JAWS = (path for name in ("peg-in-hole", "grip", "jaws") for path in SCENES if path.stem == name)

SLOT = """\
name: board in its slot
parameters: {slot: 10.4, board: 10, push: 1}
object:
  mass: 1
  boxes: [{name: board, size: ["=board", 80, 40]}]
  pose: {position: [0.05, 0, 20.3]}
cage:
  pose: {position: [0, 0, 0], euler_zyx_deg: [0, 0, 0]}
  shapes:
    - {name: floor, box: {size: [60, 200, 10]}, position: [0, 0, -5]}
    - {name: left, box: {size: [20, 100, 30]}, position: ["=-10 - slot/2", 0, 20]}
    - {name: right, box: {size: [20, 100, 30]}, position: ["=10 + slot/2", 0, 20]}
loads:
  - name: push
    gravity: [0, 0, -10]
    force: {direction: [-1, 0, 0], at: [0, 0, 0], magnitude: "=push"}
"""
GAPS: dict[str, Any] = {
    "play_left": {"gap": ["left", "board"]},
    "play_right": {"gap": ["right", "board"]},
    "below": {"gap": ["floor", "object"]},
}
SIZES: dict[str, Any] = {
    "parameters.slot": {"uniform": [10.2, 10.6]},
    "parameters.board": {"uniform": [9.9, 10.1]},
}


@pytest.fixture
def slot(tmp_path: Path) -> Path:
    path = tmp_path / "slot.yaml"
    path.write_text(SLOT, encoding="utf-8")
    return path


def test_a_board_in_a_slot_has_all_of_its_play_on_one_side(run_study: RunStudy, slot: Path) -> None:
    results = run_study(SIZES, 16, scene=slot, watch=GAPS, accept="play_right > 0.35 and play_left == 0")
    for row in results.table().to_pylist():
        play = row["parameters.slot"] - row["parameters.board"]
        assert (row["play_left"], row["below"]) == (0.0, 0.0)
        assert row["play_right"] == pytest.approx(play, abs=1e-7)
        assert row["accepted"] == (row["play_right"] > 0.35)
    assert [results.columns.units[name] for name in GAPS] == ["mm"] * 3
    assert len({row["accepted"] for row in results.table().to_pylist()}) == 2


def tilt_of_peg(hole: float, depth: float, peg: float) -> float:
    """D cos t - (F - d sin t) sin t = d, by halving, radians: where the play of a peg in its hole ends."""
    low, high = 0.0, 0.2
    for _ in range(60):
        middle = 0.5 * (low + high)
        is_free = hole * math.cos(middle) - (depth - peg * math.sin(middle)) * math.sin(middle) > peg
        low, high = (middle, high) if is_free else (low, middle)
    return low


def test_a_pushed_peg_leans_in_its_hole_as_trigonometry_says(run_study: RunStudy, tmp_path: Path) -> None:
    """Up to the phase that turns it back. Its upper end is beside the hole's axis by what lean and play make of it."""
    text = PEG_SCENE.read_text(encoding="utf-8")
    path = tmp_path / "peg.yaml"
    path.write_text(text[: text.index("  - {name: turn back")], encoding="utf-8")
    watch: dict[str, Any] = {
        "tilt": {"angle": ["hole", "peg"]},
        "from_block": {"angle": ["block.x", "peg"]},
        "upright": {"angle": ["world.z", "object.z"]},
        "side": {"gap": ["block", "peg"]},
        "top": {"point": [0, 0, 20]},
        "off": {"distance": ["hole.z", "top"]},
        "up": {"distance": ["hole", "top"]},
        "axis": {"distance": ["block", "peg.z"]},
    }
    results = run_study({"cage.shapes[1].hole.radius": {"uniform": [6.02, 6.2]}}, 8, scene=path, watch=watch)
    for row in results.table().to_pylist():
        radius = row["cage.shapes[1].hole.radius"]
        tilt = tilt_of_peg(2 * radius, 9.0, 12.0)
        assert row["tilt"] == row["upright"] == pytest.approx(math.degrees(tilt), abs=1e-8)
        assert row["from_block"] == pytest.approx(90.0 - math.degrees(tilt), abs=1e-8)
        # The peg's lower edge is at the wall, at a depth of 9 mm but for what its other side is lifted.
        bottom = -radius + 6.0 * math.cos(tilt)
        top = bottom + 40.0 * math.sin(tilt)
        height = -9.0 + 6.0 * math.sin(tilt) + 40.0 * math.cos(tilt)
        assert row["side"] == 0.0
        assert row["off"] == pytest.approx(abs(top), abs=1e-7)
        assert row["up"] == pytest.approx(math.hypot(top, height), abs=1e-7)
        through = top * math.cos(tilt) - (height + 15.0) * math.sin(tilt)  # from the middle of the block, 15 mm below
        assert row["axis"] == pytest.approx(abs(through), abs=1e-7)
    assert results.columns.units["tilt"] == "deg"


BETWEEN: dict[str, Any] = {
    "stop": {"gap": ["C13", "object"]},
    "back": {"gap": ["C14", "rack"]},
    "roof": {"gap": ["C8", "object"]},
    "twist": {"angle": ["world.x", "object.x"]},
    "away": {"distance": ["C13", "pin"]},
    "pin": {"point": [-600, 0, -60.747]},
}
MOVED: dict[str, dict[str, Any]] = {
    "the cage and friction": {
        "cage.pose.euler_zyx_deg[1]": {"uniform": [-0.4, 0.4]},
        "cage.pose.position[2]": {"uniform": [-0.3, 0.3]},
        "friction.coefficient": {"uniform": [-0.05, 0.3]},
    },
    "points": {
        **{f"cage.points[{index}][2]": {"normal": {"sigma": 0.02}} for index in range(8)},
        "cage.points[12][0]": {"uniform": [9.5, 11.1]},
    },
}


@pytest.mark.parametrize("moved", MOVED.values(), ids=MOVED)
def test_a_row_of_the_batch_is_measured_as_its_scene_alone(
    run_study: RunStudy, monkeypatch: pytest.MonkeyPatch, moved: dict[str, Any]
) -> None:
    """To the last digit, and to that of the run itself; rows that are refused have nothing."""
    results = run_study(moved, 48, watch=BETWEEN, folder="batch")
    assert Runner(results.study).is_batch
    batch = rows_of(results)
    monkeypatch.setattr(MeasuredColumns, "takes", lambda *_: False)
    assert not Runner(results.study).is_batch
    assert rows_of(run_study(moved, 48, watch=BETWEEN, folder="built")) == batch
    assert {row["verdict"] == "refused" for row in batch} == {True, False}
    for row in batch:
        if row["verdict"] == "refused":
            assert [row[name] for name in ("stop", "back", "roof", "twist", "away")] == [None] * 5
            continue
        ended = run(load_scene(RAIL, [f"{one.key}={row[one.key]!r}" for one in results.study.varied]))
        held, cage = ended.scene.object, cage_at_end(ended)
        element = ended.scene.cage.element_names.index("C13")
        rack = held.element_names.index("rack")
        gap = PartGap(ended.scene, [rack], [ended.scene.cage.element_names.index("C14")])
        assert row["back"] == float(from_metres(gap.at(Instant(ended.pose, cage, ended.scene.touch_m)), "mm"))
        apart = math.dist([row[f"pin_{axis}"] for axis in "xyz"], 1e3 * cage.points_world[element])
        assert row["away"] == pytest.approx(apart, rel=1e-12)
    assert min(len({row[name] for row in batch}) for name in ("back", "twist", "away")) > 10


def test_parts_touch_within_the_tolerance_of_their_own_row(run_study: RunStudy, tmp_path: Path) -> None:
    """A point far away makes the scene large, and the tolerance: a point 1 mm beside the cube then touches it."""
    path = tmp_path / "cube.yaml"
    points = "[[0.501, 0, 0.5], [-2, 0, -1], [0.4, 0.4, 0], [0.4, -0.4, 0], [-0.4, -0.4, 0], [-0.4, 0.4, 0]]"
    text = PEG.replace(PEG[PEG.index("[[0.4") : PEG.index("\n  pose: {position: [0, 0, 0]}")], points)
    path.write_text(text.replace("[0.0, 0.02, 3]", "[0, 0, 3]") + "tolerances: {touch: 1.0e-4}\n", encoding="utf-8")
    watch = {"beside": {"gap": ["C1", "object"]}, "far": {"distance": ["C2", "box1"]}}
    varied = {"cage.points[1][0]": {"grid": [-2.0, -50.0]}}
    results = run_study(varied, method="grid", scene=path, watch=watch)
    assert Runner(results.study).is_batch
    near, large = sorted(results.table().to_pylist(), key=lambda row: -row["cage.points[1][0]"])
    assert (near["verdict"], large["verdict"]) == ("rests", "rests")
    assert (near["touching_C1"], large["touching_C1"]) == (False, True)
    assert near["beside"] == pytest.approx(0.001, rel=1e-9)
    assert large["beside"] == 0.0
    assert (near["far"], large["far"]) == pytest.approx((2.5, math.hypot(50.0, 1.5)), rel=1e-2)


def test_the_table_is_the_same_whatever_the_workers(
    run_study: RunStudy, slot: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = rows_of(run_study(SIZES, 8, scene=slot, watch=GAPS, folder="whole"))
    monkeypatch.setattr(runner, "FEW_ROWS", 1)
    monkeypatch.setattr(runner, "ROWS_OF_A_TASK", 4)
    assert rows_of(run_study(SIZES, 8, scene=slot, watch=GAPS, folder="shared", workers=2)) == whole


def test_a_run_that_failed_has_nothing_measured(
    run_study: RunStudy, slot: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the batch and alone, though it ended at a pose."""
    varied = {"parameters.push": {"grid": [1.0, 2.0]}}
    monkeypatch.setattr("cagepose.sampling.measured.FAILURES", frozenset({"rests"}))
    batch = run_study(varied, method="grid", scene=slot, watch=GAPS, folder="batch")
    assert Runner(batch.study).is_batch
    assert [(row["verdict"], row["play_right"]) for row in rows_of(batch)] == [("rests", None)] * 2
    monkeypatch.setattr("cagepose.runs.run.FAILURES", frozenset({"rests"}))
    alone = run_study(SIZES, 2, scene=slot, watch=GAPS, folder="alone")
    assert [(row["verdict"], row["play_right"]) for row in rows_of(alone)] == [("rests", None)] * 2


def test_jaws_are_measured_where_they_were_driven_and_pressed(run_study: RunStudy) -> None:
    """The jaws close on a block that turns flat between them: pads and block touch, and their faces are parallel."""
    watch: dict[str, Any] = {
        "left": {"gap": ["left jaw", "block"]},
        "right": {"gap": ["right pad", "block"]},
        "table": {"gap": ["table", "block"]},
        "flat": {"angle": ["right pad.x", "block.x"]},
        "between": {"distance": ["right pad", "block"]},
    }
    results = run_study({"friction.coefficient": {"uniform": [0.12, 0.2]}}, 2, scene=GRIP, watch=watch)
    assert not Runner(results.study).is_batch
    for row in results.table().to_pylist():
        assert (row["left"], row["right"]) == (0.0, 0.0)
        assert row["table"] == pytest.approx(40.0, abs=1e-6)  # it was lifted by so much
        assert row["flat"] == pytest.approx(0.0, abs=1e-6)
        # 15 mm across, and what was lifted alike; the pad's middle is 6 mm higher than the block's was.
        middle = (15.0, row["position_y"], 6.0)
        assert row["between"] == pytest.approx(math.hypot(*middle), abs=1e-5)


def test_a_jaw_that_was_driven_part_of_its_way_has_the_gap_that_is_left(run_study: RunStudy, tmp_path: Path) -> None:
    """Each is driven by 10 mm of the 35 mm to the middle, but for its own half, and touches nothing."""
    path = tmp_path / "jaws.yaml"
    text = JAWS.read_text(encoding="utf-8").replace("[30, 0, 0]}\n  ", "[10, 0, 0]}\n  ")
    text = text.replace("euler_zyx_deg: [30, 0, 0]", "euler_zyx_deg: [0, 0, 0]").replace("travel: [30", "travel: [10")
    path.write_text(text.replace("travel: [-30", "travel: [-12"), encoding="utf-8")
    watch = {"left": {"gap": ["left", "block"]}, "right": {"gap": ["right jaw", "object"]}}
    (row,) = run_study({"object.mass": {"grid": [1]}}, method="grid", scene=path, watch=watch).table().to_pylist()
    assert (row["left"], row["right"]) == pytest.approx((15.0, 13.0), abs=1e-9)


@pytest.mark.usefixtures("no_pictures", "small_designs")
def test_the_report_and_its_tolerance_table_know_what_is_measured(run_study: RunStudy, slot: Path) -> None:
    found = findings_of(run_study(SIZES, 16, scene=slot, watch=GAPS, compute={"share": "play_right / 2"}))
    (row,) = (row for row in found.tolerances if row.name == "play_right")
    assert row.nominal == pytest.approx(0.4, abs=1e-6)
    assert row.derivatives == pytest.approx([1.0, -1.0], abs=1e-4)
    assert found.statistics.spreads["share"].greatest == found.statistics.spreads["play_right"].greatest / 2


def test_a_design_is_judged_by_what_is_measured(slot: Path) -> None:
    """The widest slot in which all of three boards have less than 0.45 mm beside them."""
    design = Design(
        slot,
        change={"parameters.slot": [10.1, 10.9]},
        wish={"yield": 1.0},
        vary={"parameters.board": {"grid": [9.9, 10.0, 10.1]}},
        sample={"method": "grid"},
        watch={"right": {"gap": ["right", "board"]}},
        accept="right < 0.45",
    )
    found = design.run().loosest
    assert found is not None
    assert found == pytest.approx(10.35, abs=0.001)


@pytest.mark.parametrize(
    ("watch", "told"),
    [
        ({"gap": ["lefd", "board"]}, r"watch\.it\.gap\[0\]: is 'lefd', no name of the cage; did you mean left\? use one"
         r" of: floor, left, right"),
        ({"gap": ["left", "bord"]}, r"watch\.it\.gap\[1\]: is 'bord', no name of the object; did you mean board\?"
         r" use one of: board, object"),
        ({"gap": ["board", "left"]}, r"gap\[0\]: is 'board', which is of the object; name what is of the cage first"),
        ({"gap": ["left", "right"]}, r"gap\[1\]: is 'right', which is of the cage; name what is of the object second:"
         r" board, object"),
        ({"gap": ["left"]}, r"watch\.it\.gap: has 1 value; give 2"),
        ({"gap": ["left", 3]}, r"watch\.it\.gap\[1\]: is 3; give text"),
        ({"gap": "left"}, r"watch\.it\.gap: is text 'left'; give a list in brackets"),
        ({"gap": ["left.x", "board"]}, r"gap\[0\]: is 'left\.x', no name of the cage"),
        ({"angle": ["left", "board.x"]}, r"angle\[0\]: is 'left', a box, which has more than one axis; write left\.x,"
         r" left\.y or left\.z"),
        ({"angle": ["world", "board.x"]}, r"angle\[0\]: is 'world', the world, which has more than one axis; write"
         r" world\.x"),
        ({"angle": ["left.x", "object"]}, r"angle\[1\]: is 'object', the object's frame, which has more than one axis"),
        ({"angle": ["left.x", "plank.x"]}, r"angle\[1\]: is 'plank', no name of the object; use one of: board,"
         r" object\.z"),
        ({"angle": ["far.x", "board.x"]}, r"angle\[0\]: is 'far', no name of the cage; use one of: floor, left, right,"
         r" world\.z"),
        ({"distance": ["left.z", "board.z"]}, r"watch\.it\.distance: names two axes, whose distance is another one"),
        ({"distance": ["left", "tap"]}, r"distance\[1\]: is 'tap', no name of the object; did you mean tip\? use one"
         r" of: board, tip"),
        ({"distance": ["left", "tip.z"]}, r"distance\[1\]: is an axis of 'tip', a watched point, which has none;"
         r" write tip"),
        ({"gap": ["left", "board"], "angle": ["left.x", "board.x"]}, r"watch\.it: has both gap and angle; give one of:"
         r" point, gap, angle, distance"),
        ({}, r"watch\.it: says nothing; give one of: point, gap, angle, distance"),
        ({"gap": ["left", "board"], "of": "object"}, r"watch\.it: says of what it is, which a point alone does"),
    ],
)  # fmt: skip
def test_what_names_nothing_is_told_at_its_place(slot: Path, watch: dict[str, Any], told: str) -> None:
    with pytest.raises(SceneFileError, match=told):
        Study(slot, SIZES, {"runs": 2}, watch={"it": watch, "tip": {"point": [0, 0, 20]}})


def test_all_names_that_are_wrong_are_told_at_once(slot: Path) -> None:
    watch = {"one": {"gap": ["a", "b"]}, "other": {"angle": ["c", "board.x"]}}
    with pytest.raises(SceneFileError) as caught:
        Study(slot, SIZES, {"runs": 2}, watch=watch, accept="pitch_deg <")
    assert [problem.path for problem in caught.value.problems] == [
        ("watch", "one", "gap", 0),
        ("watch", "one", "gap", 1),
        ("watch", "other", "angle", 0),
        ("accept",),
    ]


def test_a_name_that_is_a_column_already_is_refused(slot: Path) -> None:
    watch = {"pitch_deg": {"angle": ["left.x", "board.x"]}}
    with pytest.raises(SceneFileError, match=r"watch\.pitch_deg: gives the column pitch_deg a second meaning; rename"):
        Study(slot, SIZES, {"runs": 2}, watch=watch)


def test_points_and_bodies_have_no_axes_and_a_point_of_two_names_is_refused(tmp_path: Path) -> None:
    vary = {"object.mass": {"uniform": [1, 2]}}
    for watch, told in (
        ({"it": {"distance": ["C1.x", "tip"]}}, r"is an axis of 'C1', a point, which has none; write C1"),
        ({"it": {"angle": ["C1.x", "object.x"]}}, r"is 'C1', a point, which has no axis; name a shape"),
        ({"bottom bar": {"point": [0, 0, 0]}}, "is no name of columns"),
    ):
        with pytest.raises(SceneFileError, match=told):
            Study(RAIL, vary, {"runs": 2}, watch={**watch, "tip": {"point": [0, 0, 0]}})
    path = tmp_path / "slot.yaml"
    path.write_text(SLOT, encoding="utf-8")
    watch = {"board": {"point": [0, 0, 0]}, "it": {"distance": ["left", "board"]}}
    with pytest.raises(SceneFileError, match="is 'board', a watched point and a part of the object; rename the point"):
        Study(path, vary, {"runs": 2}, watch=watch)
