"""Pictures of runs: what is in them, and that any run can be drawn into any kind of file."""

from __future__ import annotations

import io
import itertools
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from audit.families import drawn_scenes
from cagepose import Load, Object, Scene, load_scene, run
from cagepose.files.write import MADE_BY
from cagepose.paper.cases import sample_scene
from cagepose.paper.figures import range_figure
from cagepose.paper.rail import rail_scene
from cagepose.paper.range_study import range_study
from cagepose.views.event_figure import MOST_SNAPSHOTS, PICTURE, _snapshot, event_figure
from cagepose.views.pose_figure import pose_figure
from cagepose.views.style import figure_bytes
from cagepose.views.viewer.picture import PictureMaker
from cagepose.views.viewer.playback import playback
from cagepose.views.viewer.stage import Stage

SCENES = Path(__file__).resolve().parents[2] / "scenes"


@pytest.fixture(scope="module")
def sample():
    return run(sample_scene(), method="stepwise")


@pytest.fixture(scope="module")
def rail():
    return run(rail_scene(misalignment_zyx=(0.0, np.radians(0.1), 0.0), name="rail"), method="stepwise")


def texts(figure) -> list[str]:
    return [text.get_text() for panel in figure.axes for text in panel.texts]


def vertical_lines(panel) -> list[float]:
    return [line.get_xdata()[0] for line in panel.lines if list(line.get_ydata()) == [0, 1]]


def test_the_curves_are_the_frames_of_the_run(rail):
    """Ten steps to a turn, one to a travel: step 11 ends the weight at 0.4131 deg, the last step is at -0.2131 deg."""
    angles = pose_figure(rail).axes[0]
    frames = list(rail.frames(10))
    for line, column in zip(angles.lines, range(3), strict=False):
        assert line.get_label() == ("yaw", "pitch", "roll")[column]
        expected = [np.degrees(frame.pose_world_object.euler_zyx[column]) for frame in frames]
        assert line.get_ydata() == pytest.approx(expected, abs=1e-12)
    pitch = angles.lines[1].get_ydata()
    assert pitch[11] == pytest.approx(0.4131, abs=5e-5)
    assert pitch[-1] == pytest.approx(-0.2131, abs=5e-5)


def test_a_dashed_line_ends_the_phase_and_bands_mark_the_slides(rail):
    for panel in pose_figure(rail).axes:
        assert vertical_lines(panel) == [11]
        bands = sorted((patch.get_x(), patch.get_width(), patch.get_hatch()) for patch in panel.patches)
        assert bands == [
            (11, 10, "////"), (21, 1, "...."), (32, 10, "////"), (42, 1, "...."), (53, 10, "////"), (63, 1, "...."),
        ]  # fmt: skip


def test_rules_and_contacts_are_named(rail):
    figure = pose_figure(rail)
    assert [text.get_text() for text in figure.axes[0].texts] == [
        "A-1", "A-3", "Slp-1", "Slp-2", "B-3", "Slp-1", "Slp-2", "B-3", "Slp-1", "Slp-2",
    ]  # fmt: skip
    names = [label.get_text() for label in figure.axes[2].get_yticklabels()]
    assert names == ["C1", "C3", "C5", "C7", "C2", "C4", "C9", "C13", "C6", "C8"]


def test_a_full_dot_is_a_point_that_the_motion_reached(sample):
    panel = pose_figure(sample).axes[2]
    looks = {line.get_markerfacecolor(): line for line in panel.lines if line.get_marker() == "o"}
    dots = {face: set(zip(*line.get_data(), strict=True)) for face, line in looks.items()}
    assert dots.pop("white") == {(11, 0), (21, 0), (21, 1)}
    assert list(dots.values()) == [{(1, 0), (11, 1), (21, 2)}]  # C1 after the travel, C4 and C3 after a turn each


def test_unknown_rules_get_no_band_and_are_named_all_the_same(rail):
    """A method of another kind names its events its own way."""
    push = rail.phases[1]
    renamed = replace(push, events=tuple(replace(event, rule="glide") for event in push.events))
    figure = pose_figure(replace(rail, phases=(rail.phases[0], renamed), method="other"))
    assert not figure.axes[0].patches
    assert {text.get_text() for text in figure.axes[0].texts} == {"A-1", "A-3", "glide"}
    titles = [panel.get_title() for panel in event_figure(replace(rail, phases=(rail.phases[0], renamed))).axes]
    assert "6. push, glide: turn 0.3131 deg" in titles


