"""A `Run` can be replayed: its motions lead from pose to pose exactly, and frames are made of them."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from audit.families import drawn_scenes
from bench.ours import read_run
from cagepose import Box, Cage, Load, Moment, Object, Pose, Scene, SceneError, load_scene, run
from cagepose.kernels.native.kernel import Entry
from cagepose.kernels.outcome.trace import LIMIT, STALLED
from cagepose.model.methods import DEFAULT_FRICTION, DEFAULT_METHOD, METHODS
from cagepose.runs.methods import REGISTRY
from rails import rail_scene


def assert_replays(result):
    for phase in result.phases:
        pose = phase.start_pose
        for event in phase.events:
            if event.motion is not None and np.isfinite(event.motion.distance_m):
                replayed = event.motion.pose_at(pose, 1.0)
                assert_allclose(replayed.position_m, event.pose_world_object.position_m, atol=1e-12)
                assert_allclose(replayed.rotation, event.pose_world_object.rotation, atol=1e-12)
            pose = event.pose_world_object
        assert_allclose(pose.position_m, phase.pose.position_m)


@pytest.mark.parametrize("method", METHODS)
def test_motions_lead_from_each_pose_to_the_next(method):
    assert_replays(run(rail_scene(pitch_deg=0.1), method))
    for scene in drawn_scenes("union", 30, seed=3):
        assert_replays(run(scene, method))


@pytest.mark.parametrize("method", METHODS)
def test_a_run_is_one_native_call_whatever_is_read_of_it(monkeypatch, method):
    called, until = list[str](), Entry.until

    def note(entry, *given):
        called.append(entry.name)
        return until(entry, *given)

    scene = rail_scene(pitch_deg=0.1)
    monkeypatch.setattr(Entry, "until", note)
    read_run(scene, method)
    assert called == [f"run_{method}"]


@pytest.mark.parametrize(
    ("verdict", "says"),
    [(STALLED, "no step was found that keeps the contacts of C2, C4, "), (LIMIT, "it still moved after 3000")],
)
def test_a_failed_run_says_why_and_what_it_left_out(verdict, says):
    """Such runs are made, by another code than the kernel wrote, before anything is read: no scene of ours fails."""
    solution = run(rail_scene(pitch_deg=0.1)).solution
    solution.outcome = solution.outcome._replace(phases=solution.outcome.phases[:1].copy())
    solution.outcome.phases["verdict"] = verdict
    failed = solution.run(0.0)
    why, left_out = [warning for warning in failed.warnings if "edge" not in warning][:2]
    assert failed.verdict in ("stalled", "limit")
    assert says in why
    assert "change the friction coefficient" in why
    assert left_out == "weight: the run failed here, so not run: push"


def test_each_phase_starts_where_the_one_before_ended():
    gravity, push = run(rail_scene(pitch_deg=0.1)).phases
    assert push.start_pose is gravity.pose


@pytest.mark.parametrize("method", METHODS)
def test_a_turn_or_screw_has_ten_frames_and_a_travel_one(method):
    result = run(rail_scene(pitch_deg=0.1), method)
    motions = [event.motion for phase in result.phases for event in phase.events if event.motion is not None]
    n_travels = sum(motion.kind == "travel" for motion in motions)
    frames = list(result.frames(per_turn=10))
    assert len(frames) == 1 + 10 * (len(motions) - n_travels) + n_travels
    assert_allclose(frames[-1].pose_world_object.position_m, result.pose.position_m)


def test_frames_of_a_turn_are_evenly_spaced():
    result = run(rail_scene(pitch_deg=0.1))
    turn = [frame for frame in result.frames(4) if (frame.phase_index, frame.event_index) == (0, 1)]
    angles = [np.degrees(frame.pose_world_object.euler_zyx[1]) for frame in turn]
    assert [frame.fraction for frame in turn] == [0.25, 0.5, 0.75, 1.0]
    assert_allclose(np.diff([0.1, *angles]), np.full(4, 0.313084 / 4), atol=1e-6)


def test_frames_of_a_bent_way_lie_on_it():
    """The sample's corner slides on C1 while the cube turns by 34 deg: one turn to the end would be 0.6 mm off."""
    result = run(load_scene("scenes/sample.yaml"), "quasistatic")
    (before, bent) = result.phases[0].events[:2]
    assert len(bent.path) > 20
    frames = [frame.pose_world_object for frame in result.frames(len(bent.path)) if frame.event_index == 1]
    for frame, pose in zip(frames, bent.path, strict=True):
        assert_allclose(frame.position_m, pose.position_m, atol=1e-12)
        assert_allclose(frame.rotation, pose.rotation, atol=1e-12)
    straight = bent.motion.pose_at(before.pose_world_object, 0.5).position_m
    half_way = bent.path[len(bent.path) // 2 - 1].position_m
    assert np.linalg.norm(straight - half_way) > 5e-4


def test_fewer_than_one_frame_for_a_turn_is_refused():
    with pytest.raises(ValueError, match="per_turn is 0"):
        next(run(rail_scene()).frames(0))


def test_an_endless_travel_has_no_poses_on_its_way():
    scene = Scene(Object([Box((1, 1, 1))]), Cage([(0, 0, 9)]), [Load("gravity", gravity=(0, 0, -1))])
    result = run(scene, "stepwise")
    motion = result.phases[0].events[0].motion
    with pytest.raises(ValueError, match="no end"):
        motion.pose_at(result.pose, 0.5)
    assert [frame.event_index for frame in result.frames()] == [-1, 0]


def test_an_unknown_method_is_refused_with_the_known_ones():
    with pytest.raises(SceneError, match="use one of: stepwise, quasistatic"):
        run(rail_scene(), method="magic")


def test_what_runs_a_method_is_registered_for_each_name():
    assert tuple(REGISTRY) == METHODS == tuple(DEFAULT_FRICTION)
    assert DEFAULT_METHOD in METHODS


@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.parametrize("stop_deg", [20.0, 100.0, 179.0, 186.8, 200.0, 331.93, 353.0])
def test_a_turn_keeps_its_angle_and_its_axis_however_far_it_goes(sense, stop_deg):
    """Hand answer: a bar, 2 mm to either side of its middle, meets a point at r = 17 mm when asin(2 / 17) is left."""
    around = sense * np.radians(stop_deg)
    held = Object(
        [Box((0.04, 0.004, 0.004), Pose((0.02, 0.0, 0.0)))], (0.0, 0.0, 0.0), inertia_kg_m2=np.eye(3), mass_kg=1.0
    )
    turning = Load("turn", moments=[Moment((0.0, 0.0, sense), 1.0)])
    scene = Scene(held, Cage([0.017 * np.array([np.cos(around), np.sin(around), 0.0])]), [turning])
    first = run(scene).phases[0].events[0]
    assert first.motion.kind == "turn"
    assert first.motion.angle_rad == pytest.approx(abs(around) - np.arcsin(2.0 / 17.0), abs=1e-9)
    assert first.motion.axis_world == pytest.approx([0.0, 0.0, sense], abs=1e-12)
