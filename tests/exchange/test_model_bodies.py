"""Models at a pose, what of them can touch, and bodies that stay bodies: they can be driven, and press."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cagepose import Scene, SceneFileError, load_scene, run, save_scene
from cagepose.cli.app import main
from cagepose.exchange.compile_model import compiled
from cagepose.exchange.export import exported
from cagepose.exchange.imported import imported
from cagepose.exchange.model_contacts import ModelContacts
from cagepose.exchange.model_text import read_model_text
from cagepose.files.record import from_record, record_of
from exchange.robots import mjcf, written

mujoco = pytest.importorskip("mujoco")
pytestmark = pytest.mark.usefixtures("here")

GRIPPER = """<mujoco><worldbody><body name="hand">
<body name="left"><joint name="l" type="slide" axis="1 0 0"/><geom type="box" size="0.01 0.02 0.02" pos="-0.05 0 0.1"/>
</body>
<body name="right"><joint name="r" type="slide" axis="-1 0 0"/><geom type="box" size="0.01 0.02 0.02" pos="0.05 0 0.1"/>
</body></body>
<body name="cube" pos="0 0 0.1"><freejoint name="c"/><geom name="cube" type="box" size="0.02 0.02 0.02"/></body>
</worldbody><keyframe><key name="closed" qpos="0.0198 0.0198 0 0 0.1 1 0 0 0"/></keyframe></mujoco>"""
"""Two jaws on slides, 0.2 mm from a cube of 40 mm on each side in the keyframe, 20 mm without it."""


@pytest.fixture
def gripper(tmp_path) -> Path:
    return written(tmp_path, grip_dot_xml=GRIPPER)


def jaw_gaps(scene) -> list[float]:
    """Return how far the jaws are from the cube along x, metres."""
    left, right = (shape.pose_body_shape.position_m[0] for shape in scene.cage.shapes)
    middle = scene.object.pose_world_object.position_m[0]
    return [middle - left - 0.03, right - middle - 0.03]


POSES = {
    "at rest": ({}, [0.02, 0.02]),
    "keyframe": ({"keyframe": "closed"}, [0.0002, 0.0002]),
    "its number": ({"keyframe": "0"}, [0.0002, 0.0002]),
    "all coordinates": ({"qpos": "0.01 0.02 0.001 0 0.1 1 0 0 0"}, [0.011, -0.001 + 0.0]),
    "some joints": ({"qpos": "l=0.015 c=0.001,0,0.1,1,0,0,0"}, [0.006, 0.019]),
    "a keyframe but for a joint": ({"keyframe": "closed", "qpos": "l=0.0195"}, [0.0005, 0.0002]),
}


@pytest.mark.parametrize("name", [name for name in POSES if name != "all coordinates"])
def test_bodies_are_taken_where_they_are_asked_for(name, gripper):
    asked, gaps = POSES[name]
    assert jaw_gaps(imported(str(gripper), **asked).scene) == pytest.approx(gaps, abs=1e-12)


def test_all_coordinates_are_taken_in_their_order(gripper):
    scene = imported(str(gripper), qpos="0.01 0.015 0.001 0 0.1 1 0 0 0").scene
    assert jaw_gaps(scene) == pytest.approx([0.011, 0.004], abs=1e-12)


WRONG_POSES = [
    ({"keyframe": "open"}, "has no keyframe 'open'; its keyframes: closed"),
    ({"keyframe": "7"}, "has no keyframe '7'; its keyframes: closed"),
    ({"qpos": "0 0"}, "has 9 coordinates of joints, and --qpos 2; give one for each, or JOINT=NUMBER for some;"),
    ({"qpos": "q=0"}, "has no joint 'q'; its joints: l, r, c"),
    ({"qpos": "c=1,2"}, "takes 7 numbers with commas between, position and quaternion, and --qpos 2; give so many"),
    ({"qpos": "l=far"}, "is given 'far' in --qpos, which is no finite number; correct it"),
    ({"qpos": "l=inf"}, "is given 'inf' in --qpos"),
]


@pytest.mark.parametrize(("asked", "message"), WRONG_POSES)
def test_a_pose_that_is_none_is_told(asked, message, gripper):
    with pytest.raises(SceneFileError) as refused:
        imported(str(gripper), **asked)
    assert message in str(refused.value)


def test_the_command_takes_a_keyframe(gripper, monkeypatch):
    monkeypatch.chdir(gripper.parent)
    assert main(["import", "grip.xml", "--keyframe", "closed", "--qpos", "l=0.0195", "-o", "grip.yaml"]) == 0
    assert jaw_gaps(load_scene("grip.yaml")) == pytest.approx([0.0005, 0.0002], abs=1e-12)


def test_jaws_stay_bodies_that_hold_the_cube_as_soon_as_they_press(gripper, tmp_path):
    """By hand: closed, they let it go 0.2 mm to either side and drop; with 20 N each and a friction of 0.3 they
    hold its 0.064 kg, and without friction no force does.
    """
    scene, notes, *_ = imported(str(gripper), keyframe="closed")
    assert [body.name for body in scene.cage.bodies] == ["left", "right"]
    assert scene.cage.element_names == ("left/box", "right/box")
    assert "bodies of the cage that no phase drives stand still: left, right" in notes
    assert run(scene).verdict == "escapes"
    sideways = run(scene.changed("loads[0].gravity", [1.0, 0.0, 0.0]))
    assert (sideways.verdict, sideways.pose.position_m[0]) == ("rests", pytest.approx(0.0002, abs=1e-12))
    jaws = {"left": {"force": 20.0, "along": [1, 0, 0]}, "right": {"force": 20.0, "along": [-1, 0, 0]}}
    weight = {"name": "hold", "gravity": [0, 0, -9.81], "press": jaws}
    pressed = scene.changed({"loads": [{"name": "close", "press": jaws}, weight], "friction.coefficient": 0.3})
    save_scene(pressed, tmp_path / "pressed.yaml")
    held = run(load_scene(tmp_path / "pressed.yaml"))
    assert [phase.verdict for phase in held.phases] == ["rests", "may rest"]  # wedged, it could turn, says Coulomb
    assert held.pose.position_m == pytest.approx((0.0, 0.0, 0.1), abs=1e-9)
    slippery = run(pressed.changed("friction.coefficient", 0.0))
    assert slippery.verdict == "escapes"


def test_jaws_can_be_driven(gripper):
    scene = imported(str(gripper), keyframe="closed").scene
    close = {"name": "close", "drive": {"left": {"travel": [0.0005, 0, 0]}}}
    driven = run(scene.changed("loads", [close]))
    assert driven.phases[-1].verdict in ("rests", "blocked", "stops")
    assert driven.pose.position_m[0] == pytest.approx(0.0002, abs=1e-9)  # as far as the other jaw lets it


CONTACTS = """<mujoco>{option}<worldbody>
<geom name="floor" type="plane" size="1 1 1" contype="2" conaffinity="4"/>
<body name="frame" pos="0 0 1"><geom name="frame" type="box" size=".1 .1 .1"/>
  <body name="arm" pos="0 0 1"><joint/><geom name="arm" type="box" size=".1 .1 .1"/>
    <body name="door" pos="1 0 0"><joint/><geom name="door" type="box" size=".1 .1 .1"/>
      <geom name="knob" type="sphere" size=".05" pos="0 .2 0" contype="4" conaffinity="1"/>
      <body name="latch" pos="0 0 .5"><joint/><geom name="latch" type="capsule" size=".05 .1"/>
