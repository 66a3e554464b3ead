"""Bodies that are driven are drawn where they are then: in pictures, on the page, and what rides on them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cagepose import Pose, Run, load_scene, run
from cagepose.runs.driven_cage import cage_at_end, cage_at_start
from cagepose.studies.touching import TouchFinder
from cagepose.views.drive_words import drive_data, how_far
from cagepose.views.event_figure import event_figure
from cagepose.views.pose_figure import pose_figure
from cagepose.views.viewer.look import PAINT, ink
from cagepose.views.viewer.page import page
from cagepose.views.viewer.page_data import page_data, phase_note
from cagepose.views.viewer.picture import PictureMaker
from cagepose.views.viewer.playback import MOTIONS_PER_DRIVE, playback
from cagepose.views.viewer.stage import Look, Stage
from drawn_drives import APART, BLOCKED_AT, WAY, jaws, pulled
from driving import state, wait_until


@pytest.fixture(scope="module")
def closed() -> Run:
    return run(jaws())


@pytest.fixture(scope="module")
def turned() -> Run:
    return run(jaws(Pose((0.1, 0.2, 0.3)), turns_after=True))


def test_a_film_follows_the_drive_at_one_speed(closed: Run) -> None:
    film = playback(closed, shots_per_motion=12)
    shares = [shot.share for shot in film.shots]
    steps = np.diff(shares)
    assert (steps >= 0.0).all()
    assert steps[1:].max() <= 1.0 / (12 * MOTIONS_PER_DRIVE) + 1e-9
    for shot in film.shots:
        for number, sign in ((1, 1.0), (2, -1.0)):
            assert shot.cage.displaced[number].position_m == pytest.approx([sign * WAY * shot.share, 0, 0], abs=1e-12)
    assert shares[-1] == pytest.approx(BLOCKED_AT, abs=1e-9)
    assert film.shots[0].along is None
    assert film.shots[-1].along == pytest.approx(0.0, abs=1e-9)


def test_contacts_lie_on_the_bodies_where_they_are(closed: Run) -> None:
    film = playback(closed, shots_per_motion=6)
    names, seen = closed.scene.cage.element_names, 0
    for shot in film.shots:
        for point, place in zip(shot.touches.points.tolist(), shot.touches.places_world, strict=True):
            if names[point].endswith("pad"):
                seen += 1
                assert abs(place[0]) == pytest.approx(APART / 2 - WAY * shot.share, abs=2e-4)
    assert seen > 20


def test_a_drive_is_shown_as_it_is_and_phases_behind_it_start_from_its_end(turned: Run) -> None:
    stage = Stage(playback(turned))
    close, turn, weigh = stage.phases
    assert close.start == close.last
    assert turn.reference == weigh.reference == turn.last
    for shot in (close.last, turn.last):
        assert stage.look(shot, [50, 50]).factor == 1.0
    gaps = stage.gaps_world(close.last)  # what touches after the drive has no gap there
    solid = [index for index, name in enumerate(turned.scene.cage.element_names) if name.endswith("pad")]
    assert np.abs(gaps[solid]).max() < 1e-6


def test_a_body_far_off_moves_as_one_and_stays_in_the_picture(closed: Run) -> None:
    stage = Stage(playback(closed))
    look = Look(0, 200.0, stage.cage(0))
    shifts = stage.shifts(look)
    names = closed.scene.cage.element_names
    for body in (1, 2):
        own = shifts[[index for index, of in enumerate(closed.scene.cage.element_bodies) if of == body]]
        assert len(own) == 2
        assert np.array_equal(own[0], own[1])
        assert np.linalg.norm(own[0]) < 0.15 * stage.size_m
    assert len(names) == 8


def color_at(maker: PictureMaker, pixels: np.ndarray, place_world: np.ndarray) -> np.ndarray:
    x, y = maker.seen_at(maker.stage.place(place_world)).astype(int).tolist()
    return pixels[y - 2 : y + 3, x - 2 : x + 3].reshape(-1, 3).mean(axis=0)


@pytest.mark.parametrize("share", [0.0, BLOCKED_AT])
def test_a_picture_shows_bodies_where_they_are(closed: Run, share: float) -> None:
    """The upper face of a jaw is painted in the colour of the cage there, and where it is at other times it is not."""
    film = playback(closed)
    shot = min(film.shots, key=lambda shot: abs(shot.share - share))
    maker = PictureMaker(Stage(film), [1])
    pixels = np.asarray(maker.picture(shot, is_captioned=False), dtype=float)
    top = np.array([0.0, 0.035, 0.02])

    def place(way_m: float) -> np.ndarray:
        return np.array([APART / 2 + 0.005 - way_m, 0.0, 0.025]) + top

    paper = np.array([246.0, 247.0, 249.0])
    here = color_at(maker, pixels, place(WAY * shot.share))
    elsewhere = color_at(maker, pixels, place(0.0 if share else WAY * BLOCKED_AT))
    assert np.abs(here - ink(PAINT["cage"])).max() < 70.0
    assert np.abs(here - paper).max() > 30.0
    assert np.abs(here - elsewhere).max() > 15.0
    poses = maker._cage_poses()
    assert poses[1].position_m[0] == pytest.approx(APART / 2 + 0.005 - WAY * shot.share, abs=1e-9)


def test_the_end_of_a_spring_rides_on_its_body() -> None:
    film = playback(run(pulled()))
    (weight, spring) = film.loads[0]
    assert (weight.kind, spring.kind, spring.body) == ("weight", "spring", 1)
    for shot in (film.shots[0], film.shots[len(film.shots) // 2], film.shots[-1]):
        assert spring.end_world(shot.cage) == pytest.approx([0.06 + 0.05 * shot.share, 0.0, 0.01])
    assert film.shots[-1].share == 1.0
    maker = PictureMaker(Stage(film))
    maker.picture(film.shots[-1])
    at, end = maker._ends(spring, film.shots[-1], film.shots[-1].pose_world_object, maker.now)
    way = maker.stage.place(np.array([0.11, 0.0, 0.01])) - maker.stage.place(
        film.shots[-1].pose_world_object.transform((0.01, 0, 0))
    )
    assert end - at == pytest.approx(way)
    with pytest.raises(ValueError, match="weight is no spring"):
        weight.end_world(film.shots[0].cage)


def test_figures_show_bodies_where_they_are(turned: Run) -> None:
    """Each view along the weight has the outline of the right jaw where the phase left it."""
    figure = event_figure(turned)
    titles = [panel.get_title() for panel in figure.axes]
    assert any("83.33 % of the drive" in title for title in titles)
    views = [panel for panel in figure.axes if panel.get_title().startswith("end of")]
    assert len(views) == 1  # of the phase without a drive
    for index, panel in zip((2,), views, strict=True):
        corners = (
            cage_at_end(turned, index)
            .pose_of_shape(1)
            .transform(np.array([(x, y, 0) for x in (-0.005, 0.005) for y in (-0.05, 0.05)]))
        )
        outlines = [patch.get_xy() for patch in panel.patches]
        assert any(
            all(np.abs(outline - 1e3 * corner[:2]).max(axis=1).min() < 1e-6 for corner in corners)
            for outline in outlines
        )
    steps = pose_figure(turned).axes[0].lines[0].get_xdata()
    assert len(steps) == 1 + 4 * 10


def test_words_tell_how_far_a_drive_got_and_why_it_went_no_farther(closed: Run, turned: Run) -> None:
    film = playback(closed)
    assert phase_note(film, closed.phases[0]) == (
        "close: blocked at 83.33 % of the drive (left by 25 mm; right by 25 mm):"
        " no motion of the object makes way for the drive, with any friction"
    )
    rows = page_data(film)["rows"]
    assert [row["drive"] for row in rows] == ["", "to 44.17 % of the drive", "to 83.33 % of the drive"]
    assert how_far(turned.phases[1], "mm") == " at 100 % of the drive (left by 10 mm, 5 deg; right by 10 mm, 5 deg)"
    assert how_far(turned.phases[2], "mm") == ""
    assert how_far(replace(turned.phases[0], drive=None), "mm") == " at the start of the drive"
    units = [drive_data(turned, phase, "mm") for phase in (0, 1)]
    assert [found and found["unit"] for found in units] == ["N", "N"]


def test_the_page_plays_a_drive_as_pictures_show_it(watched, tmp_path: Path) -> None:
    """Bodies, contacts and the force go along with the time, between two shots as well."""
    ended = run(jaws(Pose((0.1, 0.2, 0.3)), turns_after=True))
    film = playback(ended)
    stage = Stage(film)
    maker = PictureMaker(stage)
    file = tmp_path / "run.html"
    file.write_text(page(film), encoding="utf-8")
    tab = watched.page
    tab.goto(file.as_uri())
    wait_until(tab, "cagepose.state().drawn > 0")

    def at(time: float) -> dict[str, object]:
        tab.locator("#time").evaluate(
            "(bar, time) => { bar.value = time; bar.dispatchEvent(new Event('input')); }", time
        )
        wait_until(tab, f"cagepose.state().drawnTime === {time}")
        found: dict[str, object] = state(tab)
        return found

    for index in (0, 1, 20, film.rows[2].last_shot, film.rows[3].last_shot + 30, len(film.shots) - 1):
        shot, shown = film.shots[index], at(index)
        maker.picture(shot)
        poses = [stage.place(pose.position_m) for pose in maker._cage_poses()]
        assert np.array(shown["bodies"]) == pytest.approx(np.array(poses), abs=1e-9)
        assert np.array(shown["points"]) == pytest.approx(stage.place(stage.points(maker.now)), abs=1e-9)
        assert np.array(shown["touches"]).reshape(-1, 3) == pytest.approx(maker.places(shot), abs=1e-9)
        drive = shown["drive"]
        assert (drive is None) == (shot.along is None)
        if isinstance(drive, dict):
            assert drive["share"] == shot.share
    one, other, between = (at(time) for time in (20, 21, 20.5))
    assert np.array(between["bodies"]) == pytest.approx((np.array(one["bodies"]) + np.array(other["bodies"])) / 2.0)
    assert not np.allclose(one["bodies"], other["bodies"], atol=1e-6)
    assert tab.locator("#drive").is_visible()
    assert (
        tab.locator("#driven")
        .inner_text()
        .startswith(f"{100 * (film.shots[20].share + film.shots[21].share) / 2:.1f} %")
    )
    assert "blocked" in tab.locator("#notes").inner_text()


def test_a_run_without_drives_has_no_force_curve(watched, tmp_path: Path) -> None:
    scene = load_scene(Path(__file__).resolve().parents[3] / "scenes" / "drawer.yaml")
    file = tmp_path / "run.html"
    file.write_text(page(playback(run(scene))), encoding="utf-8")
    tab = watched.page
    tab.goto(file.as_uri())
    wait_until(tab, "cagepose.state().drawn > 0")
    assert not tab.locator("#drive").is_visible()
    assert state(tab)["drive"] is None


def test_the_force_curve_takes_to_the_time_of_a_share(watched, tmp_path: Path, closed: Run) -> None:
    film = playback(closed)
    file = tmp_path / "run.html"
    file.write_text(page(film), encoding="utf-8")
    tab = watched.page
    tab.goto(file.as_uri())
    wait_until(tab, "cagepose.state().drawn > 0")
    box = tab.locator("#force").bounding_box()
    assert box is not None
    drawn = state(tab)["drawn"]
    tab.locator("#force").click(position={"x": 56 + 0.3 * (box["width"] - 64), "y": box["height"] / 2})
    wait_until(tab, f"cagepose.state().drawn > {drawn}")
    assert state(tab)["drive"]["share"] == pytest.approx(0.3, abs=5e-3)


def test_what_touches_is_found_where_bodies_are(closed: Run) -> None:
    """Each jaw touches at all four corners of the block's side, and at the start nowhere."""
    finder, names = TouchFinder(closed.scene), closed.scene.cage.element_names
    for at, n_places in ((cage_at_end(closed), 4), (cage_at_start(closed.scene.cage), 0), (cage_at_end(closed), 4)):
        found = [names[element] for element in finder.at(closed.pose, at).elements.tolist()]
        assert [found.count(name) for name in ("left pad", "right pad")] == [n_places, n_places]
