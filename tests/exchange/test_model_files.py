"""Models whose files lie in other folders: under a root, in packages, with names in capitals; and nothing outside."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cagepose import SceneFileError, run
from cagepose.cli.app import main
from cagepose.exchange.imported import imported
from cagepose.model.shapes import Convex
from exchange.robots import box_obj, mjcf, peg_urdf, written

pytest.importorskip("mujoco")
pytestmark = pytest.mark.usefixtures("here")

PEG = box_obj((-0.004, -0.0035, 0.0), (0.004, 0.0035, 0.05))
BALL = '<body name="ball" pos="0 0 0.1"><freejoint/><geom type="sphere" size="0.02"/></body>'


def sizes(source: Path, **asked: object) -> list[float]:
    """Return the sides of the box around the object of a model, which has one mesh, the shortest first."""
    (part,) = imported(str(source), **asked).scene.object.parts
    assert isinstance(part, Convex)
    return spans(part)


def spans(part: Convex) -> list[float]:
    return sorted(np.ptp(part.vertices_m, axis=0).tolist())


def test_a_mesh_beside_the_folder_is_read_under_a_root(tmp_path, monkeypatch, capsys):
    """The layout of many published URDFs: robot/urdf/peg.urdf names ../mesh/peg.obj."""
    monkeypatch.chdir(tmp_path)
    written(tmp_path, robot__mesh__peg_dot_obj=PEG, robot__urdf__peg_dot_urdf=peg_urdf("../mesh/peg.obj"))
    assert main(["import", "robot/urdf/peg.urdf", "-o", "peg.yaml"]) == 2
    error = capsys.readouterr().err
    assert "'../mesh/peg.obj', which lies outside of the model's folder; give --root robot, under which" in error
    assert main(["import", "robot/urdf/peg.urdf", "--root", "robot", "-o", "peg.yaml"]) == 0
    found = imported("robot/urdf/peg.urdf", root="robot").scene
    assert sizes(Path("robot/urdf/peg.urdf"), root="robot") == pytest.approx([0.007, 0.008, 0.05], abs=1e-8)
    assert run(found).pose.position_m == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)


PLACES = {
    "the folder above is called so": ("package://robot/mesh/peg.obj", {}),
    "a folder of the root is called so": ("package://parts/peg.obj", {"parts__peg_dot_obj": PEG}),
    "package.xml says so": (
        "package://published/mesh/peg.obj",
        {"robot__package_dot_xml": "<package><name>published</name></package>"},
    ),
    "model": ("model://robot/mesh/peg.obj", {}),
    "a file of the root": ("robot/mesh/peg.obj", {}),
}


@pytest.mark.parametrize("name", PLACES)
def test_names_lead_to_packages(name, tmp_path):
    mesh, more = PLACES[name]
    files = {**more, "robot__mesh__peg_dot_obj": PEG, "robot__urdf__peg_dot_urdf": peg_urdf(mesh)}
    assert sizes(written(tmp_path, **files), root=str(tmp_path)) == pytest.approx([0.007, 0.008, 0.05], abs=1e-8)


def test_meshes_of_one_name_in_two_folders_are_two(tmp_path):
    table = peg_urdf("a/part.obj", z=0.06).replace('<box size="0.2 0.2 0.1"/>', '<mesh filename="b/part.obj"/>')
    other = box_obj((-0.1, -0.1, 0.0), (0.1, 0.1, 0.05))
    scene = imported(str(written(tmp_path, a__part_dot_obj=PEG, b__part_dot_obj=other, peg_dot_urdf=table))).scene
    assert spans(scene.object.parts[0]) == pytest.approx([0.007, 0.008, 0.05], abs=1e-8)
    assert spans(scene.cage.shapes[0]) == pytest.approx([0.05, 0.2, 0.2], abs=1e-8)


def test_one_mesh_in_two_scales_is_two(tmp_path):
    both = peg_urdf("peg.obj", z=0.06).replace('<box size="0.2 0.2 0.1"/>', '<mesh filename="peg.obj" scale="2 2 2"/>')
    scene = imported(str(written(tmp_path, peg_dot_obj=PEG, peg_dot_urdf=both))).scene
    assert spans(scene.cage.shapes[0]) == pytest.approx([0.014, 0.016, 0.1], abs=1e-8)
    assert spans(scene.object.parts[0]) == pytest.approx([0.007, 0.008, 0.05], abs=1e-8)


def test_suffixes_in_capitals_are_suffixes(tmp_path):
    source = written(tmp_path, PEG_dot_OBJ=PEG, PEG_dot_URDF=peg_urdf("PEG.OBJ"))
    assert sizes(source) == pytest.approx([0.007, 0.008, 0.05], abs=1e-8)
    ball = '<body name="b" pos="0 0 1"><freejoint/><geom type="mesh" mesh="PEG"/></body>'
    source = written(tmp_path, PEG_dot_XML=mjcf(ball, asset='<mesh file="PEG.OBJ"/>'))
    assert sizes(source) == pytest.approx([0.007, 0.008, 0.05], abs=1e-8)


def test_folders_and_includes_of_mjcf_are_found_under_a_root(tmp_path):
    """As Gymnasium-Robotics has them: meshdir beside, defaults and bodies included, textures that are not there."""
    model = """<mujoco><compiler meshdir="../stls/arm" texturedir="../textures"/><include file="shared.xml"/>
    <worldbody><geom name="floor" type="plane" size="1 1 1" material="wood"/><include file="parts/peg.xml"/></worldbody>
    </mujoco>"""
    shared = """<mujoco><asset><texture name="wood" file="wood.png" type="2d"/><material name="wood" texture="wood"/>
    <mesh name="peg" file="peg.obj"/></asset></mujoco>"""
    peg = '<mujoco><body name="peg" pos="0 0 1"><freejoint/><geom type="mesh" mesh="peg"/></body></mujoco>'
    files = {"stls__arm__peg_dot_obj": PEG, "arm__shared_dot_xml": shared, "arm__parts__peg_dot_xml": peg}
    source = written(tmp_path, **files, arm__arm_dot_xml=model)
    with pytest.raises(
        SceneFileError, match=r"names '../stls/arm', which lies outside of the model's folder; give --r"
    ):
        imported(str(source))
    assert sizes(source, root=str(tmp_path)) == pytest.approx([0.007, 0.008, 0.05], abs=1e-8)


def test_what_the_compiler_refuses_is_told_by_the_line_of_its_own_file(tmp_path):
    included = "<mujoco>\n<!-- one\ntwo -->\n<body><freejoint/>\n  <geom type='sphere' radius='1'/></body></mujoco>"
    source = written(
        tmp_path,
        ball_dot_xml=included,
        model_dot_xml="<mujoco>\n<worldbody>\n<include file='ball.xml'/>\n<geom type='bax'/></worldbody></mujoco>",
    )
    with pytest.raises(SceneFileError) as refused:
        imported(str(source))
    (problem,) = refused.value.problems
    assert (Path(problem.source).name, problem.line, problem.column) == ("ball.xml", 5, 3)
    written(tmp_path, ball_dot_xml=included.replace("radius", "size"))
    with pytest.raises(SceneFileError) as refused:
        imported(str(source))
    assert (Path(refused.value.problems[0].source).name, refused.value.problems[0].line) == ("model.xml", 4)


OUTSIDE = {
    "above": "../../secret.obj",
    "absolute": "{secret}",
    "file": "file://{secret}",
    "link": "link.obj",
    "package": "package://robot/../../secret.obj",
    "package above": "package://../secret.obj",
    "linked package": "package://elsewhere/secret.obj",
}


@pytest.mark.parametrize("name", OUTSIDE)
@pytest.mark.parametrize("kind", ["urdf", "mjcf"])
def test_nothing_outside_of_the_root_is_read(kind, name, tmp_path):
    root, secret = tmp_path / "root", written(tmp_path, secret_dot_obj=PEG)
    folder = written(root, robot__urdf__x_dot_txt="").parent
    (folder / "link.obj").symlink_to(secret)
    (root / "elsewhere").symlink_to(tmp_path)
    mesh = OUTSIDE[name].format(secret=secret)
    body = '<body name="b" pos="0 0 1"><freejoint/><geom type="mesh" mesh="m"/></body>'
    text = peg_urdf(mesh) if kind == "urdf" else mjcf(body, asset=f'<mesh name="m" file="{mesh}"/>')
    source = written(folder, **{f"peg_dot_{'urdf' if kind == 'urdf' else 'xml'}": text})
    with pytest.raises(SceneFileError) as refused:
        imported(str(source), root=str(root))
    assert "lies outside of --root" in str(refused.value) or "there is no such file" in str(refused.value)


def test_a_package_file_that_is_a_link_is_not_read(tmp_path):
    described = written(tmp_path, package_dot_xml="<package><name>published</name></package>")
    source = written(
        tmp_path / "root", mesh__peg_dot_obj=PEG, peg_dot_urdf=peg_urdf("package://published/mesh/peg.obj")
    )
    (source.parent / "package.xml").symlink_to(described)
    with pytest.raises(SceneFileError, match="no folder above the model is or has that package; give the folder that"):
        imported(str(source))


REFUSED = {
    "peg.dae": "names 'peg.dae', and MuJoCo reads no .dae; convert it to STL or OBJ",
    "none.obj": "names 'none.obj', and there is no such file; copy it there, or correct the name",
    "package://none/peg.obj": "is or has that package; give the folder that holds none, or one above it, with --root",
}


@pytest.mark.parametrize("mesh", REFUSED)
def test_files_that_cannot_be_read_are_told_with_a_remedy(mesh, tmp_path):
    with pytest.raises(SceneFileError) as refused:
        imported(str(written(tmp_path, peg_dot_dae="", peg_dot_urdf=peg_urdf(mesh))))
    assert REFUSED[mesh] in str(refused.value)


def test_a_root_has_to_hold_the_model(tmp_path):
    source = str(written(tmp_path, other__x_dot_txt="", model__ball_dot_xml=mjcf(BALL)))
    with pytest.raises(SceneFileError, match=r"does not lie under --root .*other; give a folder above it"):
        imported(source, root=str(tmp_path / "other"))
    with pytest.raises(SceneFileError, match=r"which is no folder; check the name"):
        imported(source, root=source)


def test_a_part_alone_is_told_how_to_be_joined(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    one = (
        '<robot name="p"><link name="peg"><collision><geometry><mesh filename="peg.obj"/></geometry></collision></link>'
    )
    source = written(tmp_path, peg_dot_obj=PEG, peg_dot_urdf=one + "</robot>")
    with pytest.raises(SceneFileError, match=r"one body alone.*: cagepose import --object peg\.obj --cage FILE"):
        imported(str(source))


def test_xacro_is_told_how_to_be_expanded(tmp_path):
    source = written(tmp_path, robot_dot_xacro="<robot/>")
    with pytest.raises(SceneFileError, match=r"run: xacro FILE > robot\.urdf, and give that"):
        imported(str(source))


def test_words_of_older_versions_do_not_matter_where_they_are_not_of_bodies(tmp_path):
    """apirate, njmax and others are gone from MuJoCo; a keyframe has a number for each actuator."""
    old = """<mujoco><option apirate="200" gravity="0 0 -3"><flag warmstart="enable" override="on"/></option>
    <size njmax="500" nconmax="100"/><visual><old/></visual><actuator><motor joint="none" old="1"/></actuator>
    <worldbody><geom name="floor" type="plane" size="1 1 1"/>{}</worldbody>
    <keyframe><key name="up" qpos="0 0 2 1 0 0 0" ctrl="0.5"/></keyframe></mujoco>"""
    scene, notes, *_ = imported(str(written(tmp_path, old_dot_xml=old.format(BALL))), keyframe="up")
    assert scene.object.pose_world_object.position_m[2] == 2.0
    assert "loads: the weight alone, with a gravity of (0, 0, -3) m/s^2" in notes


def test_a_urdf_without_its_world_has_one(tmp_path):
    urdf = peg_urdf("peg.obj").replace('<link name="world"/>', "")
    assert sizes(written(tmp_path, peg_dot_obj=PEG, peg_dot_urdf=urdf)) == pytest.approx([0.007, 0.008, 0.05], abs=1e-8)