def test_each_event_has_its_snapshot_and_the_weight_its_view(sample):
    figure = event_figure(sample)
    assert [panel.get_title() for panel in figure.axes] == [
        "start",
        "1. gravity, A-1: travel 5 mm",
        "2. gravity, A-2: turn 28.96 deg",
        "3. gravity, A-3: turn 51.32 deg",
        "end of gravity, seen along it:\nno CoG is balanced",
    ]
    view = figure.axes[-1]
    assert (view.get_xlabel(), view.get_ylabel()) == ("x [mm]", "y [mm]")
    assert {text.get_text() for text in view.texts} == {"C1", "C3", "C4"}


def test_a_snapshot_shows_what_is_near_the_cage_and_where_the_motion_began(rail):
    """The cage of 0.2 m fills the picture of a rail of 1.2 m, and nothing of it is cut."""
    stage = Stage(playback(rail, "mm", 2))
    maker = PictureMaker(stage, size=PICTURE, seen=(0, 1))
    places = maker.seen_at(stage.place(stage.points(stage.look(1, stage.proposed))))
    assert ((places > 0.0) & (places < PICTURE)).all()
    assert np.ptp(places[:, 0]) > 0.4 * PICTURE[0]
    start, end = (_snapshot(stage, row).astype(float) for row in (-1, 0))
    assert start.shape == end.shape == (PICTURE[1], PICTURE[0], 3)
    assert (np.abs(start - end).max(axis=2) > 30.0).mean() > 0.02


def test_lengths_are_in_the_unit_asked_for(sample):
    figure = event_figure(sample, "in")
    assert "1. gravity, A-1: travel 0.1969 in" in [panel.get_title() for panel in figure.axes]
    assert pose_figure(sample, "in").axes[1].get_ylabel() == "way of the CoG [in]"


def test_a_long_run_leaves_events_out_and_says_how_many():
    runs = (run(scene, method="stepwise") for scene in drawn_scenes("union", 400, seed=7))
    long = next(found for found in runs if sum(len(phase.events) for phase in found.phases) > 2 * MOST_SNAPSHOTS)
    n_motions = sum(event.motion is not None for phase in long.phases for event in phase.events)
    figure = event_figure(long)
    assert any(text.get_text().endswith(f"left out: {n_motions + 1 - MOST_SNAPSHOTS}") for text in figure.texts)
    assert sum(bool(panel.images) for panel in figure.axes) == MOST_SNAPSHOTS
    assert len(pose_figure(long).axes[0].texts) < n_motions  # names of rules would cover each other


@pytest.mark.parametrize("verdict", ["stable", "escapes", "spins", "cycling"])
def test_runs_of_every_end_can_be_drawn(verdict):
    """Seeded random scenes; warnings are errors, so no axis is without width and nothing is left undrawn."""
    runs = (run(scene, method="stepwise") for scene in drawn_scenes("union", 200, seed=5))
    found = next(found for found in runs if found.verdict == verdict)
    for figure in (pose_figure(found), event_figure(found)):
        with Image.open(io.BytesIO(figure_bytes(figure, ".png"))) as image:
            assert image.size[0] == 1500


def test_names_with_dollars_or_unknown_letters_are_drawn_as_they_are(sample):
    scene = sample.scene
    named = Scene(scene.object, scene.cage, [Load("$g$", gravity=(0, 0, -1))], name="$a_{1}$ $ 立方体")
    figure = pose_figure(run(named, method="stepwise"))
    assert figure_bytes(figure, ".png")
    assert figure.get_suptitle() == "$a_{1}$ $ 立方体: stable (stepwise)"
    assert figure_bytes(event_figure(run(named, method="stepwise")), ".svg")


@pytest.mark.parametrize("suffix", [".png", ".svg", ".pdf"])
def test_every_kind_of_file_bears_our_mark_and_comes_out_the_same_twice(sample, suffix):
    content = figure_bytes(pose_figure(sample), suffix)
    assert MADE_BY.encode() in content
    assert content == figure_bytes(pose_figure(sample), suffix)
    if suffix == ".svg":
        assert ET.fromstring(content).tag.endswith("svg")


