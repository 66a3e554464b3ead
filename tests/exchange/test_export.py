"""What other programs read from our files is the scene: asked of MuJoCo's own compiler and distances."""

from __future__ import annotations

import csv
import io
import re
import sys
from pathlib import Path

import numpy as np
import pytest

from cagepose import (
    Box,
    Cage,
    Chamfer,
    Convex,
    Cylinder,
    Disc,
    Hole,
    Load,
    MissingExtraError,
    Object,
    Pose,
    Scene,
    SceneError,
    Sphere,
    load_scene,
    run,
)
from cagepose.exchange.export import exported
from cagepose.exchange.mjcf import mjcf_text
from cagepose.exchange.pierced import SIDES_OF_ROUND
from cagepose.exchange.solids import POINT_OF_SIZE, assembly_of
from cagepose.exchange.stl import stl_text
from cagepose.model.shape_moments import mesh_sums, shape_moments
from cagepose.model.surface import Mesh
from our_scenes import SCENES

mujoco = pytest.importorskip("mujoco")

OF_MESHES = 1e-6
"""Fraction of the scene's size. MuJoCo keeps the vertices of meshes in single precision."""


def model_of(scene: Scene, phases=()):
    """The model of a scene as MuJoCo reads it, its distances to more than its usual six digits."""
    model = mujoco.MjModel.from_xml_string(mjcf_text(assembly_of(scene), phases))
    model.opt.ccd_tolerance, model.opt.ccd_iterations = 1e-14, 200
    return model


def elements(model) -> dict[str, list[int]]:
    """Geoms of each part of the object, and of each point and part of the cage."""
    found: dict[str, list[int]] = {}
    for geom in range(model.ngeom):
        body, name, *_ = model.geom(geom).name.split("/")
        found.setdefault(f"{body}/{name}", []).append(geom)
    return found


def sagitta(scene: Scene) -> float:
    """How far the flat sides of what is round may be off, metres: of holes and frustums."""
    turned = [*scene.object.holes, *scene.cage.holes, *scene.object.shapes]
    radii = [radius for shape in turned if hasattr(shape, "rims") for _, radius in shape.rims]
    return max(radii, default=0.0) * (1.0 / np.cos(np.pi / SIDES_OF_ROUND) - 1.0)


def move_bodies(model, scene: Scene, phase, poses: dict[str, Pose]) -> None:
    """Put geoms of bodies of the cage from where the phase before left them to where they are driven, or press."""
    moved = {**(phase.drive.bodies if phase.drive else {}), **(phase.press.bodies if phase.press else {})}
    for body in scene.cage.bodies:
        if body.name in moved:
            before, after = poses.get(body.name, body.pose_cage_body), moved[body.name].pose_cage_body
            way, poses[body.name] = after @ before.inverse(), after
            for name in (*body.names, *(shape.name for shape in body.shapes)):
                for geom in elements(model)[f"cage/{name}"]:
                    placed = way @ Pose(model.geom_pos[geom], model.geom_quat[geom])
                    model.geom_pos[geom], model.geom_quat[geom] = placed.position_m, placed.quaternion_wxyz
                    model.geom_sameframe[geom] = 0


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_what_touches_at_the_end_of_a_phase_touches_in_mujoco(path):
    scene = load_scene(path)
    found = run(scene)
    model = model_of(scene, found.phases)
    data = mujoco.MjData(model)
    geoms = elements(model)
    off = POINT_OF_SIZE * scene.size_m + OF_MESHES * scene.size_m + 2.0 * sagitta(scene)
    assert model.nkey == len(found.phases)
    poses: dict[str, Pose] = {}
    for index, phase in enumerate(found.phases):
        move_bodies(model, scene, phase, poses)
        mujoco.mj_resetDataKeyframe(model, data, index)
        mujoco.mj_forward(model, data)
        assert model.key(index).name == phase.name
        for contact in phase.contacts:
            drilled = next((hole.in_[0] for hole in (*scene.cage.holes, *scene.object.holes) if hole.in_), "")
            names = (f"object/{contact.box}", f"cage/{contact.point}")
            # A hole is no body: what touches its wall touches the part that it is in.
            ours, theirs = (geoms.get(name) or geoms[f"{name.split('/')[0]}/{drilled}"] for name in names)
            least = min(
                mujoco.mj_geomDistance(model, data, one, other, scene.size_m, np.zeros(6))
                for one in ours
                for other in theirs
            )
            assert abs(least) < off, (phase.name, contact)


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_mass_and_poses_are_those_of_the_scene(path):
    scene = load_scene(path)
    model = model_of(scene)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    body, held = model.body("object").id, scene.object
    assert model.body_mass[body] == (held.mass_kg or 1.0)
    assert model.body_ipos[body] == pytest.approx(held.center_of_gravity_m, abs=0.0)
    axes = data.ximat[body].reshape(3, 3)
    inertia = axes @ np.diag(model.body_inertia[body]) @ axes.T
    turn = held.pose_world_object.rotation
    wanted = model.body_mass[body] * turn @ held.gyration_m2 @ turn.T
    assert inertia == pytest.approx(wanted, abs=1e-12 * np.trace(wanted))
    assert data.body("object").xpos.tolist() == held.pose_world_object.position_m.tolist()
    cage = data.body("cage")
    assert cage.xmat.reshape(3, 3) == pytest.approx(scene.cage.pose_world_cage.rotation, abs=1e-15)


