"""Bodies of triangles are recognised as what they stand for: known shapes, and a hand answer for each error."""

from __future__ import annotations

import math
import re
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
    Facets,
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
from cagepose.files.meshes import mesh_file
from cagepose.files.meshes.manifolds import Triangles
from cagepose.files.meshes.mesh_shapes import mesh_shapes
from cagepose.model.checks import ProblemList
from cagepose.model.shape_moments import mesh_sums, shape_moments
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
        assert isinstance(one, Facets)


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


def test_what_is_none_of_our_shapes_stays_facets_and_says_how_far_these_may_be_off():
    """A ring of 8 sides around a ring of 16: a chord of one of sixteen of its outer circle is farthest within."""
    ring = torus()
    found = mesh_shapes(ring, "ring", "mm")
    (shape,) = found.shapes
    assert isinstance(shape, Facets)
    assert (len(shape.triangles), found.error) == (len(ring.faces), 0.0)
    assert shape_moments(shape).volume_m3 == pytest.approx(ring.body().volume(), rel=1e-10)
    said = re.fullmatch(
        r"'ring' has 256 flat facets here, as in the mesh; where these stand for what is round, they are about (.*) mm"
        " off",
        found.notes[0],
    )
    assert said is not None
    assert float(said[1]) == pytest.approx(13.0 * (1.0 - math.cos(math.pi / 16)), rel=0.2)


def test_large_facets_are_kept_beside_their_mesh_and_found_anew_when_it_changes(tmp_path, monkeypatch):
    """What somebody damaged is not used, and what was kept of another mesh is not either."""
    section = manifold3d.CrossSection.circle(3.0, 32).translate((10.0, 0.0))
    ring = Triangles.of(manifold3d.Manifold.revolve(section, 64))
    path, kept = tmp_path / "ring.stl", tmp_path / "ring.stl.facets.npz"
    calls = []
    monkeypatch.setattr(mesh_file, "mesh_shapes", lambda *given: calls.append(1) or mesh_shapes(*given))

    def read(name: str = "ring"):
        mesh_file._shapes.cache_clear()
        return mesh_file.read_mesh(path, "mm", "mm", name)

    path.write_bytes(binary_stl(Mesh(ring.vertices, ring.faces)))
    first = read()
    assert kept.is_file()
    again = read()
    assert len(calls) == 1
    assert again.shapes[0].form == first.shapes[0].form
    assert (again.notes, again.shapes[0].name) == (first.notes, "ring")
    content = bytearray(kept.read_bytes())
    kept.write_bytes(content[: len(content) // 2])
    assert read().shapes[0].form == first.shapes[0].form
    assert len(calls) == 2
    path.write_bytes(binary_stl(Mesh(1.5 * ring.vertices, ring.faces)))
    assert read().shapes[0].farthest_m(np.zeros(3)) == pytest.approx(1.5 * 0.013, rel=1e-3)
    assert len(calls) == 3
    read("other")
    assert len(calls) == 4


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


def test_a_fillet_in_a_mesh_stays_facets_and_a_hole_beside_it_is_round():
    corner = body(
        Box((6, 40, 6), Pose((10, 0, 10))),
        without=(Cylinder(5, 60, Pose((13, 0, 13), euler_zyx=(0, 0, math.pi / 2))),),
    )
    walls = body(Box((60, 40, 8), Pose((30, 0, 4))), Box((8, 40, 50), Pose((4, 0, 25))))
    bored = walls + corner - body(Cylinder(4, 30, Pose((40, 0, 4))))
    found = shapes_of(bored)
    solid, hole = found.shapes
    assert isinstance(solid, Facets)
    assert isinstance(hole, Hole)
    assert hole.in_ == (solid.name,)
    assert hole.run_through([solid]) == (pytest.approx(8.0, abs=1e-9), True)
    problems = ProblemList()
    hole.check_mouth([solid], (), problems)
    assert not problems.problems
    moments = body_moments([solid], [hole])
    rounding = 8.0 * 16.0 * (math.pi - 32.0 * math.sin(math.pi / 32.0))  # a circle is more than 64 sides in it
    assert moments.volume_m3 == pytest.approx(bored.volume() - rounding, rel=1e-9)
    assert "flat facets here, as in the mesh" in found.notes[-1]
    assert not any("facets" in note for note in shapes_of(walls).notes)


def test_holes_of_a_finely_divided_plate_are_recognised():
    """Corners lie throughout its faces and along the edges of its walls, of which one pass leaves some."""
    plate = body(PLATE, without=tuple(Cylinder(5, 30, Pose((x, 0, 0))) for x in (-15.0, 15.0)))
    found = shapes_of(plate.refine_to_length(0.6), single=True)
    assert [shape.kind for shape in found.shapes] == ["box", "hole", "hole"]
    assert found.error == pytest.approx(5 * (1 - math.cos(math.pi / SEGMENTS)), rel=0.01)


def test_a_convex_body_of_many_corners_keeps_them_all():
    egg = shape_mesh(Sphere(20.0), 80)
    found = shapes_of(Triangles(egg.vertices_m * (1.0, 0.7, 0.5), egg.triangles).body())
    (one,) = found.shapes
    assert isinstance(one, Facets)
    assert len(one.vertices_m) == len(egg.vertices_m)
    assert found.error == 0.0


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
