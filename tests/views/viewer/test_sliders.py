"""Each kind of control, driven once in a real browser: the page shows what the solver finds for that value."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest

from cagepose import Pose, load_scene, run
from cagepose.errors import CageposeError
from cagepose.files.scene_file import read_scene_text
from cagepose.views.viewer.editing import Desk
from cagepose.views.viewer.server import ViewServer
from cagepose.views.viewer.what_if import WhatIf
from driving import opened, served, set_range, shown_angles, slide, state, wait_until
from our_scenes import SCENES as OUR_SCENES

RAIL = next(path for path in OUR_SCENES if path.stem == "rail-pitch")
N_SWEPT = 3

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


def start_with_cage(path, label: str, value: float) -> list[str]:
    """The setting that takes the start along, where a slider moves the cage."""
    group, name = label.split(": ")
    if group != "cage":
        return []
    scene = load_scene(path)
    turn = dict(zip(("yaw", "pitch", "roll"), scene.cage.pose_world_cage.euler_zyx, strict=True))
    moved = Pose(
        (0.0, 0.0, value / 1000.0 if name == "z" else 0.0),
        euler_zyx=tuple({**turn, name: math.radians(value)}[axis] for axis in turn)
        if name in turn
        else (*turn.values(),),
    )
    start = moved @ scene.cage.pose_world_cage.inverse() @ scene.object.pose_world_object
    quaternion = [float(number) for number in start.quaternion_wxyz]
    return [f"object.pose={{position: {(1000.0 * start.position_m).tolist()}, quat_wxyz: {quaternion}}}"]


def shown_pose(page) -> list[float]:
    return shown_origin(page) + shown_angles(page)


def test_each_slider_shows_the_run_with_its_value_and_undo_the_file_again(watched, server, sled):
    page = opened(watched, server)
    start = shown_pose(page)
    for label, value, setting in SETTINGS:
        slide(page, label, value)
        expected = run(load_scene(sled, [setting, *start_with_cage(sled, label, value)]))
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
    for index, times in ((0, "true scale"), (7, "play and gaps exaggerated \u00d7200")):
        set_range(page, "exaggeration", index)
        wait_until(page, f"badge.innerText === '{times}'")
    assert state(page)["exaggeration"] == 200
    page.locator("#controls select").select_option("stepwise")
    wait_until(page, "method.innerText.includes('stepwise')")
    assert page.locator("#verdict").inner_text() == run(load_scene(sled), "stepwise").verdict


def test_a_cage_given_by_a_quaternion_has_sliders_of_angles(sled):
    what_if = WhatIf(read_scene_text(sled))
    pitch = next(control for control in what_if.controls if (control.group, control.label) == ("cage", "pitch"))
    assert pitch.value == pytest.approx(math.degrees(2.0 * math.atan2(0.0141418, 0.9999)), abs=1e-9)
    text = what_if.answer({"friction": 0.2})["text"]
    assert "quat_wxyz" not in text
    assert "# pitch 1.6 deg" in text


def test_sliders_start_from_the_values_that_the_command_set(sled):
    desk = Desk(sled, ("cage.pose.position=[0, 0, -0.25]", "cage.points[8][0]=55"), "stepwise")
    controls = desk.page_content()["controls"]
    values = {(control["group"], control["label"]): control["value"] for control in controls}
    assert values["cage", "z"] == -0.25
    assert values["adjustable", "stop"] == 55.0
    assert values["contacts", "method"] == "stepwise"
    expected = run(load_scene(sled, ["cage.pose.position=[0, 0, -0.25]", "cage.points[8][0]=55"]), "stepwise")
    answer = desk.answers["/run"]({"values": {}})
    assert answer["shots"][-1]["origin"] == pytest.approx((expected.pose.position_m * 1000.0).tolist())


def test_without_friction_in_the_file_the_slider_shows_what_the_method_takes(tmp_path):
    path = tmp_path / "sled.yaml"
    path.write_text(SLED.replace("friction: {coefficient: 0.1}\n", ""), encoding="utf-8")
    for method, friction in (("stepwise", math.tan(0.1)), ("quasistatic", 0.0)):
        control = next(c for c in Desk(path, (), method).page_content()["controls"] if c["key"] == "friction")
        assert control["value"] == pytest.approx(friction, abs=1e-6)


@pytest.mark.parametrize("path", OUR_SCENES, ids=[path.stem for path in OUR_SCENES])
def test_every_slider_can_be_used_over_its_whole_range(path):
    """On every scene of ours; but a load whose direction is along one axis has none at zero, and a spring that nothing
    has tightened is none. Run are the ends alone.
    """
    what_if = WhatIf(read_scene_text(path))
    n_values, problems = 0, []
    for control in what_if.controls:
        for value in () if control.choices else np.linspace(control.low, control.high, N_SWEPT).tolist():
            given = value
            if control.index is not None:
                given = [other.value for other in what_if.controls if other.key == control.key]
                given[control.index] = value
            n_values += 1
            ask = what_if.answer if value in (control.low, control.high) else what_if.scene
            try:
                ask({control.key: given})
            except CageposeError as error:
                problems.append(str(error))
    print(f"{path.stem}: {len(problems)} of {n_values} values cannot be used")
    nothing = ("is all zeros, which points nowhere", "so the spring does nothing")
    assert all(any(words in problem for words in nothing) for problem in problems), problems


@pytest.mark.parametrize("name", ["drawer", "phone-dock", "rollers"])
def test_no_slider_of_the_cage_changes_the_unit_that_shapes_are_drawn_in(name):
    """Else the page would build them all anew."""
    what_if = WhatIf(read_scene_text(next(path for path in OUR_SCENES if path.stem == name)))
    pitch = next(control for control in what_if.controls if (control.group, control.label) == ("cage", "pitch"))
    angles = [control.value for control in what_if.controls if control.key == pitch.key]
    units = set()
    for value in np.linspace(pitch.low, pitch.high, 2 * N_SWEPT).tolist():
        angles[pitch.index] = value
        units.add(what_if.answer({pitch.key: angles})["unitsPerDrawing"])
    assert len(units) == 1


def test_the_sliders_of_the_rail_are_green_from_end_to_end_and_nothing_jumps(watched):
    with served(RAIL) as server:
        page = opened(watched, server)
        place = page.locator("#controls").bounding_box()
        sliders = page.locator("#controls input[type=range]")
        n_answers = 0
        for index in range(sliders.count()):
            slider = sliders.nth(index)
            ends = [slider.get_attribute(name) for name in ("min", "max")]
            for value in ends:
                slider.evaluate("(s, v) => { s.value = v; s.dispatchEvent(new Event('input')); }", value)
                n_answers += 1
                wait_until(page, f"cagepose.state().answers >= {n_answers} || !problems.hidden")
                assert page.locator("#problems").is_hidden(), (slider.get_attribute("aria-label"), value)
            page.locator("#undo").click()
            n_answers += 1
            wait_until(page, f"cagepose.state().answers >= {n_answers}")
        assert page.locator("#controls").bounding_box() == place
        page.locator("#controls input[type=number]").nth(15).fill("")  # no number is a value that cannot be
        wait_until(page, "!problems.hidden")
        assert page.locator("#controls").bounding_box() == place
        watched.expect("status of 422")


def test_the_start_goes_with_the_cage_and_a_saved_scene_runs_to_the_same_end(tmp_path):
    what_if = WhatIf(read_scene_text(RAIL))
    values = {"cage.pose.euler_zyx_deg": [0.2, 0.4, 0.1], "cage.pose.position": [3.0, 0.0, 0.0]}
    answer = what_if.answer(values)
    saved = tmp_path / "saved.yaml"
    saved.write_text(answer["text"], encoding="utf-8")
    scene, before = load_scene(saved), load_scene(RAIL)
    relative = [s.cage.pose_world_cage.inverse() @ s.object.pose_world_object for s in (before, scene)]
    assert relative[1].position_m == pytest.approx(relative[0].position_m, abs=1e-12)
    assert relative[1].euler_zyx == pytest.approx(relative[0].euler_zyx, abs=1e-11)
    assert answer["shots"][-1]["origin"] == pytest.approx((run(scene).pose.position_m * 1000.0).tolist())
