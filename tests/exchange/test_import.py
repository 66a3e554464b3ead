"""Models come back as the scenes that they were; foreign ones say what was left out; hostile ones do no harm."""

from __future__ import annotations

import math
import os
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cagepose import (
    Box,
    Cage,
    CageBody,
    Drive,
    Hole,
    Load,
    Object,
    Pose,
    Scene,
    SceneFileError,
    Spring,
    load_scene,
    run,
)
from cagepose.cli.app import main
from cagepose.exchange import compile_model, imported, model_text
from cagepose.exchange.export import exported
from cagepose.exchange.model_friction import scene_friction
from cagepose.exchange.stl import binary_stl
from cagepose.model.shapes import Cone, Convex
from cagepose.model.surface import Mesh
from exchange.poses_apart import apart
from our_scenes import SCENES

mujoco = pytest.importorskip("mujoco")

FILES = {path.stem: path for path in SCENES}


def is_primitive(scene: Scene) -> bool:
    """Whether every part is exactly what the formats have, and none is driven: in them all of the cage stands still."""
    if scene.cage.bodies:
        return False
    parts = (*scene.object.parts, *scene.cage.shapes, *scene.object.holes, *scene.cage.holes)
    return not any(isinstance(part, Cone | Hole) or (isinstance(part, Convex) and part.radius_m) for part in parts)


EXACT = [name for name, path in FILES.items() if is_primitive(load_scene(path))]


def there_and_back(scene: Scene, to: str, folder: Path):
    name = "scene.urdf" if to == "urdf" else "scene.xml"
    for file, content in exported(run(scene), to, name).files.items():
        (folder / file).parent.mkdir(exist_ok=True)
        (folder / file).write_bytes(content)
    return imported.imported(str(folder / name))


def test_sixteen_scenes_are_of_primitives():
    assert len(EXACT) == 16
    assert "rollers" in EXACT


@pytest.mark.parametrize("to", ["mjcf", "urdf"])
@pytest.mark.parametrize("name", EXACT)
@pytest.mark.usefixtures("here")
def test_primitives_come_back_exactly(name, to, tmp_path):
    scene = load_scene(FILES[name])
    found = there_and_back(scene, to, tmp_path)
    assert apart(scene, found.scene) < 1e-9
    assert found.notes == ()
    assert found.scene.name == scene.name
    assert found.scene.cage.names == scene.cage.names
    if to == "mjcf":
        assert set(found.scene.object.element_names) == set(scene.object.element_names)
        assert set(found.scene.cage.element_names) == set(scene.cage.element_names)


@pytest.mark.parametrize(("name", "off"), [("peg-in-hole", 1e-6), ("phone-dock", 1e-5)])
@pytest.mark.usefixtures("here")
def test_what_stands_for_other_shapes_comes_back_as_it_stands(name, off, tmp_path):
    scene = load_scene(FILES[name])
    assert apart(scene, there_and_back(scene, "mjcf", tmp_path).scene) < off


@pytest.mark.usefixtures("here")
def test_own_friction_comes_back(tmp_path):
    scene = load_scene(FILES["rollers"])
    changed = Scene(
        scene.object,
        scene.cage,
        scene.loads,
        friction_coefficient=0.1,
        friction_of={"low front": 0.4, "high back": 0.0},
    )
    for to in ("mjcf", "urdf"):
        found = there_and_back(changed, to, tmp_path).scene
        assert found.friction_coefficient == 0.1
        if to == "mjcf":
            assert found.friction_of == {"low front": 0.4, "high back": 0.0}
        assert apart(changed, found) < 1e-9


def test_friction_of_pairs_is_that_of_mujoco():
    random = np.random.default_rng(5)
    n_uneven = 0
    for _ in range(400):
        held, cage = (
            {
                f"{body}{index}": {
                    "friction": float(random.choice([0.0, 0.2, 0.5])),
                    "priority": int(random.choice([0, 0, 1])),
                }
                for index in range(random.integers(1, 4))
            }
            for body in ("part", "wall")
        )
        plain, of, uneven = scene_friction(held, cage)
        n_uneven += bool(uneven)
        for part, one in held.items():
            for wall, other in cage.items():
                wanted = max(one["friction"], other["friction"])
                if one["priority"] != other["priority"]:
                    wanted = (one if one["priority"] > other["priority"] else other)["friction"]
                ours = of.get(wall, of.get(part, plain))
                if wall in uneven:
                    assert ours >= wanted
                else:
                    assert ours == wanted, (held, cage, plain, of)
    assert 0 < n_uneven < 300


