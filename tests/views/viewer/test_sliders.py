"""Each kind of control, driven once in a real browser: the page shows what the solver finds for that value."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest

from cagepose import load_scene, run
from cagepose.files.scene_file import read_scene_text
from cagepose.views.viewer.server import ViewServer
from cagepose.views.viewer.what_if import WhatIf
from driving import opened, served, set_range, shown_angles, slide, state, wait_until

SLED = """\
name: sled
object:
  boxes: [{name: bar, size: [100, 20, 10], position: [0, 0, 0]}]
  pose: {position: [0, 0, 8]}
  mass: 0.05
cage:
  pose: {position: [0, 0, 0], quat_wxyz: [0.9999, 0.0, 0.0141418, 0]} # pitch 1.6 deg
  points:
    - [-40, 8, 0]
    - [-40, -8, 0]
    - [40, 8, 0]
    - [40, -8, 0]
    - [-40, 10.5, 6]
    - [-40, -10.5, 6]
    - [40, 10.5, 6]
    - [40, -10.5, 6]
    - [52, 0, 6]
    - [0, 0, 16]
loads:
  - {name: weight, gravity: [0, 0, -9.81]}
  - {name: push, gravity: [0, 0, -9.81], force: {direction: [1, 0.1, 0], at: [-50, 0, 0], magnitude: 0.3}}
friction: {coefficient: 0.1}
adjustable:
  stop: {key: "cage.points[8][0]", range: [51, 60]}
"""
"""A bar on four feet between sides and behind a stop; the cage's orientation is a quaternion, the stop can be moved."""


@pytest.fixture(scope="module")
def sled(tmp_path_factory):
    path = tmp_path_factory.mktemp("sled") / "sled.yaml"
    path.write_text(SLED, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def server(sled) -> Iterator[ViewServer]:
    with served(sled) as server:
        yield server


def shown_origin(page) -> list[float]:
    text = page.locator("#pose dd").first.inner_text()
    return [float(word) for word in text.removesuffix(" mm").split(", ")]


SETTINGS = [
    ("adjustable: stop", 54.0, "cage.points[8][0]=54"),
    ("cage: yaw", 0.2, "cage.pose={euler_zyx_deg: [0.2, 1.6206, 0], position: [0, 0, 0]}"),
    ("cage: pitch", 2.0, "cage.pose={position: [0, 0, 0], euler_zyx_deg: [0, 2, 0]}"),
    ("cage: z", -0.5, "cage.pose.position=[0, 0, -0.5]"),
    ("weight: gravity y", 2.0, "loads[0].gravity=[0, 2, -9.81]"),
    ("push: direction y", -0.3, "loads[1].force.direction=[1, -0.3, 0]"),
    ("push: acts at z", 4.0, "loads[1].force.at=[-50, 0, 4]"),
    ("contacts: friction", 0.4, "friction.coefficient=0.4"),
]


def shown_pose(page) -> list[float]:
    return shown_origin(page) + shown_angles(page)


def test_each_slider_shows_the_run_with_its_value_and_undo_the_file_again(watched, server, sled):
    page = opened(watched, server)
    start = shown_pose(page)
    for label, value, setting in SETTINGS:
        slide(page, label, value)
        expected = run(load_scene(sled, [setting]))
        pose = [*(expected.pose.position_m * 1000.0), *np.degrees(expected.pose.euler_zyx)]
        assert page.locator("#verdict").inner_text() == expected.verdict, label
        assert shown_pose(page) == pytest.approx(pose, rel=1e-4, abs=1e-4), label
        assert shown_pose(page) != pytest.approx(start, rel=1e-4, abs=1e-4), label
        assert " ms" in page.locator("#method").inner_text()
        answers = state(page)["answers"]
        page.locator("#undo").click()
        wait_until(page, f"cagepose.state().drawnAnswers === {answers + 1}")
        assert shown_pose(page) == start, label


def test_the_range_itself_moves_as_its_number_does(watched, server):
    page = opened(watched, server)
    page.get_by_label("adjustable: stop", exact=True).first.fill("53")
    wait_until(page, "cagepose.state().drawnAnswers === 1")
    assert page.get_by_label("adjustable: stop", exact=True).last.input_value() == "53"


def test_the_method_and_the_exaggeration_are_named_on_the_screen(watched, server, sled):
    page = opened(watched, server)
    page.locator("#controls select").select_option("stepwise")
    wait_until(page, "method.innerText.includes('stepwise')")
    assert page.locator("#verdict").inner_text() == run(load_scene(sled), "stepwise").verdict
    for index, times in ((0, "true scale"), (7, "play and gaps exaggerated \u00d7200")):
        set_range(page, "exaggeration", index)
        wait_until(page, f"badge.innerText === '{times}'")
    assert state(page)["exaggeration"] == 200


def test_a_cage_given_by_a_quaternion_has_sliders_of_angles(sled):
    what_if = WhatIf(read_scene_text(sled))
    pitch = next(control for control in what_if.controls if (control.group, control.label) == ("cage", "pitch"))
    assert pitch.value == pytest.approx(math.degrees(2.0 * math.atan2(0.0141418, 0.9999)), abs=1e-9)
    assert "quat_wxyz" not in what_if.saved({})
    assert "# pitch 1.6 deg" in what_if.saved({"friction": 0.2})


def test_sliders_start_from_the_values_that_the_command_set(sled):
    what_if = WhatIf(read_scene_text(sled), ("cage.pose.position=[0, 0, -0.25]", "cage.points[8][0]=55"), "stepwise")
    values = {(control.group, control.label): control.value for control in what_if.controls}
    assert values["cage", "z"] == -0.25
    assert values["adjustable", "stop"] == 55.0
    assert values["contacts", "method"] == "stepwise"
    expected = run(load_scene(sled, ["cage.pose.position=[0, 0, -0.25]", "cage.points[8][0]=55"]), "stepwise")
    assert what_if.answer({})["shots"][-1]["origin"] == pytest.approx((expected.pose.position_m * 1000.0).tolist())


def test_without_friction_in_the_file_the_slider_shows_what_the_method_takes(tmp_path):
    path = tmp_path / "sled.yaml"
    path.write_text(SLED.replace("friction: {coefficient: 0.1}\n", ""), encoding="utf-8")
    for method, friction in (("stepwise", math.tan(0.1)), ("quasistatic", 0.0)):
        control = next(c for c in WhatIf(read_scene_text(path), (), method).controls if c.key == "friction")
        assert control.value == pytest.approx(friction, abs=1e-6)
