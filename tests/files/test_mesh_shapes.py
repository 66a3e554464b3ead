"""Bodies of triangles are recognised as what they stand for: known shapes, and a hand answer for each error."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np
import pytest

from cagepose import (
    Box,
    Capsule,
    Cone,
    Convex,
    Cylinder,
    Hole,
    Pose,
    Scene,
    SceneError,
    SceneFileError,
    Sphere,
    load_scene,
)
from cagepose.cli.app import main
from cagepose.exchange.stl import binary_stl
from cagepose.files.meshes import decomposed, mesh_file, run_coacd
from cagepose.files.meshes.manifolds import Triangles
from cagepose.model.checks import ProblemList
from cagepose.model.surface import Mesh, shape_mesh
from cagepose.model.union import body_moments
from files.bodies import PLACE, SEGMENTS, body, shapes_of

manifold3d = pytest.importorskip("manifold3d")
pytest.importorskip("trimesh")


@pytest.mark.parametrize(("single", "rounding"), [(False, 1e-9), (True, 3e-6)])
@pytest.mark.parametrize(
    "shape",
    [
        Cylinder(2.0, 7.0),
        Cylinder(2.0, 0.05),
        Cylinder(2.0, 2.0 * math.sqrt(3.0)),  # no axis stands out by its inertia
        Cone(3.0, 1.0, 4.0),
        Cone(3.0, 0.0, 4.0),
        Sphere(2.0),
        Capsule(2.0, 9.0),
        Capsule(2.0, 0.5),
    ],
    ids=lambda shape: repr(shape),
)
def test_what_is_round_is_recognised_with_the_sagitta_as_its_error(shape, single, rounding):
    """A chord of 1/64 of a circle is r (1 - cos(pi / 64)) within it; a ball's faces, a little more."""
    found = shapes_of(body(shape), single=single)
    (one,) = found.shapes
    assert type(one) is type(shape)
    lengths, wanted = (
        sorted(value for key, value in vars(each).items() if key.endswith("_m")) for each in (one, shape)
    )  # a cone may stand on its head
    assert lengths == pytest.approx(wanted, abs=10 * rounding)
    assert one.pose_body_shape.position_m == pytest.approx(PLACE.position_m, abs=10 * rounding)
    axis = one.pose_body_shape.rotation[:, 2] @ PLACE.rotation[:, 2]
    assert isinstance(shape, Sphere) or abs(axis) == pytest.approx(1.0, abs=1e-9 if not single else 1e-6)
    radius = max(getattr(shape, key) for key in vars(shape) if key.startswith("radius"))
    sagitta = radius * (1.0 - math.cos(math.pi / SEGMENTS))
    assert sagitta * (1.0 - 1e-3) < found.error < 2.1 * sagitta
    assert found.notes == (f"'part' has flat sides where it is round here, up to {found.error:.2g} mm off",)


CORE = np.array([(x, y, z) for x in (-20.0, 20.0) for y in (-10.0, 10.0) for z in (-4.0, 4.0)])
CORES = {"block": CORE, "slab": CORE[::2], "tetrahedron": CORE[[0, 3, 5, 6]], "triangle": CORE[:5:2]}


@pytest.mark.parametrize(("single", "rounding"), [(False, 1e-9), (True, 1e-5)])
@pytest.mark.parametrize("name", CORES)
def test_a_hull_that_is_round_all_over_is_recognised(name, single, rounding):
    """Its corners are found to the last digits, and its error is that of the faces about a corner."""
    found = shapes_of(body(Convex(CORES[name], 1.5)), single=single)
    (one,) = found.shapes
    assert isinstance(one, Convex)
    assert one.radius_m == pytest.approx(1.5, abs=rounding)
    corners, wanted = (np.array(sorted(c.round(3).tolist())) for c in (one.vertices_m, PLACE.transform(CORES[name])))
    assert corners == pytest.approx(wanted, abs=2e-3)
    assert max(gap_of(one, corner) for corner in PLACE.transform(CORES[name])) < rounding
    sagitta = 1.5 * (1.0 - math.cos(math.pi / SEGMENTS))
    assert sagitta * (1.0 - 1e-3) < found.error < 6.0 * sagitta