ARM = """
<mujoco model="arm">
  <compiler angle="degree" meshdir="meshes"/>
  <option gravity="0 0 -3"/>
  <default><geom friction="0.4"/><default class="seen"><geom contype="0" conaffinity="0"/></default></default>
  <asset><mesh name="wedge" file="wedge.stl" scale="0.001 0.001 0.001"/></asset>
  <worldbody>
    <geom name="floor" type="plane" size="0 0 1"/>
    <body name="stand" pos="1 0 0"><geom type="cylinder" size="0.1 0.2"/></body>
    <body name="block" pos="0 0 0.3">
      <freejoint/>
      <geom name="base" type="box" size="0.1 0.05 0.05" mass="2"/>
      <geom name="shell" class="seen" type="box" size="1 1 1" mass="0"/>
      <geom name="egg" type="ellipsoid" size="0.01 0.02 0.03" mass="0"/>
      <body name="flap" pos="0.1 0 0.05" euler="0 90 0">
        <joint type="hinge" axis="0 1 0"/>
        <geom name="tongue" type="mesh" mesh="wedge" mass="1"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""
WEDGE = np.array([(0, 0, 0), (40, 0, 0), (0, 30, 0), (0, 0, 20)], dtype=float)
SIDES = np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])


@pytest.fixture
def arm(tmp_path) -> Path:
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "wedge.stl").write_bytes(binary_stl(Mesh(WEDGE, SIDES)))
    (tmp_path / "arm.xml").write_text(ARM)
    return tmp_path / "arm.xml"


@pytest.mark.usefixtures("here")
def test_a_foreign_model_is_read_and_what_it_loses_is_said(arm):
    scene, notes, *_ = imported.imported(str(arm))
    assert notes == (
        "joints stay where the model has them, of flap",
        "left out, as in the model they do not touch the cage: shell",
        "'egg' is an ellipsoid; here, a hull of 146 corners with round edges within it, up to 0.29 mm off, and nothing"
        " at the ends of its axes",
        "'floor' is a plane; here, a box 8 m wide under the object, its top there",
        "loads: the weight alone, with a gravity of (0, 0, -3) m/s^2",
    )
    held = scene.object
    assert held.element_names == ("base", "egg", "tongue")
    assert held.mass_kg == pytest.approx(3.0)
    tongue = held.parts[2]
    # The flap is turned by 90 deg about y: x down, z along x.
    expected = np.array((0.1, 0, 0.05)) + 1e-3 * WEDGE[:, [2, 1, 0]] * (1, 1, -1)
    found = tongue.pose_body_shape.transform(tongue.vertices_m)
    assert sorted(found.round(7).tolist()) == sorted(expected.round(7).tolist())
    wedge_center = expected.mean(axis=0)
    assert held.center_of_gravity_m == pytest.approx(wedge_center / 3.0, abs=1e-7)
    assert scene.friction_coefficient == 0.4
    ended = run(scene)
    assert ended.verdict == "rests"
    assert ended.pose.position_m[2] == pytest.approx(0.05, abs=1e-9)


@pytest.mark.usefixtures("here")
def test_inertia_of_bodies_that_are_one_is_theirs_together(tmp_path):
    """Half of a block on a joint weighs what the whole block does."""
    half = '<geom type="box" size="0.1 0.1 0.1" mass="1" pos="{} 0 0"/>'
    floor = '<geom type="plane" size="1 1 1" pos="0 0 -1"/>'
    turned = '<body name="b" pos="0.1 0 0" euler="20 30 40"><joint/><body euler="0 0 0">{}</body></body>'
    for name, rest in (("one", half.format(0.1)), ("two", turned.format(half.format(0.0)))):
        body = f'<body name="a"><freejoint/>{half.format(-0.1)}{rest}</body>'
        (tmp_path / f"{name}.xml").write_text(f"<mujoco><worldbody>{floor}{body}</worldbody></mujoco>")
    one, two = (imported.imported(str(tmp_path / f"{name}.xml")).scene.object for name in ("one", "two"))
    assert two.mass_kg == one.mass_kg == 2.0
    assert two.center_of_gravity_m == pytest.approx(one.center_of_gravity_m, abs=1e-15)
    assert np.trace(two.gyration_m2) == pytest.approx(np.trace(one.gyration_m2), rel=1e-12)  # a cube turns as it likes
    assert two.gyration_m2 == pytest.approx(one.gyration_m2, abs=1e-12)


@pytest.mark.usefixtures("here")
def test_a_plane_has_no_end_and_is_under_the_object(arm):
    """Its size is that of its picture: MuJoCo's planes go on."""
    far = ARM.replace('size="0 0 1"', 'size="1 1 1" euler="0 0 30"').replace('pos="0 0 0.3"', 'pos="30 -20 0.3"')
    arm.write_text(far)
    ended = run(imported.imported(str(arm)).scene)
    assert ended.verdict == "rests"
    assert ended.pose.position_m == pytest.approx((30.0, -20.0, 0.05), abs=1e-9)


