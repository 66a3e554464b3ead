"""Springs, moments and forces that follow: what pictures, films, pages and sliders make of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cagepose import Load, Pose, Run, run
from cagepose.files.scene_file import parse_scene, read_scene_text
from cagepose.runs.driven_cage import cage_at_start
from cagepose.studies.acts import acts_of, coil
from cagepose.views.event_figure import event_figure
from cagepose.views.style import figure_bytes
from cagepose.views.viewer.controls import controls
from cagepose.views.viewer.page_data import page_data
from cagepose.views.viewer.picture import SIZE, PictureMaker
from cagepose.views.viewer.playback import playback
from cagepose.views.viewer.stage import Stage

TEXT = """\
name: plate
object:
  boxes: [{size: [80, 60, 10], position: [0, 0, 0]}]
  mass: 0.3
  pose: {position: [0, 0, 8]}
cage: {points: [[-30, -20, 0], [-30, 20, 0], [30, 0, 0], [-25, -31, 8], [25, -31, 8], [25, 31, 8], [42, 0, 8]]}
loads:
  - name: fasten
    gravity: [0, 0, -9.81]
    springs:
      - {at: [20, 0, 5], to: [20, 0, -40], stiffness: 0.8, preload: 4}
      - {at: [-20, 0, 5], to: [-20, 0, -40], stiffness: 0, preload: -1}
    moments: [{direction: [0, 0, 1], magnitude: 120}]
    forces: [{direction: [1, 0, 0], at: [-40, 0, 0], magnitude: 2, follows: true}]
"""


@pytest.fixture(scope="module")
def fastened() -> Run:
    return run(parse_scene(TEXT))


def test_all_that_acts_is_named_and_points_where_it_does(fastened: Run) -> None:
    acts = acts_of(fastened.scene, fastened.scene.loads[0])
    assert [act.name for act in acts] == ["weight", "force 1", "moment 1", "spring 1", "spring 2"]
    turned, cage = Pose((0, 0, 0.008), euler_zyx=(0.5, 0.0, 0.0)), cage_at_start(fastened.scene.cage)
    assert acts[1].direction_at(turned, cage) == pytest.approx([np.cos(0.5), np.sin(0.5), 0.0])
    assert acts[2].direction_at(turned, cage).tolist() == [0.0, 0.0, 1.0]
    here = turned.transform(acts[3].at_object(turned))
    assert acts[3].direction_at(turned, cage) == pytest.approx(
        (np.array([0.02, 0.0, -0.04]) - here) / np.linalg.norm(np.array([0.02, 0.0, -0.04]) - here)
    )


def test_the_arrow_of_a_force_that_stays_in_the_world_ends_where_it_acts_on_the_part() -> None:
    """Exaggerated, the part is shown elsewhere; its place under the force goes with it."""
    fixed = "forces: [{direction: [0, 0, -1], at_world: [-10, 5, 13], magnitude: 2}]"
    slid = run(parse_scene(TEXT.replace(TEXT[TEXT.index("forces:") :], f"{fixed}\n")))
    shown = playback(slid)
    maker, stage = PictureMaker(Stage(shown), [1]), Stage(shown)
    maker.picture(shown.shots[-1])
    (act,) = [act for act in shown.loads[0] if act.kind == "force"]
    ends = [maker._ends(act, shot, shot.pose_world_object, maker.now)[1] for shot in shown.shots]
    assert np.ptp(ends, axis=0) == pytest.approx(0.0, abs=1e-12)
    assert ends[0] == pytest.approx(stage.place(np.array([-10, 5, 13]) * 1e-3))
    last = shown.shots[-1]
    aside = Pose((0.001, 0.0, 0.0)) @ last.pose_world_object
    apart = maker._ends(act, last, aside, maker.now)[1] - ends[-1]
    assert apart == pytest.approx([0.001 / stage.size_m, 0.0, 0.0])
    told = page_data(shown)["phases"][0]["loads"]
    assert [load["atWorld"] for load in told if load["kind"] == "force"] == [pytest.approx(ends[0].tolist())]


def test_a_spring_is_drawn_from_end_to_end_around_its_line() -> None:
    start, end = np.array([1.0, 2.0, 3.0]), np.array([1.5, 2.5, 2.0])
    line = coil(start, end, 0.1)
    axis = (end - start) / np.linalg.norm(end - start)
    assert np.array_equal(line[[0, -1]], [start, end])
    off = np.linalg.norm(np.cross(line - start, axis), axis=1)
    assert off[2:-2] == pytest.approx(0.1)
    assert (np.diff((line - start) @ axis) >= -1e-15).all()
    assert coil(start, start, 0.1).tolist() == [start.tolist()] * 2


def test_pictures_have_all_that_acts_inside(fastened: Run) -> None:
    shown = playback(fastened)
    maker = PictureMaker(Stage(shown), [1])
    last = shown.shots[-1]
    drawn = np.asarray(maker.picture(last), dtype=float)
    for act in shown.loads[0]:
        for end in maker._ends(act, last, last.pose_world_object, maker.now):
            place = maker.seen_at(end)
            assert ((place > 0.0) & (place < SIZE)).all(), act.name
    # A spring's end is below all else: nothing but the spring is dark there.
    x, y = maker.seen_at(maker._ends(shown.loads[0][3], last, last.pose_world_object, maker.now)[1]).astype(int)
    assert drawn[y - 6 : y + 1, x - 3 : x + 4].min() < 100.0
    assert len(figure_bytes(event_figure(fastened), ".png")) > 10_000


def test_the_page_is_told_what_each_of_them_is(fastened: Run) -> None:
    (phase,) = page_data(playback(fastened))["phases"]
    weight, force, moment, spring, _ = phase["loads"]
    assert [load["kind"] for load in phase["loads"]] == ["weight", "force", "moment", "spring", "spring"]
    assert (force["follows"], moment["follows"], weight["follows"]) == (True, False, False)
    assert (len(spring["to"]), force["to"]) == (3, None)


def test_sliders_change_what_they_name(tmp_path: Path) -> None:
    path = tmp_path / "plate.yaml"
    path.write_text(TEXT, encoding="utf-8")
    made = {control.label: control for control in controls(read_scene_text(path)) if control.group == "fasten"}
    assert {"force 1 direction y", "force 1 acts at x", "moment 1", "spring 1 stiffness", "spring 2 preload"} <= set(
        made
    )
    assert (made["spring 1 stiffness"].unit, made["moment 1"].unit) == ("N/mm", "N mm")
    for label in ("moment 1", "spring 1 stiffness", "spring 2 preload"):
        control = made[label]
        assert control.low <= float(control.value) <= control.high
        changed = read_scene_text(path).scene_file([f"{control.key}={control.high}"]).scene.loads[0]
        assert isinstance(changed, Load)