def test_a_resting_object_that_never_moves_can_be_drawn():
    """The sample from its final pose: stable at once, one step."""
    first = run(sample_scene(), method="stepwise")
    scene = first.scene
    held = Object(scene.object.boxes, (0, 0, 0), pose=first.pose)
    still = run(Scene(held, scene.cage, scene.loads, name="still"), method="stepwise")
    assert [event.motion for event in still.phases[0].events] == [None]
    figure = pose_figure(still)
    assert [label.get_text() for label in figure.axes[2].get_yticklabels()] == ["C1", "C3", "C4"]
    assert figure_bytes(figure, ".png")
    assert figure_bytes(event_figure(still), ".png")


def test_the_range_is_drawn_with_the_theorys_limit():
    misalignments = np.radians([-0.5, 0.0, 0.5])
    studies = [
        range_study(angle, misalignments, y, "stepwise") for angle in ("yaw", "pitch", "roll") for y in (0.02, -0.02)
    ]
    panels = np.array(range_figure(studies).axes).reshape(3, 3)
    bands = [[[patch.get_width() for patch in panel.patches] for panel in row] for row in panels]
    assert bands[0][0] == pytest.approx([2 * 0.313084], abs=1e-5)
    assert bands[1][1] == pytest.approx([2 * 0.332190], abs=1e-5)
    assert [bands[row][column] for row in range(3) for column in range(3) if row != column] == [[]] * 6
    assert bands[2][2] == []
    by_label = {line.get_label(): line for line in panels[0, 0].lines}
    assert by_label["after the push, pin at y = +20 mm"].get_ydata() == pytest.approx(
        np.degrees(studies[2].after_push_rad[:, 1])
    )


def test_the_curves_follow_a_sliding_contact():
    """Without friction the cube slides on C1 as it tips: at each step the point is on the underside, not inside."""
    slid = run(sample_scene(), method="quasistatic")
    frames = [frame for frame in slid.frames(10) if frame.event_index == 1]
    assert len(frames) == 10
    below = [frame.pose_world_object.inverse_transform((0.004, 0.004, 0.0))[2] + 0.005 for frame in frames]
    assert below == pytest.approx([0.0] * 10, abs=2e-7)
    assert pose_figure(slid).axes[0].lines[1].get_ydata()[-1] == pytest.approx(-45.0, abs=1e-6)


def test_an_unstable_rest_is_named_so_and_lies_over_the_line_of_its_contacts():
    slid = run(sample_scene(), method="quasistatic")
    assert pose_figure(slid).get_suptitle() == "sample: rests, unstable (quasistatic)"
    figure = event_figure(slid)
    assert figure.axes[-1].get_title() == "end of gravity, seen along it:\nCoG on the edge of support"


def test_no_title_is_longer_than_its_panel():
    found = run(rail_scene(misalignment_zyx=(0.0, np.radians(0.1), 0.0)), method="quasistatic")
    titles = [panel.get_title() for panel in event_figure(found).axes]
    assert max(len(line) for title in titles for line in title.splitlines()) <= 60
    assert any(title.startswith("5. push, sliding: screw ") for title in titles)


@pytest.mark.parametrize("name", ["connector"])
def test_every_scene_of_ours_can_be_drawn(name):
    """The others are drawn by the report."""
    result = run(load_scene(SCENES / f"{name}.yaml"), method="stepwise")
    assert "P1" in [label.get_text() for label in pose_figure(result).axes[2].get_yticklabels()]
    assert figure_bytes(event_figure(result), ".svg")


def test_names_of_contacts_in_a_view_along_the_weight_do_not_cover_each_other():
    """The drawer's rollers lie in two rows, and their names are longer than the way from one to the next."""
    view = event_figure(run(load_scene(SCENES / "drawer.yaml"))).axes[-1]
    assert {text.get_text() for text in view.texts} == {
        "left top roller", "left front roller", "right top roller", "right front roller"
    }  # fmt: skip
    boxes = [text.get_window_extent() for text in view.texts if text.get_visible()]
    assert len(boxes) == 4
    assert not any(one.overlaps(other) for one, other in itertools.combinations(boxes, 2))
