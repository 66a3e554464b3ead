"""Shapes of models: ellipsoids, hulls of any size, meshes of URDF as they are, and meshes that enclose nothing."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cagepose import SceneFileError, run
from cagepose.exchange import model_shapes
from cagepose.exchange.ellipsoid import rounded_hull
from cagepose.exchange.imported import imported
from cagepose.model.shape_moments import shape_moments
from cagepose.model.shapes import Convex
from exchange.robots import BOX_SIDES, box_corners, box_obj, frame_obj, mjcf, obj, peg_urdf, post_obj, written

pytest.importorskip("mujoco")
pytestmark = pytest.mark.usefixtures("here")

MESH = '<body name="part" pos="0 0 0.2"><freejoint/><geom name="part" type="mesh" mesh="part"/>{}</body>'
ASSET = '<mesh name="part" file="part.obj"/>'
LOW, HIGH = (-0.02, -0.01, -0.005), (0.02, 0.01, 0.005)


def support(semi_axes: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """Return how far an ellipsoid reaches along unit vectors."""
    return np.linalg.norm(directions * semi_axes, axis=1)


@pytest.mark.parametrize("semi_axes", [(0.03, 0.03, 0.04), (0.03, 0.02, 0.01), (0.1, 0.01, 0.01), (1.0, 1.0, 0.2)])
def test_a_rounded_hull_is_within_the_ellipsoid_and_off_by_what_it_says(semi_axes):
    axes = np.array(semi_axes)
    found = rounded_hull(axes)
    directions = np.random.default_rng(3).normal(size=(20_000, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    off = support(axes, directions) - (directions @ found.core_m.T).max(axis=1) - found.radius_m
    assert off.min() > -1e-12
    assert 0.5 * found.off_m < off.max() < 1.001 * found.off_m
    assert found.off_m < 0.01 * axes.max()
    for axis in (*np.eye(3), *-np.eye(3)):
        assert (found.core_m @ axis).max() + found.radius_m == pytest.approx(support(axes, axis[None])[0], abs=1e-12)
    hull = shape_moments(Convex(found.core_m, found.radius_m))
    assert hull.volume_m3 == pytest.approx(4.0 / 3.0 * math.pi * axes.prod(), rel=0.05)


def test_an_egg_rests_on_its_side(tmp_path):
    """On the floor its centre is 30 mm high; on its end, where it starts, 40 mm, and that is unstable."""
    egg = (
        '<body name="egg" pos="0 0 0.1" {}><freejoint/><geom name="egg" type="ellipsoid" size="0.03 0.03 0.04"/></body>'
    )
    scene, notes, *_ = imported(str(written(tmp_path, egg_dot_xml=mjcf(egg.format('euler="40 0 0"')))))
    assert notes[0].startswith(
        "'egg' is an ellipsoid; here, a hull of 146 corners with round edges within it, up to 0.26"
    )
    ended = run(scene)
    assert ended.verdict == "rests"
    assert ended.pose.position_m[2] == pytest.approx(0.03, abs=0.26e-3)
    upright = run(imported(str(written(tmp_path, egg_dot_xml=mjcf(egg.format(""))))).scene)
    assert upright.pose.position_m[2] == pytest.approx(0.04, abs=1e-12)
    assert upright.phases[-1].proof.stability == "unstable"
    ball = imported(str(written(tmp_path, egg_dot_xml=mjcf(egg.format("").replace("0.04", "0.03"))))).scene
    assert [part.kind for part in ball.object.parts] == ["sphere"]


@pytest.mark.parametrize("n_sides", [100, 200])
@pytest.mark.parametrize("beside", ["", '<geom type="capsule" size="0.01" fromto="0 0 0.05 0.2 0 0.05"/>'])
def test_a_ball_rests_on_a_post_of_many_corners(n_sides, beside, tmp_path):
    """The post is 100 mm high and the ball's radius 20 mm. Facets may not stand beside what is round, so that a hull of
    many corners is one there.
    """
    post = f'<body name="post"><geom name="post" type="mesh" mesh="part"/>{beside}</body>'
    ball = '<body name="ball" pos="0.005 0 0.16"><freejoint/><geom type="sphere" size="0.02"/></body>'
    source = written(tmp_path, part_dot_obj=post_obj(n_sides, 0.04, 0.1), post_dot_xml=mjcf(post + ball, asset=ASSET))
    scene = imported(str(source)).scene
    post_kind = "facets" if n_sides == 200 and not beside else "convex"
    assert next(shape.kind for shape in scene.cage.shapes if shape.name == "post") == post_kind
    ended = run(scene)
    assert ended.pose.position_m[2] == pytest.approx(0.12, abs=1e-7)
    assert {contact.point for contact in ended.contacts} == {"post"}


OPEN = {
    "open": obj(box_corners(LOW, HIGH), BOX_SIDES[1:]),
    "one side turned": obj(box_corners(LOW, HIGH), [BOX_SIDES[0][::-1], *BOX_SIDES[1:]]),
}


@pytest.mark.parametrize("inertia", ["", 'inertia="exact"', 'inertia="legacy"'])
@pytest.mark.parametrize("name", OPEN)
def test_a_mesh_that_encloses_nothing_weighs_what_its_hull_does(name, inertia, tmp_path):
    """Without care MuJoCo refuses it (exact), or gives it what no volume of it is."""
    asset = ASSET.replace("/>", f" {inertia}/>")
    source = written(tmp_path, part_dot_obj=OPEN[name], part_dot_xml=mjcf(MESH.format(""), asset=asset))
    scene, notes, *_ = imported(str(source))
    off = ", about 4.8 mm off at most" if name == "open" else ""  # half the width of the missing side is 5
    assert f"the mesh 'part' is open, or its sides are not all turned alike: here, its hull{off}" in notes
    assert any(note.startswith("no volume is within the mesh of part; where mass, centre") for note in notes)
    sides = 2.0 * np.array(HIGH)
    mass = 1000.0 * sides.prod()
    assert scene.object.mass_kg == pytest.approx(mass, rel=1e-6)
    assert scene.object.center_of_gravity_m == pytest.approx(np.zeros(3), abs=1e-8)
    expected = mass / 12.0 * ((sides**2).sum() - sides**2)
    assert np.diag(scene.object.inertia_kg_m2) == pytest.approx(expected, rel=1e-6)


def test_a_mesh_that_is_inside_out_is_the_body_within(tmp_path):
    turned = obj(box_corners(LOW, HIGH), [side[::-1] for side in BOX_SIDES])
    scene = imported(str(written(tmp_path, part_dot_obj=turned, p_dot_xml=mjcf(MESH.format(""), asset=ASSET)))).scene
    assert scene.object.mass_kg == pytest.approx(8e-3, rel=1e-6)


def test_a_shell_keeps_its_own_inertia(tmp_path):
    asset = ASSET.replace("/>", ' inertia="shell"/>')
    box = box_obj(LOW, HIGH)
    scene = imported(str(written(tmp_path, part_dot_obj=box, p_dot_xml=mjcf(MESH.format(""), asset=asset)))).scene
    x, y, z = 2.0 * np.array(HIGH)
    assert scene.object.mass_kg == pytest.approx(1000.0 * 2.0 * (x * y + y * z + z * x), rel=1e-6)


def test_a_flat_mesh_is_left_out_and_each_run_warns(tmp_path):
    flat = obj(box_corners(LOW, (HIGH[0], HIGH[1], LOW[2])), BOX_SIDES)
    body = MESH.format('<geom type="box" size="0.02 0.02 0.02"/>')
    scene, notes, *_ = imported(str(written(tmp_path, part_dot_obj=flat, p_dot_xml=mjcf(body, asset=ASSET))))
    assert "left out: 'part', a mesh without volume; give it a thickness" in notes
    assert scene.left_out == ("part",)
    assert any("also has part" in warning for warning in run(scene).warnings)


def with_frame(mesh: str) -> str:
    """Return a URDF of a peg above a frame of a mesh, whose top is at z = 0."""
    return peg_urdf("peg.obj", z=0.001).replace('<box size="0.2 0.2 0.1"/>', f'<mesh filename="{mesh}"/>')


def test_a_mesh_of_urdf_is_what_it_is_and_one_of_mjcf_its_hull(tmp_path):
    """A peg of 8 x 7 mm over a square hole of 10 mm in a plate of 20 mm thickness, whose top is at z = 0. What URDF
    calls a mesh is the mesh: the peg falls through. MuJoCo's meshes are their hulls: it stands on the plate.
    """
    peg = box_obj((-0.004, -0.0035, 0.0), (0.004, 0.0035, 0.05))
    plate = frame_obj(0.05, 0.005, 0.02)
    urdf = with_frame("plate.obj").replace('xyz="0 0 -0.05"', 'xyz="0 0 0" rpy="0 0 0.1"')
    scene, notes, *_ = imported(str(written(tmp_path, plate_dot_obj=plate, peg_dot_obj=peg, p_dot_urdf=urdf)))
    assert not any("its hull" in note for note in notes)
    solid = 4.0 * (0.05**2 - 0.005**2) * 0.02
    assert sum(shape_moments(shape).volume_m3 for shape in scene.cage.shapes) == pytest.approx(solid, rel=1e-6)
    assert run(scene).verdict == "escapes"
    world = (
        '<geom name="plate" type="mesh" mesh="plate"/><body name="peg" pos="0 0 0.001"><freejoint/>'
        '<geom type="mesh" mesh="peg"/></body>'
    )
    asset = '<mesh name="plate" file="plate.obj"/><mesh name="peg" file="peg.obj"/>'
    model = mjcf(world, asset=asset).replace('size="1 1 1"', 'size="1 1 1" pos="0 0 -1"')
    scene, notes, *_ = imported(str(written(tmp_path, p_dot_xml=model)))
    said = "the mesh 'plate' is not convex: here, its hull, 1.0% of which is too much, about 9.8 mm off at most"
    assert said in notes  # the middle of the hole's wall is 10 mm below the top
    ended = run(scene)
    assert (ended.verdict, ended.pose.position_m[2]) == ("rests", pytest.approx(0.0, abs=1e-7))


def test_scales_of_urdf_count_along_their_axes(tmp_path):
    peg = box_obj((-0.004, -0.0035, 0.0), (0.004, 0.0035, 0.05))
    urdf = with_frame("plate.obj").replace('filename="plate.obj"', 'filename="plate.obj" scale="0.001 0.002 0.001"')
    urdf = urdf.replace('xyz="0 0 -0.05"', 'xyz="0 0 0"')
    source = written(tmp_path, plate_dot_obj=frame_obj(50.0, 3.0, 20.0), peg_dot_obj=peg, p_dot_urdf=urdf)
    scene, *_ = imported(str(source))
    solid = 2.0 * 4.0 * (0.05**2 - 0.003**2) * 0.02
    assert sum(shape_moments(shape).volume_m3 for shape in scene.cage.shapes) == pytest.approx(solid, rel=1e-6)
    ended = run(scene)
    assert (ended.verdict, ended.pose.position_m[2]) == ("rests", pytest.approx(0.0, abs=1e-7))  # 6 mm are too narrow


def test_a_mesh_of_bodies_in_each_other_is_all_of_them(tmp_path):
    corners = [*box_corners(LOW, HIGH), *box_corners((-0.005, -0.02, -0.02), (0.005, 0.02, 0.02))]
    cross = obj(corners, [*BOX_SIDES, *(tuple(8 + k for k in side) for side in BOX_SIDES)])
    scene = imported(str(written(tmp_path, peg_dot_obj=cross, p_dot_urdf=peg_urdf("peg.obj", z=0.1)))).scene
    assert sorted(sorted(part.size_m.tolist()) for part in scene.object.parts) == [
        pytest.approx([0.01, 0.02, 0.04], abs=1e-9),
        pytest.approx([0.01, 0.04, 0.04], abs=1e-9),
    ]


def test_a_mesh_of_many_triangles_is_its_hull(tmp_path, monkeypatch):
    monkeypatch.setattr(model_shapes, "MOST_TRIANGLES", 10)
    peg = box_obj((-0.004, -0.0035, 0.0), (0.004, 0.0035, 0.05))
    urdf = with_frame("plate.obj").replace('xyz="0 0 -0.05"', 'xyz="0 0 0"')
    source = written(tmp_path, plate_dot_obj=frame_obj(0.05, 0.005, 0.02), peg_dot_obj=peg, p_dot_urdf=urdf)
    _, notes, *_ = imported(str(source))
    assert any(
        note.startswith("the mesh 'geom 2' is its hull here, about 9.8 mm off at most, as it has") for note in notes
    )


def test_a_mesh_of_facets_beside_what_is_round_is_its_hull(tmp_path):
    """No method runs the one that touches the other in a body, so that the import takes hulls."""
    star = post_obj(12, 0.01, 0.05).splitlines()
    dented = [
        f"v {' '.join(f'{0.6 * float(x):.6f}' for x in line.split()[1:3])} {line.split()[3]}" if k % 2 else line
        for k, line in enumerate(star)
        if line.startswith("v")
    ]
    mesh = "\n".join([*dented, *(line for line in star if line.startswith("f"))])
    urdf = peg_urdf("peg.obj", z=0.1).replace(
        "</collision></link>\n<joint",
        '</collision><collision><geometry><sphere radius="0.02"/></geometry></collision></link>\n<joint',
    )
    scene, notes, *_ = imported(str(written(tmp_path, peg_dot_obj=mesh, p_dot_urdf=urdf)))
    assert any(note.startswith("meshes are their hulls here: of the meshes themselves, one") for note in notes)
    assert {part.kind for part in scene.object.parts} == {"convex", "sphere"}


def test_a_height_field_and_nothing_else_is_no_cage(tmp_path):
    field = '<hfield name="h" nrow="2" ncol="2" size="1 1 .1 .1" elevation="0 1 1 0"/>'
    ball = '<body name="b" pos="0 0 1"><freejoint/><geom size=".1"/></body>'
    world = f'<geom name="terrain" type="hfield" hfield="h"/>{ball}'
    only = f"<mujoco><asset>{field}</asset><worldbody>{world}</worldbody></mujoco>"
    with pytest.raises(
        SceneFileError, match="has nothing that touches but 'terrain', a height field; give its surface"
    ):
        imported(str(written(tmp_path, only_dot_xml=only)))
    scene, notes, *_ = imported(str(written(tmp_path, both_dot_xml=mjcf(world, asset=field))))
    assert "left out: 'terrain', a height field; give its surface as a mesh, in convex pieces" in notes
    assert scene.left_out == ("terrain",)
