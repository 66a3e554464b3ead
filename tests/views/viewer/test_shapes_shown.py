"""Shapes on pictures and pages: where they are, where they touch, how much data they are."""

from __future__ import annotations

import json
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from cagepose import Box, Cage, Cylinder, Force, Hole, Load, Object, Pose, Scene, load_scene, run
from cagepose.files.scene_file import read_scene_text
from cagepose.model.shapes import Capsule, Sphere
from cagepose.views.viewer.page import page
from cagepose.views.viewer.page_data import page_data
from cagepose.views.viewer.picture import SIZE, PictureMaker
from cagepose.views.viewer.playback import Playback, playback
from cagepose.views.viewer.stage import EXAGGERATIONS, Look, Stage
from cagepose.views.viewer.what_if import WhatIf
from driving import count_drawing, drawn_for_a_picture, set_range, state, wait_until
from marks_left_out import is_marked, without_marks
from our_scenes import SCENES as OUR_SCENES
from shaped_scenes import WEIGHT, ball_on_points, ball_on_table, bar_between_bars, block_on_balls

BLOCK = Box((0.05, 0.05, 0.03), Pose((0.0, 0.0, -0.015)), "block")
SCENES = [ball_on_table, ball_on_points, bar_between_bars, block_on_balls]


@pytest.mark.parametrize("scene", SCENES)
def test_everything_that_touches_is_in_the_picture_and_marked(scene: Callable[[], Scene]) -> None:
    film = playback(run(scene()))
    maker, last = PictureMaker(Stage(film), [1] * len(film.run.phases)), film.shots[-1]
    pictures = maker.picture(last), without_marks(maker)
    assert len(last.touches.points) >= 1
    for place in maker.seen_at(maker.places(last)):
        assert ((place > 0.0) & (place < SIZE)).all()
        assert is_marked(pictures, place)


def test_a_floor_that_is_not_much_larger_is_in_the_picture_as_a_whole_but_no_table_that_hides_a_ball() -> None:
    """The block of the peg is as wide as the peg is long, the table forty times as the ball."""
    block = Stage(playback(run(load_scene(next(path for path in OUR_SCENES if path.stem == "peg-in-hole")))))
    maker = PictureMaker(block)
    corners = maker.seen_at(block.place(np.concatenate(block.bodies_world)))
    assert ((corners > 0.0) & (corners < SIZE)).all()
    table = Stage(playback(run(ball_on_table())))
    (shape,) = table.shown.scene.cage.shapes
    assert np.ptp(table.bodies_world[0], axis=0).max() < 0.5 * np.ptp(shape.nodes_body(), axis=0).max()


def test_contacts_are_where_the_run_says_and_move_along_on_what_is_round() -> None:
    """While the bar slides down the other one, it touches that at 10 mm from both axes, and midway between them."""
    film = playback(run(bar_between_bars()), shots_per_motion=8)
    last = film.shots[-1].touches
    assert last.places_world == pytest.approx(np.array([contact.place_world for contact in film.run.contacts]))
    slide = film.rows[1]
    on_the_way = film.shots[slide.first_shot : slide.last_shot]
    assert len(on_the_way) == 7
    axis = film.run.scene.cage.shapes[0].pose_body_shape.position_m
    for shot in on_the_way:
        assert shot.touches.points.tolist() == [0, 0]
        between = shot.touches.places_world[:, 1:] - axis[1:]
        assert np.linalg.norm(between, axis=1) == pytest.approx(0.01, abs=1e-6)  # poses between two of a path
        middle = (shot.pose_world_object.position_m[1:] + axis[1:]) / 2.0
        assert shot.touches.places_world[:, 1:] == pytest.approx(np.array([middle] * 2), abs=1e-6)
    heights = [shot.touches.places_world[0, 2] for shot in on_the_way]
    assert all(later < sooner - 1e-5 for sooner, later in pairwise(heights))


