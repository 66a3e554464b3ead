"""A part that is pushed about in its cage, again and again, never goes through a wall: asked of all poses of its way by
separating axes of pairs of boxes.
"""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from cagepose import Box, Cage, Force, Load, Moment, Object, Pose, Scene, run
from cagepose.studies.play import play
from cagepose.studies.pushes import Freedom, unseated

MM = 1e-3
DEEPEST = 1e-9
"""Metres; the touch tolerance of the scenes is a tenth of this."""


def at(x: float, y: float, z: float) -> Pose:
    return Pose(np.array((x, y, z)) * MM)


def box(size: tuple[float, float, float], *place: float, name: str) -> Box:
    return Box(np.array(size) * MM, at(*place), name)


def battery_door(side: float = 0.2, height: float = 0.1, reach: float = 0.5, stem: float = 1.5) -> Scene:
    """A cover with a tab below a lip on its left and a hook on a stem below another one on its right, with clearances
    to the sides and above; the hook reaches so far below its lip, all in millimetres. It is rolled, then pushed.
    """
    cover = Object(
        [
            box((40, 25, 1.5), 0, 0, -0.75, name="plate"),
            box((4, 5, 1), -21, -8, -1, name="tab"),
            box((stem, 8, 3), 18.5 + stem / 2, 0, -1.5, name="stem"),
            box((reach + 0.7, 8, 1), 19.5 + (reach + 0.7) / 2, 0, -2.5, name="hook"),
        ],
        pose=at(0, 0, height / 2),
        mass_kg=0.003,
    )
    around = [
        box((60, 10, 6), 0, -17.5 - side, -3, name="front"),
        box((60, 10, 6), 0, 17.5 + side, -3, name="back"),
        box((10, 25.4, 0.5 - height), -25 - side, 0, -(0.5 - height) / 2, name="left lip"),
        box((10, 3, 1.5), -25 - side, -12 - side, -0.75, name="front post"),
        box((10, 3, 1.5), -25 - side, 12 + side, -0.75, name="back post"),
        box((10, 25.4, 2 - height), 25 + side, 0, -(2 - height) / 2, name="right lip"),
        box((10, 25.4, 6), 26.5, 0, -4, name="below right"),
        box((30, 2, 3), 0, -11.7, -3, name="front rest"),
        box((30, 2, 3), 0, 11.7, -3, name="back rest"),
    ]
    roll = Load("roll", moments=[Moment((-1, 0, 0), 0.001)])
    push = Load("push", force=Force((1, 0, 0), (0, 0, 0), 1.0))
    return Scene(cover, Cage(shapes=around), [roll, push], name="battery door")


def depth(scene: Scene, pose: Pose) -> float:
    """How deep boxes of the object are in those of the cage, metres: the least shift that parts the deepest two."""
    return max(
        overlap(pose @ part.pose_body_shape, part.size_m, shape.pose_body_shape, shape.size_m)
        for part, shape in itertools.product(scene.object.boxes, scene.cage.shapes)
        if isinstance(shape, Box)
    )


def overlap(pose: Pose, size: np.ndarray, other: Pose, other_size: np.ndarray) -> float:
    mine, its = pose.rotation, other.rotation
    crossed = [np.cross(a, b) for a, b in itertools.product(mine.T, its.T)]
    axes = np.array([*mine.T, *its.T, *(axis for axis in crossed if np.linalg.norm(axis) > 1e-9)])
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    reach = (np.abs(axes @ mine) @ size + np.abs(axes @ its) @ other_size) / 2.0
    return float((reach - np.abs(axes @ (pose.position_m - other.position_m))).min())


FREEDOMS = [
    *(Freedom(np.zeros(3), axis) for axis in np.eye(3)),
    *(Freedom(np.zeros(3), np.zeros(3), angle) for angle in range(3)),
]


def test_a_door_that_turns_flush_with_its_lip_stops_there():
    """Plate and stem come to the lip at once, along a path that is no screw: the step was put where the wrong corner
    touched, a micrometre through the lip, and the next one went on from there, with a proof that it rests.
    """
    scene = battery_door()
    ended = run(scene)
    poses = [
        pose for phase in ended.phases for event in phase.events for pose in (*event.path, event.pose_world_object)
    ]
    assert max(depth(scene, pose) for pose in poses) < DEEPEST
    shorter = run(battery_door(stem=1.4))  # flush with nothing
    assert ended.verdict == shorter.verdict == "rests"
    assert ended.pose.position_m[0] == pytest.approx(shorter.pose.position_m[0], abs=1e-6)


def test_a_door_that_is_pushed_about(cases):
    scene = battery_door()
    pushes, starts = unseated(scene), [scene.object.pose_world_object]
    deepest, n_poses = 0.0, 0
    for number in range(cases(4, 100)):
        for freedom, sign in itertools.product(FREEDOMS, (-1.0, 1.0)):
            pushed = pushes.push(freedom, sign, starts[number])
            assert pushed.verdict != "escapes"
            ways = [pushed.pose_after(step + 1) for step in range(len(pushed.poses))]
            deepest, n_poses = max([deepest, *(depth(scene, pose) for pose in ways)]), n_poses + len(ways)
            if pushed.rests:
                starts.append(pushed.pose)
    print(f"{n_poses} poses of a door that is pushed about, at most {deepest:.1e} m deep")
    assert deepest < DEEPEST


def test_no_end_of_play_lies_beyond_what_is_certified():
    found = play(battery_door())
    assert found.cage is not None
    assert found.cage.verdict == "caged"
    for name, range_ in found.freedoms.items():
        for end, sign in ((range_.low, -1.0), (range_.high, 1.0)):
            assert end.certified is not None
            assert end.reached is not None
            assert sign * end.reached <= sign * end.certified, name
