"""Frames of a driven run lie on the way of its drive, and the cage is where the drive has brought it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cagepose import Pose, Run, run
from cagepose.files.run_file import load_run, save_run
from cagepose.runs.driven_cage import cage_at, cage_at_end, cage_at_start
from cagepose.runs.on_the_way import first_row
from drawn_drives import APART, BLOCKED_AT, LONG, OPENED, SHORT, WAY, jaws, open_between_jaws

ASKEW = Pose((0.1, -0.2, 0.3), euler_zyx=(0.4, 0.0, 0.0))


@pytest.fixture(scope="module")
def closed() -> Run:
    return run(jaws())


def test_the_object_turns_on_the_way_as_the_jaws_leave_it_room(closed: Run) -> None:
    """A rectangle between jaws that are so far apart has one angle."""
    frames = [frame for frame in closed.frames(per_turn=40) if frame.event_index == 2]
    assert len(frames) == 40
    for frame in frames:
        room = APART - 2.0 * WAY * frame.share
        angle = frame.pose_world_object.euler_zyx[0]
        assert open_between_jaws(abs(angle)) == pytest.approx(room, abs=2e-4)  # poses between two of the curve
    on_curve = closed.phases[0].drive
    assert on_curve is not None
    touching = on_curve.curve.share > closed.phases[0].events[1].share
    for share, quaternion in zip(on_curve.curve.share[touching], on_curve.curve.quaternion_wxyz[touching], strict=True):
        angle = 2.0 * math.atan2(quaternion[3], quaternion[0])
        assert open_between_jaws(abs(angle)) == pytest.approx(APART - 2.0 * WAY * share, abs=1e-9)


def test_a_drive_goes_on_evenly_and_events_end_where_they_end(closed: Run) -> None:
    frames = list(closed.frames(per_turn=8))
    assert [(frame.event_index, frame.fraction) for frame in frames[1:]] == [
        (event, step / 8) for event in (1, 2) for step in range(1, 9)
    ]
    assert np.diff([frame.share for frame in frames if frame.event_index == 2], n=2) == pytest.approx(0.0, abs=1e-12)
    for frame in (frames[8], frames[16]):
        event = closed.phases[0].events[frame.event_index]
        assert frame.share == event.share
        assert frame.pose_world_object is event.pose_world_object
    assert frames[-1].share == pytest.approx(BLOCKED_AT, abs=1e-9)
    assert "of the drive" in repr(frames[-1])


def test_each_pose_of_the_paths_of_a_drive_has_its_row_of_the_curve() -> None:
    for phase in run(jaws(turns_after=True)).phases[:2]:
        assert phase.drive is not None
        assert first_row(phase, 0) is None
        places = [first_row(phase, index) for index in range(1, len(phase.events))]
        for first, event in zip(places, phase.events[1:], strict=True):
            assert first is not None
            rows = slice(first + 1, first + 1 + len(event.path))
            assert phase.drive.curve.position_m[rows].tolist() == [pose.position_m.tolist() for pose in event.path]
            assert phase.drive.curve.share[rows][-1] == event.share
        assert len(phase.drive.curve.share) == 1 + sum(len(event.path) for event in phase.events[1:])


@pytest.mark.parametrize("cage_pose", [Pose(), ASKEW])
def test_the_cage_ends_where_its_bodies_were_driven(cage_pose: Pose) -> None:
    """The second phase begins where the first one was blocked, and turns both jaws about the cage's own axis; in the
    third they stand.
    """
    scene = jaws(cage_pose, turns_after=True)
    ended = run(scene)
    assert [phase.verdict for phase in ended.phases] == ["blocked", "rests", "rests"]
    middle = cage_at(ended, 1, 0.0)
    before = cage_at_end(ended, 0)
    for body in (1, 2):
        assert np.array_equal(middle.displaced[body].position_m, before.displaced[body].position_m)
    assert cage_at_end(ended, 2).points_world.tolist() == cage_at_end(ended, 1).points_world.tolist()
    for index, phase in enumerate(ended.phases[:2]):
        assert phase.drive is not None
        at = cage_at_end(ended, index)
        for number, body in enumerate(scene.cage.bodies, start=1):
            told = phase.drive.bodies[body.name].pose_cage_body
            found = cage_pose.inverse() @ at.displaced[number] @ cage_pose @ body.pose_cage_body
            assert found.position_m == pytest.approx(told.position_m, abs=1e-15)
            assert found.quaternion_wxyz == pytest.approx(told.quaternion_wxyz, abs=1e-15)
            assert at.points_world[3 + number] == pytest.approx(cage_pose.transform(told.transform((0, 0, 0.05))))
            assert at.pose_of_shape(number - 1).position_m == pytest.approx(cage_pose.transform(told.position_m))
    gap = np.linalg.norm(
        cage_at_end(ended).pose_of_shape(1).position_m - cage_at_end(ended).pose_of_shape(0).position_m
    )
    assert gap - 0.01 == pytest.approx(SHORT + 2.0 * OPENED, abs=1e-9)
    assert SHORT < LONG
    start = cage_at_start(scene.cage)
    assert start.points_world.tolist() == scene.cage.points_world().tolist()


def test_a_saved_run_has_the_same_frames(closed: Run, tmp_path) -> None:  # type: ignore[no-untyped-def]
    save_run(closed, tmp_path / "jaws.json")
    again = load_run(tmp_path / "jaws.json")
    for one, other in zip(closed.frames(), again.frames(), strict=True):
        assert one.share == other.share
        assert one.pose_world_object.position_m.tolist() == other.pose_world_object.position_m.tolist()
    ends = [cage_at_end(found).points_world.tolist() for found in (closed, again)]
    assert ends[0] == ends[1]