@pytest.mark.usefixtures("here")
def test_bodies_are_chosen_by_name(arm):
    scene, notes, *_ = imported.imported(str(arm), "flap", ["stand", "block"])
    assert scene.object.element_names == ("tongue",)
    assert [str(shape.name) for shape in scene.cage.shapes] == ["geom 2"]  # it hangs on the block
    with pytest.raises(SceneFileError, match=r"has no body 'flop'; its bodies: stand, block, flap"):
        imported.imported(str(arm), "flop")
    arm.write_text(ARM.replace("<freejoint/>", ""))
    with pytest.raises(SceneFileError, match=r"has no body that moves freely; say which is held, with --object"):
        imported.imported(str(arm))
    assert notes


@pytest.mark.usefixtures("here")
def test_a_body_without_a_name_is_called_by_its_number(arm):
    arm.write_text(ARM.replace('name="flap" ', ""))
    scene, *_ = imported.imported(str(arm), "body 3")
    assert scene.object.element_names == ("tongue",)
    with pytest.raises(SceneFileError, match=r"its bodies: stand, block, body 3"):
        imported.imported(str(arm), "flap")


def test_a_model_that_comes_with_mujoco_is_read(capsys, tmp_path):
    """Its own test model: hinges, hulls, an ellipsoid, a height field, bodies without names."""
    model = Path(mujoco.__file__).parent / "testdata" / "model.xml"
    if not model.is_file():
        pytest.skip("this MuJoCo comes without its test model")
    assert main(["import", str(model), "-o", str(tmp_path / "x.yaml")]) == 2
    assert "has 5 bodies that move freely; say which is held, with --object" in capsys.readouterr().err
    assert main(["import", str(model), "--object", "head", "-o", str(tmp_path / "x.yaml")]) == 0
    assert "note: left out: 'geom 12', a height field; give its surface as a mesh" in capsys.readouterr().out
    assert main(["run", str(tmp_path / "x.yaml")]) == 0
    assert "warning: the source of this scene also has geom 12" in capsys.readouterr().out


@pytest.mark.usefixtures("here")
def test_a_mesh_that_is_not_convex_is_said(arm):
    inwards = np.vstack([WEDGE, (6, 5, 4)])  # the slanted side goes in to here
    sides = np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 4), (2, 3, 4), (3, 1, 4)])
    (arm.parent / "meshes" / "wedge.stl").write_bytes(binary_stl(Mesh(inwards, sides)))
    notes = imported.imported(str(arm)).notes
    assert any(note.startswith("the mesh 'tongue' is not convex: here, its hull, 48.3% of which is") for note in notes)


