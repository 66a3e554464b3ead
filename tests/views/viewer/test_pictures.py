"""Pictures and films of runs, drawn without a display."""

from __future__ import annotations

import io
from pathlib import Path

import av
import numpy as np
import pytest
from PIL import Image, ImageDraw

from cagepose import Cage, Cylinder, Force, Hole, Load, Object, Pose, Scene, load_scene, run
from cagepose.files.write import MADE_BY
from cagepose.views.viewer.caption import MARK
from cagepose.views.viewer.film import (
    END_MS,
    FILM_SIZE,
    PAUSE_MS,
    SHOT_MS,
    SHOTS_PER_MOTION,
    gif_bytes,
    mp4_bytes,
    png_bytes,
)
from cagepose.views.viewer.look import FEW_NAMES, PAPER, ink
from cagepose.views.viewer.picture import SIZE, PictureMaker
from cagepose.views.viewer.playback import playback
from cagepose.views.viewer.raster import Raster
from cagepose.views.viewer.stage import Stage
from marks_left_out import is_marked, without_marks
from our_scenes import SCENES as OUR_SCENES

SCENES = Path(__file__).resolve().parents[3] / "scenes"


def pixel(raster: Raster, x: int, y: int) -> list[float]:
    return (raster.colors[y, x] / 255.0).tolist()


def test_a_rest_that_is_unstable_is_called_so_above_its_picture(monkeypatch):
    rail = load_scene(SCENES / "rail-pitch.yaml")
    found = run(Scene(rail.object, rail.cage, rail.loads[:1]))
    assert found.phases[-1].proof.stability == "unstable"
    words, write = [], ImageDraw.ImageDraw.text

    def noted(pen, place, text, *rest, **told):
        words.append(text)
        write(pen, place, text, *rest, **told)

    monkeypatch.setattr(ImageDraw.ImageDraw, "text", noted)
    shown = playback(found)
    PictureMaker(Stage(shown)).picture(shown.shots[-1])
    assert "rests, unstable" in words


def test_what_is_nearer_covers_what_is_farther_in_whatever_order_it_is_drawn():
    for order in ((1, -1), (-1, 1)):
        raster = Raster(40, 40)
        for side in order:
            height = 10.0 * side
            color = np.array((255.0, 0.0, 0.0) if side > 0 else (0.0, 255.0, 0.0))
            raster.ball(np.array([20.0, 20.0, height]), 5.0, color)
        red, green, blue = pixel(raster, 20, 20)
        assert red > 3.0 * green  # what is behind is faint
        assert blue == 0.0
        assert pixel(raster, 2, 2) == pytest.approx(ink(PAPER) / 255.0, abs=1.0 / 255.0)


def test_a_face_tints_what_is_behind_it_and_not_what_is_before():
    raster = Raster(40, 40)
    raster.ball(np.array([10.0, 20.0, -10.0]), 4.0, np.zeros(3))
    raster.ball(np.array([30.0, 20.0, 10.0]), 4.0, np.zeros(3))
    square = np.array([[0.0, 10.0, 0.0], [39.0, 10.0, 0.0], [39.0, 30.0, 0.0], [0.0, 30.0, 0.0]])
    raster.face(square, np.full(3, 255.0), 0.25)
    assert pixel(raster, 10, 20) == pytest.approx([0.25] * 3, abs=0.5 / 255.0)
    assert pixel(raster, 30, 20) == [0.0] * 3


def test_a_slanted_line_is_covered_where_it_passes_behind():
    raster = Raster(60, 20)
    raster.ball(np.array([30.0, 10.0, 0.0]), 6.0, np.full(3, 255.0))
    line = np.array([[5.0, 10.0, 20.0], [55.0, 10.0, -30.0]])
    raster.lines(line[:1], line[1:], np.zeros(3))
    assert pixel(raster, 10, 10) == [0.0] * 3
    assert pixel(raster, 50, 10) == [0.0] * 3
    assert min(pixel(raster, 33, 10)) > 0.5


def test_contacts_are_drawn_where_they_are_and_everything_fits():
    """Those behind the cube as well."""
    shown = playback(run(load_scene(SCENES / "sample.yaml"), "stepwise"))
    maker, last = PictureMaker(Stage(shown)), shown.shots[-1]
    pictures = maker.picture(last), without_marks(maker)
    places = maker.seen_at(maker.stage.place(shown.points_world))
    assert ((places > 0.0) & (places < SIZE)).all()
    touching = set(last.touches.points.tolist())
    assert [is_marked(pictures, place) for place in places] == [index in touching for index in range(len(places))]