def test_what_touches_on_screen_touches_however_much_a_small_gap_is_exaggerated() -> None:
    """A ball 0.05 mm over a table falls on it; at x 100 it falls 5 mm, on a table that is shown as much lower."""
    film = playback(run(ball_on_table(0.01005)))
    stage = Stage(film)
    for times in (1, 10, 100):
        look = Look(0, float(times), stage.cage(-1))
        shift = stage.shifts(look)[0]
        center = stage.pose(film.shots[-1].pose_world_object, look).position_m
        assert shift == pytest.approx([0, 0, -(times - 1) * 5e-5], abs=1e-12)
        assert center[2] - 0.01 == pytest.approx(shift[2], abs=1e-9)
        places = stage.place(film.shots[-1].touches.places_world + shift)
        assert places[0] == pytest.approx(stage.place(center - [0, 0, 0.01]), abs=1e-6)


def test_marks_follow_what_is_seen_where_the_scene_is_much_larger() -> None:
    """The table is twenty times as large as the ball: marks and arrows are those of a scene as large as the picture."""
    stage = Stage(playback(run(ball_on_table())))
    assert stage.size_m < 0.3 * stage.shown.run.scene.size_m
    assert Stage(playback(run(ball_on_points()))).size_m == ball_on_points().size_m


def test_a_form_is_told_once_however_many_shapes_have_it() -> None:
    """A box, two balls and twelve equal rollers are three forms."""
    rollers = [
        Capsule(0.002, 0.01, Pose((0.01 * i, y, -0.012), euler_zyx=(0, 0, np.pi / 2)), f"roller {i} {y}")
        for i in range(-3, 3)
        for y in (-0.02, 0.02)
    ]
    bed = Object(
        [Box((0.08, 0.06, 0.02))],
        shapes=[Sphere(0.003, Pose((x, 0, 0.01)), f"knob {x}") for x in (-0.02, 0.02)],
        center_of_gravity_m=(0, 0, 0), mass_kg=1.0, inertia_kg_m2=np.diag((1e-4, 2e-4, 2e-4)),
    )  # fmt: skip
    film = playback(run(Scene(bed, Cage(shapes=rollers), [WEIGHT])))
    data = page_data(film)
    assert len(data["forms"]) == 3
    assert [part["form"] for part in data["parts"]] == [0, 1, 1]
    assert [body["form"] for body in data["bodies"]] == [2] * 12
    assert len(json.dumps(data["forms"], separators=(",", ":"))) < 1_000


PUCK = """\
name: puck
object:
  shapes: [{sphere: {radius: 10}}]
  center_of_gravity: [0, 0, 0]
  mass: 1
  inertia: [[40, 0, 0], [0, 40, 0], [0, 0, 40]]
  pose: {position: [0, 0, 10.05]}
cage:
  shapes:
    - {box: {size: [200, 200, 10]}, position: [0, 0, -5], name: floor}
    - {capsule: {radius: 3, length: 20}, position: [15, 0, 10], name: pin}
loads: [{name: weight, gravity: [0.2, 0, -1]}]
"""


def test_sliders_move_the_bodies_of_a_cage_and_reach_as_far_as_its_play(tmp_path: Path) -> None:
    """The gaps are 0.05 and 2 mm, so the sliders reach twice 1.025 mm and more."""
    file = tmp_path / "puck.yaml"
    file.write_text(PUCK, encoding="utf-8")
    what_if = WhatIf(read_scene_text(file))
    along_x = next(control for control in what_if.controls if (control.group, control.label) == ("cage", "x"))
    assert (along_x.low, along_x.high) == (-5.0, 5.0)
    for shift in (0.0, 1.5):
        answer = what_if.answer({"cage.pose.position": [shift, 0, 0]})
        (resting,) = {tuple(shot["origin"]) for shot in answer["shots"][-1:]}
        assert resting == pytest.approx((2.0 + shift, 0.0, 10.0), abs=1e-6)
        floor, pin = (np.array(body["position"]) * answer["unitsPerDrawing"] for body in answer["bodies"])
        assert pin - floor == pytest.approx([15.0, 0.0, 15.0])
        assert answer["names"] == ["floor", "pin"]


@pytest.fixture
def opened(watched, tmp_path) -> Callable:
    def open_page(film: Playback):
        file = tmp_path / "run.html"
        file.write_text(page(film), encoding="utf-8")
        watched.page.context.set_offline(True)
        watched.page.goto(file.as_uri())
        wait_until(watched.page, "cagepose.state().drawn > 0")
        return watched.page

    return open_page