BOMB = '<!DOCTYPE m [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]><mujoco model="&b;"/>'
HOSTILE = {
    "suffix": (ARM, "has the suffix '.zip'; give a file of one of: .xml, .urdf, .step, .stp, .stl,"),
    "nowhere": (ARM.replace('pos="1 0 0"', 'pos="nan 0 0"'), "has a body, 'stand', at a place that is no number"),
    "no size": (ARM.replace('size="0.1 0.2"', 'size="nan 0.2"'), "is refused by MuJoCo's compiler: "),  # writes a log
    "truncated": (ARM[:400], "is not XML"),
    "no model": ("<svg/>", "is XML with the root <svg>; give MJCF"),
    "entities": (BOMB, "declares a document type or entities"),
    "outside": (ARM.replace("wedge.stl", "../../../etc/passwd"), "lies outside of the model's folder"),
    "absolute": (ARM.replace("wedge.stl", "/etc/passwd"), "lies outside of the model's folder"),
    "folder": (ARM.replace('meshdir="meshes"', 'meshdir="/"'), "lies outside of the model's folder"),
    "link": (ARM.replace("wedge.stl", "link.stl"), "lies outside of the model's folder"),
    "loop": (ARM.replace("wedge.stl", "loop.stl"), "names 'loop.stl', a link that leads to itself"),
    "long": (ARM.replace("wedge.stl", "w" * 300 + ".stl"), "cannot be read (File name too long); check the names"),
    "missing": (ARM.replace("wedge.stl", "none.stl"), "names 'none.stl', and there is no such file"),
    "garbage": (ARM.replace("wedge.stl", "garbage.stl"), "refused by MuJoCo's compiler"),
    "claims": (ARM.replace("wedge.stl", "claims.stl"), "refused by MuJoCo's compiler"),
    "itself": (
        '<mujoco><include file="model.xml"/></mujoco>',
        "model.xml:1:9: includes 'model.xml' twice, or in itself",
    ),
    "nested": ("<mujoco>" + 300 * "<body>" + 300 * "</body>" + "</mujoco>", "nested deeper than 200"),
    "attached": (ARM.replace("<asset>", '<asset><model file="/etc/passwd"/>'), "attaches the model '/etc/passwd'"),
    "xacro expression": ('<robot><link name="$(arg name)"/></robot>', "is xacro, whose macros only ROS's own"),
    "xacro": ('<robot><xacro:include filename="/etc/passwd"/></robot>', "is xacro, whose macros only ROS's own"),
    "package": (
        '<robot><link name="a"><collision><geometry><mesh filename="package://../../etc/passwd"/></geometry></collision>'
        "</link></robot>",
        "lies outside of the model's folder",
    ),
    "included": ('<mujoco><include file="meshes/bomb.xml"/></mujoco>', "declares a document type"),
    "large": ("<mujoco>" + " " * (4 * 1024**2) + "</mujoco>", "is larger than 4 MiB"),
    "many": ("<mujoco>" + 50_001 * "<b/>" + "</mujoco>", "has more than 50,000 elements"),
    "no body": ("<mujoco><worldbody/></mujoco>", "has no bodies in its world"),
    "nothing": (
        "<mujoco><worldbody><body><freejoint/><inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/></body></worldbody>"
        "</mujoco>",
        "has nothing that touches in what is the object",
    ),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_files_are_clear_errors_and_nothing_is_written(name, arm, monkeypatch, capsys):
    folder = arm.parent
    monkeypatch.chdir(folder)
    (folder / "meshes" / "garbage.stl").write_bytes(os.urandom(1000))
    (folder / "meshes" / "claims.stl").write_bytes(b" " * 80 + b"\xff\xff\xff\x7f" + bytes(500))
    (folder / "meshes" / "bomb.xml").write_text(BOMB)
    (folder / "meshes" / "link.stl").symlink_to("/etc/passwd")
    (folder / "meshes" / "loop.stl").symlink_to("loop.stl")
    text, message = HOSTILE[name]
    model = Path("model.zip" if name == "suffix" else "model.xml")
    model.write_text(text)
    before = sorted(folder.rglob("*"))
    began = time.monotonic()
    assert main(["import", str(model), "-o", "scene.yaml"]) == 2
    assert time.monotonic() - began < 10.0
    error = capsys.readouterr().err
    assert message in error
    assert error.startswith(f"{model}") or name == "included"
    assert len(error.splitlines()) == 1
    assert sorted(folder.rglob("*")) == before


@pytest.mark.skipif(sys.platform != "linux", reason="other systems have names in Unicode")
def test_a_name_that_is_no_utf_8_is_said(arm, capsys):
    named = arm.with_name(os.fsdecode(b"arm\xe9.xml"))
    arm.rename(named)
    assert main(["import", str(named), "-o", str(arm.with_name("x.yaml"))]) == 2
    assert "has a name, or is in a folder, whose letters are no UTF-8; rename it" in capsys.readouterr().err


def test_a_module_that_lies_beside_a_model_is_not_run(arm, monkeypatch):
    """Python would find it there, under the name of one that MuJoCo's process takes."""
    monkeypatch.chdir(arm.parent)
    Path("mujoco.py").write_text("import os; os.kill(os.getpid(), 9)")
    assert imported.imported("arm.xml").scene.object.mass_kg == pytest.approx(3.0)


def test_a_model_that_asks_for_too_much_is_stopped(arm, monkeypatch):
    many = '<replicate count="30000"><replicate count="30000"><geom size="1"/></replicate></replicate>'
    arm.write_text(f"<mujoco><worldbody>{many}</worldbody></mujoco>")
    monkeypatch.setattr(compile_model, "WALL_SECONDS", 1.0)
    with pytest.raises(SceneFileError, match="takes MuJoCo's compiler more than 1 s; simplify it"):
        imported.imported(str(arm))


@pytest.mark.skipif(sys.platform != "linux", reason="other systems do not count memory so")
def test_a_process_of_its_own_may_take_two_gibibytes():
    limited = "from cagepose.files.own_process import limit; limit()"
    for mebibytes, stops in ((1500, False), (2100, True)):
        code = f"{limited}; import numpy; numpy.empty({mebibytes} * 2**20, numpy.uint8)"
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, check=False)
        assert (b"MemoryError" in done.stderr) is stops


