"""What a scene in the plane says, refuses and keeps: files, saved runs, questions, MuJoCo."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cagepose import (
    Box,
    Cage,
    CageBody,
    Drive,
    Force,
    Load,
    Object,
    Pose,
    Scene,
    SceneError,
    Unanswered,
    Variation,
    certificate,
    check_certificate,
    load_run,
    load_scene,
    margin,
    run,
    run_many,
    save_run,
    save_scene,
    tipping,
)
from cagepose.exchange.crosscheck import crosscheck
from cagepose.exchange.export import exported
from cagepose.exchange.imported import imported
from planar.floor_and_lid import drawn_pair

WEIGHT = Load("weight", gravity=(0.0, 0.0, -9.81))


def block(planar: str | None = "xz", **others: object) -> Scene:
    plate = Object([Box((0.04, 0.02, 0.02))], pose=Pose((0.0, 0.0, 0.011)), mass_kg=1.0)
    return Scene(plate, Cage([(-0.01, 0.0, 0.0), (0.01, 0.0, 0.0)]), [WEIGHT], planar=planar, **others)


def test_files_and_saved_runs_keep_the_plane_and_its_proof_is_checked(tmp_path: Path):
    scene = drawn_pair(19, 0.3).planar
    save_scene(scene, tmp_path / "scene.yaml")
    assert "planar: xz" in (tmp_path / "scene.yaml").read_text()
    done = run(load_scene(tmp_path / "scene.yaml"))
    assert done.verdict == "rests"
    assert done.phases[-1].proof.reason.endswith("only motions in the plane xz are asked about")
    save_run(done, tmp_path / "run.json")
    again = load_run(tmp_path / "run.json")
    assert again.scene.planar == "xz"
    for phase in range(2):
        checked = check_certificate(certificate(again, phase), again, phase)
        assert checked.uniqueness == "strong"
        assert checked.residual < 1e-12


def test_the_freedoms_that_a_load_leaves_are_those_of_the_plane():
    assert run(block()).phases[0].proof.undetermined == ("x",)
    fallen = run(block("xy")).phases[0]
    assert (fallen.verdict, fallen.proof.undetermined) == ("rests", ("x", "y", "yaw"))
    (warning,) = run(block("xy")).warnings
    assert warning == "weight: of its force of 9.81, -9.81 acts along z, which the plane xy carries without friction"


def test_what_acts_across_the_plane_changes_nothing_and_is_told():
    scene = block(friction_coefficient=0.3)
    pushed = Load(
        "weight", gravity=(0.0, 0.0, -9.81), force=Force((0.0, 1.0, 0.0), (0.01, 0.0, 0.005), magnitude_n=7.0)
    )
    one, other = run(scene), run(scene.but_for(loads=[pushed]))
    assert [contact.force_normal_n for contact in one.contacts] == [
        contact.force_normal_n for contact in other.contacts
    ]
    assert other.pose.key == one.pose.key
    (warning,) = other.warnings
    assert "7 acts along y" in warning


def test_a_wall_that_the_part_slides_along_across_the_plane_counts_for_nothing():
    beside = Box((1.0, 0.02, 1.0), Pose((0.0, 0.02, 0.0)), "beside")
    scene = block(friction_coefficient=0.5)
    walled = scene.but_for(cage=Cage(scene.cage.points_cage, shapes=[beside]))
    assert [contact.point for contact in run(walled).contacts] == ["C1", "C2"]
    push = Load("push", gravity=(0.0, 0.0, -9.81), force=Force((1.0, 0.0, 0.0), (0.0, 0.0, -0.01), magnitude_n=6.0))
    ends = [run(one.but_for(loads=[push])) for one in (scene, walled)]
    assert ends[0].verdict == ends[1].verdict == "escapes"


def test_margins_and_tipping_are_those_between_a_floor_and_a_lid():
    pair = drawn_pair(19, 0.3)
    ours, theirs = (margin(run(scene)) for scene in pair)
    assert ours is not None
    assert theirs is not None
    assert ours.force_n == pytest.approx(theirs.force_n, rel=1e-9)
    assert ours.moment_nm == pytest.approx(theirs.moment_nm, rel=1e-9)
    push = Force((1.0, 0.5, 0.0), (0.0, 0.0, 0.0))
    one, other = (tipping(run(scene), push) for scene in pair)
    assert not isinstance(one, Unanswered)
    assert not isinstance(other, Unanswered)
    assert one.force_n == pytest.approx(other.force_n, rel=1e-9)


@pytest.mark.parametrize(
    ("scene", "says"),
    [
        (lambda: block("zx"), "planar: is 'zx'; use one of: xy, xz, yz"),
        (
            lambda: block().changed("cage.pose.euler_zyx_deg", [0, 0, 3.0]),
            "cage.pose: tilts the cage by 3 degrees out of the plane xz; turn it about y alone",
        ),
        (lambda: run(block(), "stepwise"), "planar: the stepwise method has all six freedoms"),
        (
            lambda: Scene(
                block().object,
                Cage([(-0.01, 0, 0), (0.01, 0, 0)], bodies=[CageBody("mate", [(0.1, 0, 0.01)])]),
                [Load("drive", drive={"mate": Drive((-0.01, 0, 0))})],
                planar="xz",
            ),
            "loads[0].drive: 'drive' drives a body, which is not known in a plane; leave planar out",
        ),
        (
            lambda: run_many(block(), Variation(cage_euler_zyx=np.array([[0, 0.1, 0], [0, 0.2, 0.1]]))),
            "cage_euler_zyx: tilts the cage out of the plane xz in row 1",
        ),
    ],
    ids=["no plane", "tilted cage", "stepwise", "driven", "tilted rows"],
)
def test_what_is_not_known_in_a_plane_is_refused(scene, says):
    with pytest.raises(SceneError) as raised:
        scene()
    assert says in str(raised.value)


def ladder(friction: float) -> Scene:
    start = Pose((-0.055, 0.0, 0.1002), euler_zyx=(0.0, -np.radians(62.0), 0.0))
    walls = [
        Box((1.0, 0.5, 0.1), Pose((0.0, 0.0, -0.05)), "floor"),
        Box((0.1, 0.5, 1.0), Pose((0.05, 0.0, 0.0)), "wall"),
    ]
    rod = Object([Box((0.2, 0.02, 0.01))], pose=start, mass_kg=1.0)
    return Scene(rod, Cage([], shapes=walls), [WEIGHT], friction_coefficient=friction, planar="xz")


@pytest.mark.parametrize(
    "scene", [drawn_pair(1, 0.0).planar, drawn_pair(9, 0.0).planar, ladder(0.5)], ids=["plate", "other plate", "ladder"]
)
def test_mujoco_ends_there_on_slides_and_a_hinge(scene):
    pytest.importorskip("mujoco")
    found = crosscheck(run(scene))
    assert found.agrees, [phase.reasons for phase in found.phases]


def test_a_model_of_ours_is_read_again_with_its_plane(tmp_path: Path):
    pytest.importorskip("mujoco")
    done = run(drawn_pair(1, 0.0).planar)
    (tmp_path / "plate.xml").write_bytes(exported(done, "mjcf", "plate.xml").files["plate.xml"])
    scene = imported(str(tmp_path / "plate.xml")).scene
    assert scene.planar == "xz"
    assert np.abs(run(scene).pose.position_m - done.pose.position_m).max() < 1e-7
