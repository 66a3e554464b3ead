"""What must not matter to a drive: how it is cut, who moves, bodies that never touch; and that work is not lost."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cagepose import Box, Cage, CageBody, Drive, Load, Pose, Scene, load_scene, run
from cagepose.kernels.quasistatic.run import QuasistaticRules
from cagepose.runs.methods import chosen_method
from cagepose.runs.quasistatic import STEP_LIMIT, TURN_STEP_RAD
from cagepose.runs.solve import run_with
from driven.insertions import HALF, LENGTH, LG, MM, STIFFNESS, Insertion
from our_scenes import SCENES

SMOOTH = Insertion(5.05, 0.4, 0.0, 0.0)
ROUGH = Insertion(5.05, 0.4, 0.0, 0.1)
UPON_TWO = Insertion(5.01, 0.3, math.radians(0.5), 0.0)


def assert_same_pose(found: Pose, expected: Pose, off_m: float = 1e-11) -> None:
    """Of a round peg on springs in its axis, about which nothing turns it or holds it."""
    assert found.position_m == pytest.approx(expected.position_m, abs=off_m)
    assert found.rotation[:, 2] == pytest.approx(expected.rotation[:, 2], abs=off_m / (LENGTH * MM))


def beside(scene: Scene, cage: Cage, drive: dict[str, list[Drive]]) -> Scene:
    """A scene of ours in another cage, of which each phase drives something."""
    loads = [
        Load(
            load.name,
            gravity=load.gravity_world,
            forces=load.forces if load.force is None else (),
            force=load.force,
            moments=load.moments,
            springs=load.springs,
            drive=drive,
        )
        for load in scene.loads
    ]
    return Scene(
        scene.object, cage, loads, friction_coefficient=scene.friction_coefficient, friction_of=scene.friction_of
    )


@pytest.mark.parametrize("name", ["chuck", "gripper", "rail-yaw", "v-groove", "wedge", "phone-dock"])
def test_a_body_that_never_touches_changes_nothing(name: str) -> None:
    """It goes round beside the cage while the loads act; else it stands still there."""
    scene = load_scene(next(path for path in SCENES if path.stem == name))
    far = Pose(np.array([0.0, 4.0 * scene.size_m, 0.0]) + scene.cage.pose_world_cage.inverse().position_m)
    ghost = CageBody("ghost", shapes=[Box(np.full(3, 0.1 * scene.size_m), name="box")], pose=far)
    cage = Cage(
        scene.cage.points_cage if scene.cage.names else (),
        scene.cage.names or None,
        scene.cage.pose_world_cage,
        [*scene.cage.shapes, *scene.cage.holes],
        bodies=[ghost],
    )
    drive = {"ghost": [Drive(travel=(0.01, 0.0, 0.0)), Drive(about=(0, 0, 1), through=far.position_m, angle=0.5)]}
    still, driven = (run(beside(scene, cage, of_load)) for of_load in ({}, drive))
    for expected, found in zip(still.phases, driven.phases, strict=True):
        assert found.verdict == expected.verdict
        assert found.pose.position_m == pytest.approx(expected.pose.position_m, abs=1e-12)
        assert found.pose.rotation == pytest.approx(expected.pose.rotation, abs=1e-11)
        assert [(one.point, one.box) for one in found.contacts] == [(one.point, one.box) for one in expected.contacts]
        assert found.drive is not None
        assert found.drive.share == 1.0
        assert found.drive.work_j == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("insertion", [SMOOTH, ROUGH, UPON_TWO], ids=["smooth", "rough", "two points"])
def test_a_drive_that_is_cut_in_two_phases_is_one(insertion: Insertion) -> None:
    (whole,) = run(insertion.scene(3.0, [LG - 30.0])).phases
    _, second = run(insertion.scene(3.0, [LG - 17.0, LG - 30.0])).phases
    assert_same_pose(second.pose, whole.pose)
    assert whole.drive is not None
    assert second.drive is not None
    assert second.drive.along == pytest.approx(whole.drive.along, rel=1e-9)


@pytest.mark.parametrize("insertion", [SMOOTH, UPON_TWO], ids=["one point", "two points"])
def test_a_drive_there_and_back_without_friction_brings_the_pose_back(insertion: Insertion) -> None:
    first, _, again = run(insertion.scene(3.0, [LG - 4.0, LG - 20.0, LG - 4.0])).phases
    assert_same_pose(again.pose, first.pose)
    assert first.drive is not None
    assert again.drive is not None
    assert again.drive.along == pytest.approx(-first.drive.along, abs=1e-9)


WAYS = {
    "travel": ({"travel": (0.0, 0.0, -0.01)}, {"travel": (0.0, 0.0, 0.01)}),
    "turn": (
        {"about": (0, 1, 0), "through": (0.0, 0.0, -0.01), "angle": 0.004},
        {"about": (0, 1, 0), "through": (0.0, 0.0, -0.01), "angle": -0.004},
    ),
}


@pytest.mark.parametrize(
    ("insertion", "way"),
    [(SMOOTH, "travel"), (ROUGH, "travel"), (SMOOTH, "turn"), (ROUGH, "turn")],
    ids=["smooth travel", "rough travel", "smooth turn", "rough turn"],
)
def test_only_who_moves_against_whom_matters(insertion: Insertion, way: str) -> None:
    """The support is driven over the hole, or the hole the other way below it."""
    scene = insertion.scene(3.0, [LG - 30.0])
    block = CageBody("mate", shapes=[*scene.cage.shapes, *scene.cage.holes])
    cage = Cage(bodies=[block, *scene.cage.bodies])
    ends = []
    for driven, drive in zip(("gripper", "mate"), WAYS[way], strict=True):
        load = Load("drive", springs=scene.loads[0].springs, drive={driven: Drive(**drive)})
        (phase,) = run(Scene(scene.object, cage, [load], friction_coefficient=insertion.friction)).phases
        assert phase.drive is not None
        assert phase.drive.share == 1.0
        seen_from = phase.drive.bodies["mate"].pose_cage_body if driven == "mate" else Pose()
        ends.append((seen_from.inverse() @ phase.pose, phase.drive))
    (pose, one), (other_pose, other) = ends
    assert_same_pose(other_pose, pose, 1e-11 if insertion.friction == 0.0 or way == "travel" else 1e-8)
    assert other.work_j == pytest.approx(one.work_j, rel=1e-9 if insertion.friction == 0.0 else 1e-3)


@pytest.mark.parametrize("insertion", [SMOOTH, UPON_TWO], ids=["one point", "two points"])
def test_without_friction_the_length_of_steps_does_not_matter(insertion: Insertion) -> None:
    scene = insertion.scene(3.0, [LG - 30.0])
    method = chosen_method(scene, None)
    whole, halves = (
        run_with(scene, method, QuasistaticRules(turn, STEP_LIMIT)) for turn in (TURN_STEP_RAD, 0.5 * TURN_STEP_RAD)
    )
    assert_same_pose(halves.pose, whole.pose)


@pytest.mark.parametrize("insertion", [SMOOTH, ROUGH, UPON_TWO], ids=["one point", "rough", "two points"])
def test_work_is_what_springs_have_gained_and_friction_took(insertion: Insertion) -> None:
    settled, deeper = run(insertion.scene(3.0, [LG - 5.0, LG - 30.0])).phases

    def energy(pose: Pose, high: float) -> float:
        ends = [
            (
                pose.transform((0.0, 0.0, (LG - 0.5 * LENGTH + sign * HALF) * MM)),
                np.array([anchor[0], 0.0, anchor[1]]) * MM,
            )
            for sign, anchor in zip((-1.0, 1.0), insertion.anchors(high), strict=True)
        ]
        return 0.25 * STIFFNESS / MM * float(sum(np.sum((one - other) ** 2) for one, other in ends))

    gained = energy(deeper.pose, LG - 30.0) - energy(settled.pose, LG - 5.0)
    assert deeper.drive is not None
    if insertion.friction == 0.0:
        assert deeper.drive.friction_j == 0.0
        assert deeper.drive.work_j == pytest.approx(gained, rel=1e-9, abs=1e-15)
    else:
        assert deeper.drive.work_j == pytest.approx(gained + deeper.drive.friction_j, rel=1e-4)
        assert deeper.drive.friction_j > 0.5 * deeper.drive.work_j