def test_meshes_have_a_limit(arm, monkeypatch):
    monkeypatch.setattr(model_text, "MAX_MESH_BYTES", 100)
    with pytest.raises(SceneFileError, match="names files of more than"):
        imported.imported(str(arm))


def test_the_command_writes_a_scene_that_runs(arm, monkeypatch, capsys):
    monkeypatch.chdir(arm.parent)
    assert main(["import", "arm.xml", "-o", "arm.yaml"]) == 0
    out = capsys.readouterr().out
    assert out.startswith("wrote arm.yaml: Object: 1 box, 2 shapes, 3 kg; Cage: 2 shapes\n\npart ")
    assert "\nnote: joints stay" in out
    assert main(["run", "arm.yaml"]) == 0
    assert main(["import", "arm.xml", "-o", "arm.yaml"]) == 0  # over its own file
    Path("mine.yaml").write_text("name: mine")
    assert main(["import", "arm.xml", "-o", "mine.yaml"]) == 2
    assert Path("mine.yaml").read_text() == "name: mine"


def test_a_hull_of_many_corners_is_facets(tmp_path):
    """A ball of 20 mm stands on a post of 200 sides, 100 mm high."""
    n = 200
    rim = [(0.04 * math.cos(2 * math.pi * k / n), 0.04 * math.sin(2 * math.pi * k / n)) for k in range(n)]
    corners = [(x, y, z) for z in (0.0, 0.1) for x, y in rim]
    lines = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in [*corners, (0.0, 0.0, 0.0), (0.0, 0.0, 0.1)]]
    for k in range(n):
        one, two = k + 1, (k + 1) % n + 1
        lines += [f"f {one} {two} {n + two}", f"f {one} {n + two} {n + one}"]
        lines += [f"f {2 * n + 1} {two} {one}", f"f {2 * n + 2} {n + one} {n + two}"]
    (tmp_path / "post.obj").write_text("\n".join(lines) + "\n")
    (tmp_path / "post.xml").write_text(
        '<mujoco><asset><mesh name="post" file="post.obj"/></asset><worldbody>'
        '<geom name="floor" type="plane" size="1 1 1"/><body name="cage"><geom type="mesh" mesh="post"/></body>'
        '<body name="ball" pos="0.005 0 0.16"><freejoint/><geom type="sphere" size="0.02"/></body>'
        "</worldbody></mujoco>"
    )
    found = imported.imported(str(tmp_path / "post.xml"))
    assert [shape.kind for shape in found.scene.cage.shapes] == ["box", "facets"]
    assert run(found.scene).pose.position_m[2] == pytest.approx(0.12, abs=1e-7)


@pytest.mark.parametrize("to", ["mjcf", "urdf"])
@pytest.mark.usefixtures("here")
def test_bodies_of_the_cage_stand_still_where_they_start_and_what_is_driven_is_said(to, tmp_path):
    jaw = CageBody("jaw", [(0.05, 0.0, 0.0)], shapes=[Box((0.01, 0.02, 0.01))], pose=Pose((0.03, 0.0, 0.0)))
    loads = [
        Load("weight", gravity=(0, 0, -9.81)),
        Load("grip", springs=[Spring((0, 0, 0), (0.02, 0, 0), 5.0, of="jaw")], drive={"jaw": Drive((-0.01, 0, 0))}),
        Load("close", drive={"jaw": Drive((-0.01, 0, 0))}),
    ]
    held = Object([Box((0.02, 0.02, 0.02))], mass_kg=1.0)
    scene = Scene(held, Cage([(0.0, 0.0, -0.01)], bodies=[jaw]), loads)
    alone = Cage(scene.cage.points_cage, scene.cage.names, shapes=scene.cage.shapes)
    export = exported(replace(run(Scene(held, alone, loads[:1])), scene=scene), to, "scene.xml")
    for file, content in export.files.items():
        (tmp_path / file).write_bytes(content)
    notes = " ".join(export.notes)
    assert "bodies of the cage stand still in the file where they start, as one with it: jaw" in notes
    assert "what is driven or presses in the scene is not in the file: grip, close" in notes
    found = imported.imported(str(tmp_path / "scene.xml")).scene
    assert found.cage.element_names == scene.cage.element_names
    assert found.cage.points_cage == pytest.approx(scene.cage.points_cage)
    assert [load.name for load in found.loads] == ["weight", "grip"]
    (spring,) = found.loads[1].springs
    assert (spring.of, spring.to_m) == (None, pytest.approx([0.05, 0.0, 0.0]))