def test_a_hull_whose_edges_are_round_with_two_radii_stays_flat():
    """And one that is nearly round all over."""
    two = body(Convex(CORE, 1.5), Convex(CORE * (1.0, 1.0, 0.5), 3.0)).hull()
    stretched = body(Convex(CORE, 1.5)).scale((1.0, 1.0, 1.01))
    for solid in (two, stretched):
        (one,) = shapes_of(solid).shapes
        assert one.radius_m == 0.0


def test_prisms_and_what_is_nearly_round_stay_as_they_are():
    octagon = Convex(shape_mesh(Cylinder(2.0, 5.0), 8).vertices_m)
    flattened = shape_mesh(Cylinder(2.0, 5.0), 64).vertices_m * (1.0, 1.001, 1.0)
    side = shape_mesh(Cylinder(2.0, 5.0), 64).vertices_m
    for shape in (octagon, Convex(flattened), Convex(side[side[:, 0] < 1.5])):
        found = shapes_of(body(shape))
        assert isinstance(found.shapes[0], Convex)
        assert found.error == 0.0


PLATE = Box((60.0, 40.0, 10.0))
UNIONS = {
    "L": ((Box((40, 10, 10)), Box((10, 30, 10), Pose((-15, 10, 0)))), (), "box box"),
    "channel": ((PLATE,), (Box((70, 20, 12), Pose((0, 0, 5))),), "box box box"),
    "frame": ((PLATE,), (Box((40, 20, 20)),), "box box box box"),
    "cavity": ((PLATE,), (Box((40, 20, 6)),), "box box box box box box"),
    "boss": ((PLATE, Cylinder(8, 20, Pose((5, 0, 10)))), (), "box cylinder"),
    "apart": ((PLATE, Sphere(5, Pose((0, 0, 40)))), (), "box sphere"),
    "through": ((PLATE,), (Cylinder(5, 30),), "box hole"),
    "blind": ((PLATE,), (Cylinder(5, 10, Pose((9, 0, 5))),), "box hole"),
    "ring": ((Cylinder(20, 10),), (Cylinder(10, 30),), "cylinder hole"),
    "bored boss": (
        (PLATE, Cylinder(8, 20, Pose((5, 0, 10)))),
        (Cylinder(5, 60, Pose((5, 0, 0))),),
        "box cylinder hole",
    ),
    "counterbore": ((PLATE,), (Cylinder(5, 60), Cylinder(9, 8, Pose((0, 0, 5)))), "box box hole hole"),
    "two holes": (
        (PLATE,),
        (Cylinder(5, 30, Pose((12, 0, 0))), Cylinder(6, 30, Pose((-12, 0, 0)))),
        "box hole hole",
    ),
}


@pytest.mark.parametrize("single", [False, True])
@pytest.mark.parametrize("name", UNIONS)
def test_unions_come_back_as_their_parts(name, single):
    """Which fill the same volume: that of the mesh but for what its chords cut off."""
    added, without, kinds = UNIONS[name]
    solid = body(*added, without=without)
    found = shapes_of(solid, single=single)
    assert " ".join(sorted(shape.kind for shape in found.shapes)) == kinds
    parts = [shape for shape in found.shapes if not isinstance(shape, Hole)]
    holes = [shape for shape in found.shapes if isinstance(shape, Hole)]
    assert all(hole.in_ for hole in holes)
    moments = body_moments(parts, holes)
    is_round = any(not isinstance(shape, Box) for shape in (*added, *without))
    assert moments.volume_m3 == pytest.approx(solid.volume(), rel=2e-3 if is_round else 3e-6)
    assert moments.centroid_m == pytest.approx(PLACE.transform(centroid_of(solid)), abs=0.02 if is_round else 1e-5)


def centroid_of(solid):
    from cagepose.model.shape_moments import mesh_sums

    mesh = Triangles.of(solid)
    sums = mesh_sums(Mesh(mesh.vertices, mesh.faces), np.zeros(3))
    return sums.first / sums.volume


def gap_of(shape: Convex, point) -> float:
    """How far a point is from a convex shape: the nearest mean of its corners, by SciPy's NNLS."""
    from scipy.optimize import nnls

    large = 1e3
    rows = np.vstack([shape.vertices_m.T, large * np.ones(len(shape.vertices_m))])
    weights = nnls(rows, np.append(point, large))[0]
    return float(np.linalg.norm(shape.vertices_m.T @ weights / weights.sum() - point))


