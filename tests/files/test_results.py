"""The rule by which results become the data of ``--json``."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, field, fields

import numpy as np
import pytest

import cagepose
from cagepose.files.document import run_document
from cagepose.files.results import plain_data
from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.runs.driven import BodyRun, DriveRun
from cagepose.runs.proof import Proof
from cagepose.runs.run import Contact, Event
from our_scenes import SCENES


@dataclass
class Part:
    place_world: FloatArray
    turn_rad: float


@dataclass
class Result:
    name: str
    gap_m: float
    lengths_m: tuple[float, float]
    least_moment_nm: float
    pull_n: float
    parts: tuple[Part, ...]
    pose_world_object: Pose
    shares: dict[str, FloatArray]
    distance_m: float = math.inf
    greatest_n: float = math.inf
    found: bool | None = None
    _hidden: int = field(default=0)


def test_keys_are_names_without_frame_and_unit_and_numbers_in_the_scenes_unit() -> None:
    pose = Pose((0.0254, 0.0, 0.0), euler_zyx=(0.0, math.radians(90.0), 0.0))
    parts = (Part(np.array([0.0254, -0.0, 0.0508]), math.radians(30.0)),)
    result = Result("peg", 0.0127, (0.0254, 0.0508), 2.54, 3.0, parts, pose, {"a": np.array([0.5, -0.0])})
    told = plain_data(result, "in", without=("name",))
    assert told == {
        "gap": 0.5,
        "lengths": [1.0, 2.0],
        "least_moment": pytest.approx(100.0),
        "pull": 3.0,
        "parts": [{"at": [1.0, 0.0, 2.0], "turn_deg": pytest.approx(30.0)}],
        "pose": {
            "position": [1.0, 0.0, 0.0],
            "euler_zyx_deg": pytest.approx([0.0, 90.0, 0.0]),
            "quat_wxyz": pytest.approx([math.sqrt(0.5), 0.0, math.sqrt(0.5), 0.0]),
        },
        "shares": {"a": [0.5, 0.0]},
        "distance": None,
        "greatest": "unbounded",
        "found": None,
    }
    assert "-0.0" not in json.dumps(told, allow_nan=False)


def test_numbers_that_json_has_not_are_null_or_a_word() -> None:
    part = Part(np.array([1.0, math.inf, math.nan]), math.nan)
    assert plain_data(part, "m") == {"at": [1.0, "unbounded", None], "turn_deg": None}
    assert plain_data(Part(np.zeros(3), np.float64(math.pi)), "m")["turn_deg"] == pytest.approx(180.0)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", ["dock", "gripper"])
def test_each_field_of_a_result_is_in_the_document_of_its_run(name: str) -> None:
    path = next(path for path in SCENES if path.stem == name)
    run = cagepose.run(cagepose.load_scene(path))
    last = run_document(run)["phases"][-1]
    told = {Contact: last["contacts"][0], Event: last["events"][0], Proof: last["proof"]}
    if name == "dock":
        told |= {DriveRun: last["drive"], BodyRun: next(iter(last["drive"]["bodies"].values()))}
    elsewhere = {"path", "share", "greatest_along", "greatest_share"}  # of an event on a drive, and under "greatest"
    for kind, document in told.items():
        for one in fields(kind):
            key = one.name.replace("place_world", "at").replace("_rad", "_deg")
            for ending in ("_cage_body", "_world_object", "_world", "_m", "_nm", "_n", "_j"):
                key = key.removesuffix(ending)
            assert key in document or one.name in elsewhere, f"{kind.__name__}.{one.name}"