</body></body></body></body>
<body name="box" pos="3 0 1"><freejoint/><geom name="box" type="box" size=".1 .1 .1"/></body>
<body name="shade" pos="5 0 1"><joint/><geom name="shade" type="box" size=".1 .1 .1"/></body>
</worldbody><contact><exclude body1="door" body2="shade"/><pair geom1="latch" geom2="floor"/></contact></mujoco>"""


@pytest.mark.parametrize("option", ["", '<option><flag filterparent="disable"/></option>'])
def test_pairs_are_those_of_mujoco(option, tmp_path):
    """The oracle is MuJoCo itself: all bodies are put on one place, and it lists what touches."""
    source = written(tmp_path, contacts_dot_xml=CONTACTS.format(option=option))
    found = compiled(read_model_text(str(source)), str(source))
    geoms = found["geoms"]
    ours = {frozenset(pair) for pair in ModelContacts(found).touching(geoms, geoms) if len(set(pair)) == 2}
    spec = mujoco.MjSpec.from_file(str(source))
    for body in spec.bodies[1:]:
        body.pos = [0.0, 0.0, 0.0]
    for geom in spec.geoms:
        geom.pos = [0.0, 0.0, 0.0]
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qpos[:] = model.qpos0
    mujoco.mj_forward(model, data)
    there = {frozenset(map(int, pair)) for pair in data.contact.geom}
    names = {number: geom["name"] for number, geom in enumerate(geoms)}
    one_body = {frozenset((a, b)) for a in names for b in names if geoms[a]["body"] == geoms[b]["body"]}
    fixed = {frozenset((0, 1))}  # the floor and the frame are one for MuJoCo
    assert {tuple(sorted(names[n] for n in pair)) for pair in ours - one_body - fixed} == {
        tuple(sorted(names[n] for n in pair)) for pair in there
    }


def test_what_cannot_touch_the_object_is_not_in_its_cage(tmp_path):
    source = written(tmp_path, contacts_dot_xml=CONTACTS.format(option=""))
    scene, notes, *_ = imported(str(source), "door")
    assert scene.object.element_names == ("door", "knob", "latch")
    assert set(scene.cage.element_names) == {"frame", "arm/arm", "box/box", "floor", "shade/shade"}
    assert any("touch some parts of the object only: here, all" in note for note in notes)
    scene, notes, *_ = imported(str(source), "shade", ["door"])
    assert "latch/latch" in scene.cage.element_names
    assert "left out, as in the model they do not touch the object: door, knob" in notes
    with pytest.raises(SceneFileError, match="lets no shape of the object touch one of the cage"):
        imported(str(source), "latch", ["door"])


def test_names_of_bodies_and_of_their_geoms_are_all_different(tmp_path):
    jaw = '<body name="jaw" pos="{}"><joint type="slide"/><geom name="{}" type="sphere" size=".1"/></body>'
    world = jaw.format("1 0 1", "jaw") + jaw.format("2 0 1", "cube").replace('"jaw"', '"other"')
    cube = '<body name="cube" pos="0 0 .5"><freejoint/><geom type="box" size=".1 .1 .1"/><geom size=".01"/></body>'
    still = '<geom name="other" type="box" size=".1 .1 .1" pos="4 0 0"/>'
    scene = imported(str(written(tmp_path, names_dot_xml=mjcf(world + cube + still)))).scene
    names = [*scene.cage.element_names, *(body.name for body in scene.cage.bodies), *scene.object.element_names]
    assert len(set(names)) == len(names)
    assert {"jaw", "other", "jaw/jaw", "other/cube"} < set(names)


BURIED = """<body name="cube" pos="0 0 {z}"><freejoint/><geom type="box" size="0.02 0.02 0.02"/></body>
<geom name="table" type="box" size="0.2 0.2 0.05" pos="0 0 0.05"/>"""


def test_an_object_that_is_hardly_in_its_cage_is_lifted_out(tmp_path):
    """As models have it that were settled in MuJoCo: 0.3 mm below the top of a table, at z = 100 mm."""
    scene, notes, *_ = imported(str(written(tmp_path, cube_dot_xml=mjcf(BURIED.format(z=0.1197)))))
    assert "the object starts 0.3003 mm higher, as it is in 'table' there" in notes
    assert scene.left_out == ()
    assert run(scene).pose.position_m[2] == pytest.approx(0.12, abs=1e-9)


def test_what_the_object_is_deep_in_is_left_out_and_each_run_warns(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    written(tmp_path, cube_dot_xml=mjcf(BURIED.format(z=0.08)))
    assert main(["import", "cube.xml", "-o", "cube.yaml"]) == 0
    assert "note: left out: 'table', as the object starts 40 mm inside it; choose another pose with --keyf" in (
        capsys.readouterr().out
    )
    scene = load_scene("cube.yaml")
    assert scene.left_out == ("table",)
    warning = "the source of this scene also has table, which is left out here"
    for command in (["run", "cube.yaml"], ["check", "cube.yaml"]):
        main(command)
        shown = capsys.readouterr()
        assert warning in shown.out + shown.err, command
    ended = run(scene)
    assert (ended.verdict, ended.pose.position_m[2]) == ("rests", pytest.approx(0.02, abs=1e-9))
    assert any(warning in said for said in ended.warnings)


def test_what_is_left_out_stays_said(tmp_path):
    """In files, records, exports, and scenes with a changed number."""
    source = written(tmp_path, cube_dot_xml=mjcf(BURIED.format(z=0.08)))
    scene = imported(str(source)).scene.changed("object.mass", 2.0)
    save_scene(scene, tmp_path / "cube.yaml")
    exported_file = next(iter(exported(run(scene), "mjcf", "cube.xml").files.values()))
    source.write_bytes(exported_file)
    again = (
        scene,
        load_scene(tmp_path / "cube.yaml"),
        from_record(Scene, record_of(scene)),
        imported(str(source)).scene,
    )
    assert [one.left_out for one in again] == [("table",)] * 4


def test_an_object_inside_all_of_its_cage_is_told_to_stand_elsewhere(tmp_path):
    world = BURIED.format(z=0.08).replace('name="table"', 'name="table" contype="2" conaffinity="1"')
    source = written(tmp_path, cube_dot_xml=f"<mujoco><worldbody>{world}</worldbody></mujoco>")
    with pytest.raises(SceneFileError, match=r"inside all of its cage \('table'\); choose another pose with --key"):
        imported(str(source))


def test_an_object_inside_of_much_is_told_to_stand_elsewhere(tmp_path):
    balls = "".join(f'<geom size="0.1" pos="0 0 {0.08 + 1e-3 * k}"/>' for k in range(25))
    with pytest.raises(SceneFileError, match="has the object inside more than 20 shapes of its cage, 'geom"):
        imported(str(written(tmp_path, cube_dot_xml=mjcf(BURIED.format(z=0.08) + balls))))


def test_too_many_shapes_are_told_by_their_number(tmp_path):
    cube = '<body name="cube" pos="0 0 3"><freejoint/><geom size=".1"/></body>'
    with pytest.raises(SceneFileError, match=r"has 2,101 shapes in object and cage; choose at most 2,000 with --cage"):
        imported(str(written(tmp_path, cube_dot_xml=mjcf(cube + 2099 * '<geom size=".1"/>'))))


def test_inertia_that_no_body_has_becomes_one(tmp_path):
    inertial = '<inertial pos="0 0 0" mass="2" diaginertia="1 1 7"/>'
    cube = f'<body name="cube" pos="0 0 1"><freejoint/>{inertial}<geom type="box" size="1 1 1"/></body>'
    scene, notes, *_ = imported(str(written(tmp_path, cube_dot_xml=mjcf(cube))))
    assert "the moments of inertia of cube are none of any body: here, their mean" in notes
    assert scene.object.mass_kg == 2.0
    assert np.diag(scene.object.inertia_kg_m2) == pytest.approx([3.0, 3.0, 3.0])