@pytest.mark.parametrize(("name", "is_magnified"), [("wedge", False), ("rollers", True)])
def test_a_picture_is_marked_as_exaggerated_only_where_something_is(name: str, is_magnified: bool) -> None:
    """The wedge stands where it starts, and all of its cage touches it."""
    shown = playback(run(load_scene(SCENES / f"{name}.yaml")), shots_per_motion=2)
    picture = np.asarray(PictureMaker(Stage(shown), [200] * len(shown.run.phases)).picture(shown.shots[-1]))
    assert (picture[-28, 12] == ink(MARK)).all() == is_magnified


def test_a_picture_of_any_scene_is_ours_and_the_same_each_time():
    for scene in ("ladder", "wedge", "v-groove"):
        shown = playback(run(load_scene(SCENES / f"{scene}.yaml")))
        content = png_bytes(shown)
        assert MADE_BY.encode() in content
        with Image.open(io.BytesIO(content)) as picture:
            assert picture.size == SIZE
    assert png_bytes(shown) == content


@pytest.mark.parametrize("path", OUR_SCENES, ids=[path.stem for path in OUR_SCENES])
def test_the_start_of_any_scene_can_be_drawn(path: Path):
    """Where most of the cage touches nothing yet, and has its names all the same."""
    shown = playback(run(load_scene(path)))
    maker = PictureMaker(Stage(shown))
    maker.picture(shown.shots[0])
    names = set(shown.run.scene.cage.element_names)
    assert len(names) > FEW_NAMES or names <= {label.text for label in maker.labels}


def test_a_hole_that_stands_alone_is_drawn_and_has_its_name_at_its_mouth():
    peg = Object(shapes=[Cylinder(0.004, 0.03)], pose=Pose((0.0005, 0.0, 0.005)))
    cage = Cage(holes=[Hole(0.005, 0.02)], pose=Pose((0.0, 0.0, 0.001)))
    shown = playback(run(Scene(peg, cage, [Load("push", force=Force((1, 0, 0), (0, 0, 0)))])))
    maker = PictureMaker(Stage(shown), [1])
    picture = np.asarray(maker.picture(shown.shots[0]), dtype=float)
    assert "hole1" in [label.text for label in maker.labels]
    assert maker.stage.middles_world.tolist() == [[0.0, 0.0, 0.001]]
    turns = np.linspace(0.0, 2.0 * np.pi, 32, endpoint=False)
    bottom = np.column_stack([0.005 * np.cos(turns), 0.005 * np.sin(turns), np.full(32, -0.019)])  # the peg is above
    places = maker.seen_at(maker.stage.place(bottom)).astype(int)
    assert ((places > 0) & (places < SIZE)).all()
    around = [picture[y - 2 : y + 3, x - 2 : x + 3] for x, y in places.tolist()]
    assert sum(bool((patch < 200.0).any()) for patch in around) >= 14  # of the half that is in front


def test_a_film_has_all_shots_rests_where_events_end_and_does_not_stand_still():
    answer = run(load_scene(SCENES / "slope.yaml"))
    shown = playback(answer, "mm", SHOTS_PER_MOTION)
    with Image.open(io.BytesIO(gif_bytes(answer, "mm"))) as film:
        total = 0
        last, n_changes = None, 0
        for index in range(film.n_frames):
            film.seek(index)
            total += film.info["duration"]
            now = np.asarray(film.convert("RGB"))
            n_changes += last is not None and bool((now != last).any())
            last = now
        assert film.info["comment"] == MADE_BY.encode()
    assert n_changes >= SHOTS_PER_MOTION
    assert total > END_MS + 80 * (len(shown.shots) - 1)


def test_a_video_shows_the_pictures_of_the_run_for_as_long_as_they_stand():
    answer = run(load_scene(SCENES / "slope.yaml"))
    shown = playback(answer, "mm", SHOTS_PER_MOTION)
    maker = PictureMaker(Stage(shown), size=FILM_SIZE)
    with av.open(io.BytesIO(mp4_bytes(answer, "mm"))) as file:
        assert file.metadata["comment"] == MADE_BY
        assert file.streams.video[0].codec_context.name == "h264"
        frames = [(frame.time, frame.to_ndarray(format="rgb24").astype(float)) for frame in file.decode(video=0)]
    ended_ms = PAUSE_MS * (1 + sum(row.last_shot < len(shown.shots) - 1 for row in shown.rows))
    on_the_way_ms = SHOT_MS * (len(shown.shots) - 2 - sum(row.last_shot < len(shown.shots) - 1 for row in shown.rows))
    assert frames[-1][0] * 1000.0 + SHOT_MS == pytest.approx(ended_ms + on_the_way_ms + END_MS)
    pictures = [np.asarray(maker.picture(shown.shots[index]), dtype=float) for index in (0, -1)]
    for (_, frame), picture, other in zip((frames[0], frames[-1]), pictures, pictures[::-1], strict=True):
        assert np.abs(frame - picture).mean() < 3.0 < np.abs(frame - other).mean()