@pytest.mark.parametrize("scene", SCENES)
def test_the_page_shows_shapes_and_contacts_where_pictures_do(opened, scene: Callable[[], Scene]) -> None:
    film = playback(run(scene()))
    page = opened(film)
    assert page.locator("#verdict").inner_text() == "rests"
    stage = Stage(film)
    for times in (1, 20):
        set_range(page, "exaggeration", EXAGGERATIONS.index(times))
        wait_until(page, f"cagepose.state().drawnExaggeration === {times}")
        shown = state(page)
        look = stage.look(len(film.shots) - 1, [float(times)] * len(stage.phases))
        touches, cage = film.shots[-1].touches, film.run.scene.cage
        expected = stage.place(touches.places_world + stage.touch_shifts(touches, look))
        assert np.array(shown["touches"]) == pytest.approx(expected, abs=1e-9)
        placed = [cage.pose_world_cage @ shape.pose_body_shape for shape in cage.shapes]
        places = np.array([pose.position_m for pose in placed]).reshape(-1, 3)
        shifts = stage.shifts(look)[len(cage.names) :][: len(places)]
        assert np.array(shown["bodies"]).reshape(-1, 3) == pytest.approx(stage.place(places + shifts), abs=1e-9)
    names = {name["text"] for name in state(page)["written"]}
    assert {contact.point for contact in film.run.contacts} <= names
    lines = page.locator("#forces tr:has(td)").all_inner_texts()
    assert any(f"{contact.point} on {contact.box}" in line for line in lines for contact in film.run.contacts)


def test_a_ball_is_as_fine_as_its_picture_needs_and_no_finer(watched, opened) -> None:
    count_drawing(watched.page)
    page = opened(playback(run(ball_on_table())))
    place = state(page)["shownPose"]["p"]
    triangles = []
    for half in (8.0, 0.8):
        page.evaluate("([place, half]) => cagepose.look(place, [0, -1, 0], half)", [place, half])
        triangles.append(drawn_for_a_picture(page)["triangles"])
    print(f"triangles: {triangles}")
    assert triangles[0] < 600.0
    assert triangles[1] > 1000.0


@pytest.mark.parametrize(
    "around", [{"shapes": [BLOCK], "holes": [Hole(0.005, 0.02, in_=["block"])]}, {"holes": [Hole(0.005, 0.02)]}]
)
def test_the_page_names_a_hole_that_nothing_touches_yet(opened, around: dict) -> None:
    peg = Object(shapes=[Cylinder(0.004, 0.03)], pose=Pose((0.0005, 0.0, 0.005)))
    page = opened(playback(run(Scene(peg, Cage(**around), [Load("push", force=Force((1, 0, 0), (0, 0, 0)))]))))
    set_range(page, "time", 0)
    assert "hole1" in {name["text"] for name in state(page)["written"]}


def test_the_page_has_the_outlines_of_holes_on_both_sides() -> None:
    plate = Object(
        [Box((0.02, 0.02, 0.004), name="plate")],
        holes=[Hole(0.003, 0.004, in_=["plate"], pose_body_shape=Pose((0.0, 0.0, 0.002)))],
        pose=Pose((0.0, 0.0, 0.03)),
    )
    cage = Cage(
        shapes=[Sphere(0.001, Pose((0.0, 0.008, 0.02)))],
        holes=[Hole(0.003, 0.004, pose_body_shape=Pose((0.0, 0.0, -0.01)))],
    )
    film = playback(run(Scene(plate, cage, [WEIGHT])))
    data, stage = page_data(film), Stage(film)
    ((held,), (around,)) = data["holes"], data["cageHoles"]
    assert held["form"] == around["form"]  # of the same kind and size
    assert held["position"] == pytest.approx([0.0, 0.0, 0.002 / stage.size_m], abs=1e-9)
    assert around["position"] == pytest.approx(stage.place(np.array((0.0, 0.0, -0.01))).tolist(), abs=1e-9)
