"""The film of a run: its shots are the run's poses, its contacts and forces those of the mechanics."""

from __future__ import annotations

import itertools
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cagepose import Box, Cage, Force, Load, Object, Pose, Scene, load_scene, run
from cagepose.kernels.outcome.trace import STALLED
from cagepose.runs.driven_cage import cage_at_start
from cagepose.views.viewer import playback as playback_module
from cagepose.views.viewer.page_data import phase_note
from cagepose.views.viewer.playback import SHOWN_OF_ESCAPE, playback
from cagepose.views.viewer.stage import Look, Stage
from cagepose.views.viewer.surface import nearest_on_object

SCENES = Path(__file__).resolve().parents[3] / "scenes"


@pytest.fixture(scope="module")
def rail():
    return run(load_scene(SCENES / "rail-pitch.yaml", ["friction.coefficient=0.1"]))


def drawn_gaps(stage: Stage, pose: Pose, look: Look) -> np.ndarray:
    """Distance of each cage point from the object on screen, as a fraction of the scene's size."""
    points = stage.points(look)
    nearest = nearest_on_object(stage.shown.run.scene.object, stage.pose(pose, look), cage_at_start(Cage(points)))
    gaps = ((points - nearest.feet_world) * nearest.normals_world).sum(axis=1)
    return gaps / stage.size_m


def test_each_event_ends_at_its_pose_and_the_film_is_without_gaps(rail):
    film = playback(rail, shots_per_motion=5)
    events = [event for phase in rail.phases for event in phase.events]
    assert [row.event for row in film.rows] == events
    assert [row.first_shot for row in film.rows] == [1, *(row.last_shot + 1 for row in film.rows[:-1])]
    for row in film.rows:
        assert row.last_shot - row.first_shot == (0 if row.event.motion is None else 4)
        shot = film.shots[row.last_shot]
        assert shot.pose_world_object.position_m.tolist() == row.event.pose_world_object.position_m.tolist()
        assert {rail.scene.cage.names[point] for point in shot.touches.points} == set(row.event.contacts)
    assert [row.verdict for row in film.rows if row.verdict] == ["rests", "rests"]