def torus() -> Triangles:
    section = manifold3d.CrossSection.circle(3.0, 8).translate((10.0, 0.0))
    return Triangles.of(manifold3d.Manifold.revolve(section, 16))


def test_what_cannot_be_cut_is_decomposed_with_its_error_and_kept(tmp_path, monkeypatch):
    """The error is at least what any point of the mesh is off, and the parts are found once."""
    pytest.importorskip("coacd")
    pytest.importorskip("rtree")
    monkeypatch.setattr(run_coacd, "MOST_CONCAVITY", 0.2)
    calls = []
    plain = decomposed.decomposed
    monkeypatch.setattr(decomposed, "decomposed", lambda mesh: calls.append(1) or plain(mesh))
    (tmp_path / "ring.stl").write_bytes(binary_stl(Mesh(torus().vertices, torus().faces)))
    first = mesh_file.read_mesh(tmp_path / "ring.stl", "mm", "mm", "ring")
    assert all(isinstance(shape, Convex) for shape in first.shapes)
    assert len(first.shapes) > 3
    assert f"here, {len(first.shapes)} convex parts, up to {1e3 * first.error:.2g} mm off" in first.notes[0]
    assert "'ring' has 1 openings that are not round with flat ends" in first.notes[1]
    within = [shape.holds(torus().vertices / 1e3) for shape in first.shapes]
    outside = torus().vertices[~np.any(within, axis=0)] / 1e3
    assert 1e-4 < first.error < 3e-3
    gaps = [min(gap_of(shape, point) for shape in first.shapes) for point in outside]
    assert max(gaps) < 1.01 * first.error
    mesh_file._shapes.cache_clear()
    again = mesh_file.read_mesh(tmp_path / "ring.stl", "mm", "mm", "ring")
    assert len(calls) == 1
    assert [shape.vertices_m.tolist() for shape in again.shapes] == [s.vertices_m.tolist() for s in first.shapes]
    (tmp_path / "ring.stl.parts.json").write_text("{")
    mesh_file._shapes.cache_clear()
    mesh_file.read_mesh(tmp_path / "ring.stl", "mm", "mm", "ring")
    assert len(calls) == 2


SCENE = """\
name: bored plate on a peg
object:
  shapes:
    - {mesh: {file: plate.stl}, name: plate, friction: 0.3}
    - {sphere: {radius: 3}, position: [20, 0, 8], name: knob}
    - {hole: {radius: 4, depth: 10, in: [plate]}, position: [-20, 0, 5], name: drilled}
  mass: 1
cage: {points: [[20, 15, -5.1], [20, -15, -5.1], [-25, 0, -5.1]]}
loads: [{name: weight, gravity: [0, 0, -9.81]}]
"""


def scene_with(folder: Path, added, without, text=SCENE) -> Scene:
    solid = Triangles.of(body(*added, without=without))
    (folder / "plate.stl").write_bytes(binary_stl(Mesh(solid.vertices, solid.faces)))
    (folder / "scene.yaml").write_text(text)
    return load_scene(folder / "scene.yaml")


@pytest.mark.usefixtures("in_this_process")
def test_a_mesh_of_several_shapes_stands_in_a_scene(tmp_path, capsys):
    """Its friction and holes in it are those of all its pieces; the shapes after it keep their numbers."""
    scene = scene_with(tmp_path, UNIONS["boss"][0], (Cylinder(5, 60, Pose((5, 0, 0))),))
    assert scene.object.element_names == ("plate/1", "knob", "plate/2", "drilled", "plate/hole 1")
    assert scene.friction_of == {"plate/1": 0.3, "plate/2": 0.3}
    assert {hole.name: hole.in_ for hole in scene.object.holes} == {
        "plate/hole 1": ("plate/1", "plate/2"),
        "drilled": ("plate/1", "plate/2"),
    }
    assert main(["run", str(tmp_path / "scene.yaml")]) == 0
    capsys.readouterr()
    assert main(["check", str(tmp_path / "scene.yaml")]) == 0
    assert "note: 'plate' has flat sides where it is round here, up to 0.0096 mm off" in capsys.readouterr().out


@pytest.mark.usefixtures("in_this_process")
def test_numbers_of_a_mesh_of_several_shapes_cannot_be_adjusted(tmp_path):
    text = SCENE.replace(".stl}", ".stl}, position: [0, 0, 0]")
    text += 'adjustable: {x: {key: "object.shapes[0].position[0]", range: [0, 1]}}\n'
    with pytest.raises(SceneFileError, match=r"adjustable.x.key: points into a mesh that is several shapes"):
        scene_with(tmp_path, UNIONS["boss"][0], (), text)