@pytest.mark.parametrize("name", ["rollers", "phone-dock", "tapered-pin", "rail-yaw", "v-groove"])
def test_urdf_is_the_same_model(name, tmp_path):
    scene = load_scene(next(path for path in SCENES if path.stem == name))
    for file, content in exported(run(scene), "urdf", "scene.urdf").files.items():
        (tmp_path / file).parent.mkdir(exist_ok=True)
        (tmp_path / file).write_bytes(content)
    urdf = mujoco.MjModel.from_xml_path(str(tmp_path / "scene.urdf"))
    mjcf = model_of(scene)
    urdf.opt.ccd_tolerance, urdf.opt.ccd_iterations = mjcf.opt.ccd_tolerance, mjcf.opt.ccd_iterations
    gaps = []
    for model in (mjcf, urdf):
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        held, cage = ({n: g for n, g in elements(model).items() if n.startswith(body)} for body in ("object", "cage"))
        gaps.append(
            {
                (one, other): min(
                    mujoco.mj_geomDistance(model, data, a, b, scene.size_m, np.zeros(6))
                    for a in held[one]
                    for b in cage[other]
                )
                for one in held
                for other in cage
            }
        )
    assert gaps[0].keys() == gaps[1].keys()
    assert list(gaps[1].values()) == pytest.approx([gaps[0][pair] for pair in gaps[1]], abs=OF_MESHES * scene.size_m)
    for body in ("object",):
        assert urdf.body(body).mass == mjcf.body(body).mass
        assert urdf.body(body).inertia == pytest.approx(mjcf.body(body).inertia, rel=1e-12)


def block(*shapes, holes=(), cage=None, **keys) -> Scene:
    held = Object(shapes=shapes or [Box((0.02, 0.02, 0.02))], holes=holes, pose=Pose((0, 0, 0.05)))
    return Scene(held, cage or Cage([(0, 0, 0)]), [Load("weight", gravity=(0, 0, -1))], **keys)


def test_a_contact_has_the_friction_of_the_cage_else_of_the_object():
    cage = Cage([(0.005, 0.005, 0.04), (-0.005, 0.005, 0.04)], ["rough", "plain"])
    parts = [Box((0.02, 0.02, 0.02), name="slick"), Box((0.02, 0.02, 0.02), name="block")]
    cases = {("rough", "slick"): 0.7, ("rough", "block"): 0.7, ("plain", "slick"): 0.05, ("plain", "block"): 0.3}
    scene = block(*parts, cage=cage, friction_coefficient=0.3, friction_of={"rough": 0.7, "slick": 0.05})
    model = model_of(scene)
    data = mujoco.MjData(model)
    data.qpos[2] -= 1e-5
    mujoco.mj_forward(model, data)
    found = {}
    for contact in data.contact:
        names = sorted(model.geom(geom).name for geom in contact.geom)  # cage first
        found[names[0].removeprefix("cage/"), names[1].removeprefix("object/")] = contact.friction[0]
    assert found == cases


def test_without_friction_contacts_have_none():
    model = model_of(load_scene(next(path for path in SCENES if path.stem == "rail-pitch")))
    assert set(model.geom_condim.tolist()) == {1}