def test_a_run_of_many_motions_has_fewer_shots_for_each(rail, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(playback_module, "MOST_SHOTS", 35)
    n_events = sum(len(phase.events) for phase in rail.phases)
    film = playback(rail)
    assert film.shots_per_motion == 35 // n_events == 3
    assert len(film.shots) <= 1 + 35


def test_contact_forces_and_load_balance_in_the_last_shot_of_each_phase(rail):
    film = playback(rail)
    for row in film.rows:
        if row.verdict is None:
            continue
        shot = film.shots[row.last_shot]
        total, moment = np.zeros(3), np.zeros(3)
        forces = shot.touches.forces_object @ shot.pose_world_object.rotation.T
        for point, force in zip(shot.touches.points, forces, strict=True):
            total += force
            moment += np.cross(film.points_world[point], force)
        for act in film.loads[row.phase]:
            total += act.direction_at(shot.pose_world_object, shot.cage)
            moment += np.cross(shot.pose_world_object.transform(act.at_object_m), act.direction)
        assert np.abs(total).max() < 2e-6  # beside a push without a mass, the weight of 1e-6 is not drawn
        assert np.abs(moment).max() < 2e-6 * rail.scene.size_m


def test_on_the_way_what_touched_before_and_after_touches_and_its_normal_is_that_of_its_face(rail):
    film = playback(rail)
    for row, before in zip(film.rows[1:], film.rows, strict=False):
        way, end = film.shots[row.first_shot].touches, film.shots[row.last_shot].touches
        if row.phase == before.phase and row.event.motion is not None:
            kept = {film.run.scene.cage.names[point] for point in way.points}
            assert kept == set(before.event.contacts) & set(row.event.contacts)
        for normal in [*way.normals_object, *end.normals_object]:
            assert np.sort(np.abs(normal)) == pytest.approx([0.0, 0.0, 1.0], abs=1e-9)


@pytest.mark.parametrize("method", ["quasistatic", "stepwise"])
def test_an_escape_leaves_the_cage_but_stays_near(method):
    part = Object([Box((0.01, 0.01, 0.01))], pose=Pose((0.0, 0.0, 0.1)))
    scene = Scene(part, Cage([(0.05, 0.0, 0.0), (-0.05, 0.0, 0.0)]), [Load("weight", gravity=(0, 0, -1))])
    escaping = run(scene, method)
    assert escaping.verdict == "escapes"
    film = playback(escaping)
    way = film.shots[-1].pose_world_object.position_m - film.shots[0].pose_world_object.position_m
    assert way == pytest.approx([0.0, 0.0, -SHOWN_OF_ESCAPE * scene.size_m])


@pytest.mark.parametrize("exaggeration", [2, 5, 10])
def test_what_touches_on_screen_is_what_touches_and_gaps_grow_alike(rail, exaggeration):
    """Gaps are right to second order: at 10 times, turns of 6 degrees leave 0.3 % of the scene's size."""
    stage = Stage(playback(rail))
    for row in stage.shown.rows:
        shot = stage.shown.shots[row.last_shot]
        true = drawn_gaps(stage, shot.pose_world_object, Look(0, 1.0, shot.cage))
        shown = drawn_gaps(stage, shot.pose_world_object, Look(0, float(exaggeration), shot.cage))
        assert np.abs(shown - exaggeration * true).max() < 4e-3


def test_exaggeration_turns_about_the_same_axis_and_moves_along_the_same_line():
    part = Object([Box((0.2, 0.02, 0.02))])
    film = playback(run(Scene(part, Cage([(0.0, 0.0, -0.011)]), [Load("weight", gravity=(0, 0, -1))])))
    stage = Stage(replace(film, shots=(film.shots[0],), rows=()))
    moved = Pose((0.001, 0.0, -0.002), euler_zyx=(0.0, 0.01, 0.0))
    cage = film.shots[0].cage
    shown = stage.pose(moved, Look(0, 20.0, cage))
    assert shown.position_m == pytest.approx([0.02, 0.0, -0.04])
    assert shown.euler_zyx == pytest.approx([0.0, 0.2, 0.0])
    assert stage.pose(moved, Look(0, 1.0, cage)) is moved


def test_a_scene_in_millimetres_and_one_in_metres_look_alike():
    text = """
    name: bar
    units: {length: %s}
    object: {boxes: [{size: [100, 10, 10], position: [0, 0, 0]}], pose: {position: [0, 0, 6]}}
    cage: {points: [[-40, 3, 0], [-40, -3, 0], [40, 0, 0]]}
    loads: [{name: weight, gravity: [0, 0, -1]}]
    """
    from cagepose.files.scene_file import parse_scene

    small, large = (Stage(playback(run(parse_scene(text % unit)))) for unit in ("mm", "m"))
    assert small.radius == pytest.approx(large.radius)
    assert small.proposed == large.proposed
    for one, other in zip(small.shown.shots, large.shown.shots, strict=True):
        assert small.place(one.pose_world_object.position_m) == pytest.approx(
            large.place(other.pose_world_object.position_m), abs=1e-9
        )
    points = [stage.place(stage.points(Look(0, 10.0, stage.cage(0)))) for stage in (small, large)]
    assert points[0] == pytest.approx(points[1])


def test_the_exaggeration_proposed_shows_play_and_leaves_long_motions_alone(rail):
    assert min(Stage(playback(rail)).proposed) >= 5
    assert Stage(playback(run(load_scene(SCENES / "sample.yaml")))).proposed == (1,)
    assert Stage(playback(run(load_scene(SCENES / "ladder.yaml")))).proposed == (1,)  # it rests where it starts


def test_a_long_way_into_the_cage_is_shown_as_it_is_and_the_play_behind_it_exaggerated():
    """A peg falls 40 mm upright; then a push tilts it by what little play its four guides leave."""
    peg = Object([Box((0.01, 0.01, 0.06))], pose=Pose((0.0, 0.0, 0.071)), mass_kg=1.0)
    guides = [(x, y, z) for z in (0.01, 0.04) for x, y in ((0.0051, 0), (-0.0051, 0), (0, 0.0051), (0, -0.0051))]
    cage = Cage([*((x, y, 0.0) for x in (0.004, -0.004) for y in (0.004, -0.004)), *guides])
    push = Load("push", gravity=(0, 0, -1), force=Force((1, 0, 0), (0, 0, 0.03), magnitude_n=3.0))
    film = playback(run(Scene(peg, cage, [Load("weight", gravity=(0, 0, -1)), push])))
    stage = Stage(film)
    weight, pushed = stage.phases
    assert (weight.start, weight.proposed) == (film.rows[0].last_shot, 1)
    assert pushed.reference == weight.start
    assert pushed.proposed >= 10
    middle = stage.look(weight.start // 2, stage.proposed)
    assert middle.factor == 1.0
    assert stage.look(pushed.last, stage.proposed)[:2] == (weight.start, pushed.proposed)
    factors = [stage.look(shot, stage.proposed).factor for shot in range(len(film.shots))]
    assert max(abs(one - other) for one, other in itertools.pairwise(factors)) < pushed.proposed / 2


@pytest.mark.parametrize("scene", ["sample", "chuck"])  # a box, and a part without boxes
def test_a_run_without_progress_tells_after_which_event(scene):
    stalled = run(load_scene(SCENES / f"{scene}.yaml"))
    records = stalled.solution.outcome.phases
    records.flags.writeable = True
    records["verdict"][-1] = STALLED  # before anything is read; no scene of ours stalls
    assert stalled.verdict == "stalled"
    film = playback(stalled)
    assert [row.verdict for row in film.rows] == [None] * (len(film.rows) - 1) + ["stalled"]
    assert f"stalled after event {len(film.rows)}: no progress" in phase_note(film, stalled.phases[-1])


@pytest.mark.parametrize("name", ["peg-in-hole", "phone-dock", "plate-on-pins", "tapered-pin", "v-groove"])
def test_what_touches_after_a_motion_touches_on_screen(name):
    stage = Stage(playback(run(load_scene(SCENES / f"{name}.yaml"))))
    for row in stage.shown.rows:
        shot, look = stage.shown.shots[row.last_shot], stage.look(row.last_shot, stage.proposed)
        true = shot.pose_world_object
        on_object = stage.pose(true, look).transform(true.inverse_transform(shot.touches.places_world))
        on_cage = shot.touches.places_world + stage.touch_shifts(shot.touches, look)
        assert np.linalg.norm(on_object - on_cage, axis=1).max() <= 0.04 * stage.size_m


def test_a_fall_to_the_floor_of_a_hole_is_shown_as_it_is_and_the_tilt_in_it_exaggerated():
    stage = Stage(playback(run(load_scene(SCENES / "peg-in-hole.yaml"))))
    fall, *tilts = stage.proposed
    assert fall == 1
    assert min(tilts) >= 10