def test_a_fillet_in_a_mesh_is_named_and_a_hole_beside_it_goes_through_all_that_it_cuts():
    """Its flat sides cut the plate below into thin wedges, which all have to let the peg through."""
    corner = body(
        Box((6, 40, 6), Pose((10, 0, 10))),
        without=(Cylinder(5, 60, Pose((13, 0, 13), euler_zyx=(0, 0, math.pi / 2))),),
    )
    walls = body(Box((60, 40, 8), Pose((30, 0, 4))), Box((8, 40, 50), Pose((4, 0, 25))))
    bored = walls + corner - body(Cylinder(4, 30, Pose((40, 0, 4))))
    found = shapes_of(bored)
    (hole,) = (shape for shape in found.shapes if isinstance(shape, Hole))
    problems = ProblemList()
    hole.check_mouth([shape for shape in found.shapes if shape.name in hole.in_], (), problems)
    assert not problems.problems
    middle = hole.pose_body_shape.transform(
        [(x, y, z) for x in (-3, 0, 3) for y in (-2, 0, 2) for z in (-0.1, -1, -4, -7.9)]
    )
    for shape in found.shapes:
        assert shape is hole or shape.name in hole.in_ or not shape.holds(middle).any()
    assert found.notes[-1].startswith(
        "'part' is hollow and round somewhere, as in a fillet, which makes many parts of it: here, "
    )
    assert not any("hollow" in note for note in shapes_of(walls).notes)


def test_holes_of_a_finely_divided_plate_are_recognised():
    """Corners lie throughout its faces and along the edges of its walls, of which one pass leaves some."""
    plate = body(PLATE, without=tuple(Cylinder(5, 30, Pose((x, 0, 0))) for x in (-15.0, 15.0)))
    found = shapes_of(plate.refine_to_length(0.6), single=True)
    assert [shape.kind for shape in found.shapes] == ["box", "hole", "hole"]
    assert found.error == pytest.approx(5 * (1 - math.cos(math.pi / SEGMENTS)), rel=0.01)


def test_a_convex_body_of_many_corners_keeps_as_many_as_may_be_and_their_distance_is_measured():
    """Corners of an egg: what 300 of them leave of a ball of radius 20 is some 20 (1 - cos(7 deg))."""
    egg = shape_mesh(Sphere(20.0), 80)
    found = shapes_of(Triangles(egg.vertices_m * (1.0, 0.7, 0.5), egg.triangles).body())
    (one,) = found.shapes
    assert 250 <= len(one.vertices_m) <= 300
    assert 0.1 < found.error < 0.5


def test_what_takes_seconds_is_told_on_a_terminal(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    mesh = shape_mesh(Convex([(0, 0, 0), (3, 0, 0), (0, 4, 0), (0, 0, 5)]), 3)
    Path("part.stl").write_bytes(binary_stl(mesh))
    Path("scene.yaml").write_text(
        "name: s\nobject: {shapes: [{mesh: {file: part.stl}}]}\ncage: {points: [[0, 0, -9]]}\n"
        "loads: [{name: weight, gravity: [0, 0, -1]}]\n"
    )
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    assert main(["check", "scene.yaml"]) == 0
    told = capsys.readouterr().err.split("\r")
    assert [line.strip() for line in told if line.strip()] == [
        "part.stl: read, 0.0 MiB",
        "4 triangles: searched for crossings",
        "'mesh1': 4 triangles, its shape recognised",
    ]
    assert told[-2:] == [" " * 78, ""]
    monkeypatch.undo()
    assert main(["check", str(tmp_path / "scene.yaml")]) == 0
    assert capsys.readouterr().err == ""


def test_a_long_thin_rod_is_no_flat_mesh():
    """Its volume is a millionth of the cube of its length."""
    (rod,) = shapes_of(body(Box((1000.0, 1.0, 1.0)))).shapes
    assert sorted(rod.size_m) == pytest.approx([1.0, 1.0, 1000.0], abs=1e-8)
    with pytest.raises(SceneError, match="encloses no volume"):
        shapes_of(body(Box((1000.0, 1.0, 1e-5))))