def solids_of(text: str) -> dict[str, Mesh]:
    """Read an STL text back."""
    found = {}
    for name, body in re.findall(r"^solid ([^,]*),.*?\n(.*?)^endsolid", text, re.MULTILINE | re.DOTALL):
        numbers = [line.split()[1:] for line in body.splitlines() if line.startswith("vertex")]
        corners = np.array(numbers, dtype=np.float64) / 1e3
        found[name] = Mesh(corners, np.arange(len(corners)).reshape(-1, 3))
    return found


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_stl_holds_the_volume_of_each_part_where_it_is(path):
    scene = load_scene(path)
    pose = Pose((0.1, -0.2, 0.3), euler_zyx=(0.3, 0.2, -0.4))
    solids = solids_of(stl_text(scene, pose)[0])
    held, cage = scene.object, scene.cage
    expected = {f"object/{part.name}": (part, pose) for part in held.parts}
    expected |= {f"cage/{part.name}": (part, cage.pose_world_cage) for part in cage.shapes}
    assert solids.keys() == expected.keys() | {f"cage/{name}" for name in cage.names}
    for name, (part, place) in expected.items():
        sums = mesh_sums(solids[name], np.zeros(3))
        moments = shape_moments(part)
        body = held if name.startswith("object/") else cage
        holes = [shape_moments(hole) for hole in body.holes if part.name in hole.in_]
        assert sums.volume == pytest.approx(moments.volume_m3 - sum(h.volume_m3 for h in holes), rel=5e-3)
        if not holes:
            assert sums.first / sums.volume == pytest.approx(place.transform(moments.centroid_m), abs=1e-6)


def test_csv_holds_the_poses_to_the_last_digit():
    found = run(load_scene(next(path for path in SCENES if path.stem == "rail-roll")))
    text = exported(found, "csv", "poses.csv").files["poses.csv"].decode()
    rows = list(csv.DictReader(io.StringIO(text.split("\n", 1)[1])))
    assert [row["phase"] for row in rows] == ["", *(phase.name for phase in found.phases)]
    for row, phase in zip(rows[1:], found.phases, strict=True):
        assert [float(row[f"{axis}_m"]) for axis in "xyz"] == phase.pose.position_m.tolist()
        assert [float(row[f"quat_{part}"]) for part in "wxyz"] == phase.pose.quaternion_wxyz.tolist()


@pytest.mark.parametrize("chamfer", [None, Chamfer(0.002, np.radians(30))])
@pytest.mark.parametrize("depth", [0.01, 0.03])
def test_wedges_around_a_hole_leave_it_open_and_nothing_else(chamfer, depth):
    """Points of the part are in a piece, those of the hole are not, but for what the flat sides are off."""
    turned = Pose((0.3, 0.1, 0.2), euler_zyx=(0.3, 0.5, -0.2))
    plate = Box((0.06, 0.05, 0.03), turned @ Pose((0, 0, -0.015)), "plate")
    hole = Hole(0.01, depth, chamfer, ["plate"], turned @ Pose((0.005, -0.003, 0)))
    held = block(plate, holes=[hole], cage=Cage([(0, 0, -1)]))
    pieces = [solid.shape for solid in assembly_of(held).object]
    points = turned.transform(np.random.default_rng(0).uniform((-0.03, -0.025, -0.03), (0.03, 0.025, 0), (4000, 3)))
    in_pieces = np.any([piece.holds(points) for piece in pieces], axis=0)
    away = np.hypot(*hole.pose_body_shape.inverse_transform(points)[:, :2].T)
    heights = hole.pose_body_shape.inverse_transform(points)[:, 2]
    walls = np.interp(heights, *np.array(hole.rims).T)
    off = np.maximum(walls, 0.01) * (1.0 / np.cos(np.pi / SIDES_OF_ROUND) - 1.0) + 1e-9
    is_solid = (away > walls + off) | (heights < -depth - 1e-9)
    is_open = (away < walls - 1e-9) & (heights > -depth + 1e-9)
    assert in_pieces[is_solid].all()
    assert not in_pieces[is_open].any()
    assert is_solid.sum() > 1000 < len(points)
    assert is_open.sum() > 100


def test_a_rounded_hull_is_its_pieces_exactly():
    corners = np.array([(0, 0, 0), (0.02, 0, 0), (0, 0.03, 0), (0.005, 0.005, 0.02)])
    for vertices in (corners, corners[:3], corners[:2], corners[:1]):
        shape = Convex(vertices, 0.004, Pose((0.1, 0, 0), euler_zyx=(0.2, 0.3, 0.4)), "rounded")
        pieces = [solid.shape for solid in assembly_of(block(shape, cage=Cage([(0, 0, -1)]))).object]
        directions = np.random.default_rng(1).normal(size=(500, 3))
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        reach = np.max([piece.heights_m(directions) for piece in pieces], axis=0)
        assert reach == pytest.approx(shape.heights_m(directions), abs=1e-15)


def test_what_a_format_cannot_hold_is_refused_by_its_name():
    disc = block(Box((0.02, 0.02, 0.02)), Disc(0.03, name="washer"))
    with pytest.raises(SceneError, match=r"object.washer: is a disc, which has no thickness"):
        assembly_of(disc)
    with pytest.raises(SceneError, match=r"object.washer: is a disc, which encloses nothing"):
        stl_text(disc, Pose())
    alone = block(Sphere(0.01), cage=Cage(holes=[Hole(0.02, 0.03, name="well")]))
    with pytest.raises(SceneError, match=r"cage.well: stands alone"):
        stl_text(alone, Pose())
    assert any("'well' stands alone" in note for note in assembly_of(alone).notes)
    part = Box((0.02, 0.02, 0.02), name="block")
    up = Hole(0.002, 0.005, in_=["block"], pose_body_shape=Pose((0, 0, 0.01)), name="up")
    aside = Hole(
        0.002, 0.005, in_=["block"], pose_body_shape=Pose((0.01, 0, 0), euler_zyx=(0, np.pi / 2, 0)), name="aside"
    )
    with pytest.raises(SceneError, match=r"object.block: has holes that are not parallel \('up', 'aside'\)"):
        assembly_of(block(part, holes=[up, aside]))


def test_a_missing_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "manifold3d", None)
    drilled = load_scene(next(path for path in SCENES if path.stem == "tapered-pin"))
    for write in (lambda: assembly_of(drilled), lambda: stl_text(drilled, Pose())):
        with pytest.raises(MissingExtraError, match=r"pip install 'cagepose\[files\]'"):
            write()


def test_comments_are_xml_whatever_the_name():
    text = mjcf_text(assembly_of(block(Cylinder(0.01, 0.02), name='a --- b <&> "c"--')))
    assert mujoco.MjModel.from_xml_string(text).ngeom == 2


def test_the_command_writes_files_and_says_what_they_do_not_hold(tmp_path, monkeypatch, capsys):
    from cagepose.cli.app import main

    monkeypatch.chdir(tmp_path)
    scene = str(next(path for path in SCENES if path.stem == "phone-dock"))
    assert main(["export", scene, "--to", "urdf", "-o", "dock.urdf"]) == 0
    out = capsys.readouterr().out
    assert out.startswith("wrote dock.urdf and 7 files beside it: phone in a dock, rests (quasistatic)\n")
    assert "note: URDF has no friction" in out
    assert len(list(Path("dock-meshes").iterdir())) == 7
    assert main(["export", scene, "--to", "urdf", "-o", "dock.urdf"]) == 0  # over its own files
    Path("mine.xml").write_text("<mujoco/>")
    assert main(["export", scene, "--to", "mjcf", "-o", "mine.xml"]) == 2
    assert "holds something else than an export of cagepose" in capsys.readouterr().err
    assert Path("mine.xml").read_text() == "<mujoco/>"


def test_what_is_written_has_no_name_of_another_kind(tmp_path, monkeypatch, capsys):
    from cagepose.cli.app import main

    monkeypatch.chdir(tmp_path)
    scene = str(next(path for path in SCENES if path.stem == "phone-dock"))
    assert main(["export", scene, "--to", "step", "-o", "dock.stl"]) == 2
    assert capsys.readouterr().err == "--out dock.stl: is not the name of a step file; write --out dock.step\n"
    assert main(["export", scene, "--to", "csv", "-o", "dock.poses"]) == 0
    assert [path.name for path in tmp_path.iterdir()] == ["dock.poses"]
