"""Meshes as programs leave them are mended, with notes; what cannot be mended says where, in the words of the file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cagepose import SceneError
from cagepose.files.meshes.manifolds import Triangles
from cagepose.files.meshes.mesh_file import Sound, read_mesh, sound
from cagepose.files.meshes.odd_facets import is_closed

trimesh = pytest.importorskip("trimesh")
pytest.importorskip("manifold3d")


def ring():
    """Of 40 by 40 by 10, volume as trimesh has it; not convex, and round nowhere exactly."""
    return trimesh.creation.annulus(8.0, 20.0, 10.0, sections=24)


def of(*meshes) -> Triangles:
    """Meshes as they are in a file: corners at one place are one."""
    soup = np.concatenate([np.array(mesh.triangles) for mesh in meshes]).reshape(-1, 3)
    places, same = np.unique(soup, axis=0, return_inverse=True)
    return Triangles(places, same.reshape(-1, 3))


def mended(mesh: Triangles) -> Sound:
    found = sound(mesh, "part", "mm")
    assert is_closed(found.mesh)
    return found


def refusal(mesh: Triangles) -> str:
    with pytest.raises(SceneError) as caught:
        sound(mesh, "part", "mm")
    (problem,) = caught.value.problems
    return problem.message


def volume(mesh: Triangles) -> float:
    return float(trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).volume)


def moved(mesh, *way):
    mesh.apply_translation(way)
    return mesh


def test_a_good_mesh_stays_as_it_is():
    mesh = of(ring())
    found = mended(mesh)
    assert found.mesh is mesh
    assert found.notes == ()


def test_facets_that_are_there_twice_are_left_out():
    mesh = of(ring())
    twice = Triangles(mesh.vertices, np.concatenate([mesh.faces, mesh.faces[[3, 17]], mesh.faces[[17]]]))
    found = mended(twice)
    assert len(found.mesh.faces) == len(mesh.faces)
    (note,) = found.notes
    assert note.startswith("'part': 3 triangles left out as doubled, as at (")


def test_a_wall_between_two_bodies_that_share_a_face_is_left_out():
    """Two boxes side by side, a box of twice the size."""
    one, other = trimesh.creation.box((10, 10, 10)), moved(trimesh.creation.box((10, 10, 10)), 10, 0, 0)
    other.apply_transform(np.diag([-1.0, 1.0, 1.0, 1.0]))  # the shared face is divided alike
    other.apply_translation([20.0, 0.0, 0.0])
    found = mended(of(one, other))
    assert volume(found.mesh) == pytest.approx(2000.0, rel=1e-12)
    assert len(found.mesh.body().decompose()) == 1
    assert "4 triangles left out as doubled" in found.notes[0]


def test_triangles_that_face_another_way_are_turned():
    mesh = of(ring())
    turned = mesh.faces.copy()
    turned[[4, 9, 30]] = turned[[4, 9, 30]][:, ::-1]
    found = mended(Triangles(mesh.vertices, turned))
    assert volume(found.mesh) == pytest.approx(ring().volume, rel=1e-12)
    assert found.notes[0].startswith("'part': 3 triangles turned to face as those around, as at (")


def test_facets_of_no_body_are_left_out():
    """A triangle in the air, and a fin on an edge."""
    stray = trimesh.Trimesh([(30, 0, 0), (31, 0, 0), (30, 1, 0)], [(0, 1, 2)], process=False)
    mesh = of(ring(), stray)
    a, b = mesh.faces[0, :2].tolist()
    fin = Triangles(np.vstack([mesh.vertices, (0, 0, 20)]), np.vstack([mesh.faces, (a, b, len(mesh.vertices))]))
    small = Triangles(np.vstack([fin.vertices[:-1], fin.vertices[[a]] + (0, 0, 0.5)]), fin.faces)
    found = mended(small)
    assert volume(found.mesh) == pytest.approx(ring().volume, rel=1e-12)
    assert found.notes[0].startswith("'part': 2 triangles left out as part of no body, as at (")
    assert found.mesh.size == pytest.approx(40.0, rel=1e-12)


def test_slivers_do_no_harm():
    """A corner on a side of the triangle beside it makes a triangle without an area."""
    mesh = of(trimesh.creation.box((10, 10, 10)))
    a, b, c = mesh.faces[0].tolist()
    new = len(mesh.vertices)
    vertices = np.vstack([mesh.vertices, (mesh.vertices[a] + mesh.vertices[b]) / 2.0])
    faces = np.vstack([mesh.faces[1:], (a, new, c), (new, b, c), (a, b, new)])
    found = mended(Triangles(vertices, faces))
    assert volume(found.mesh) == pytest.approx(1000.0, rel=1e-12)
    assert found.notes == ()


@pytest.mark.parametrize("shells", [1, 2])
def test_what_is_inside_out_is_turned(shells):
    """All of a file, or one of its two bodies."""
    inverted = ring()
    inverted.invert()
    found = mended(of(inverted, *[moved(ring(), 50, 0, 0)] * (shells - 1)))
    assert volume(found.mesh) == pytest.approx(shells * ring().volume, rel=1e-12)
    which = (
        "inside out in the file; turned here" if shells == 1 else "1 of 2 closed surfaces turned, which is inside out"
    )
    assert found.notes == (f"'part': {which}",)


def test_cavities_stay_and_are_told_from_bodies_within():
    """A cavity faces inwards. What faces outwards in another body is material of it; in a mesh that is inside out as a
    whole, it is the cavity.
    """
    outer, inner = trimesh.creation.box((10, 10, 10)), trimesh.creation.icosphere(2, 3.0)
    hollow = outer.volume - inner.volume
    turned_outer, turned_inner = outer.copy(), inner.copy()
    turned_outer.invert(), turned_inner.invert()
    cavity = mended(of(outer, turned_inner))
    assert volume(cavity.mesh) == pytest.approx(hollow, rel=1e-12)
    assert cavity.notes == ()
    assert volume(mended(of(turned_outer, inner)).mesh) == pytest.approx(hollow, rel=1e-12)
    assert volume(mended(of(turned_outer, turned_inner)).mesh) == pytest.approx(hollow, rel=1e-12)
    full = mended(of(outer, inner))
    assert volume(full.mesh) == pytest.approx(1000.0, rel=1e-12)
    assert full.notes == ("'part': 1 of 2 closed surfaces left out, which is within another one",)


def test_bodies_that_overlap_become_their_union():
    """Two rings of which one stands on end in the other; the volume is that of trimesh's own union."""
    other = ring()
    other.apply_transform(trimesh.transformations.rotation_matrix(1.1, (1, 0.3, 0)))
    found = mended(of(ring(), other))
    union = trimesh.boolean.union([ring(), other], engine="manifold")
    assert volume(found.mesh) == pytest.approx(union.volume, rel=1e-7)
    assert found.notes == ("'part': 2 closed surfaces overlap; here, their union",)


def test_convex_bodies_that_overlap_stay_shapes_of_their_own():
    one, other = trimesh.creation.box((30, 4, 4)), trimesh.creation.box((4, 30, 4))
    mesh = of(one, other)
    assert mended(mesh).mesh is mesh


def test_a_surface_that_crosses_itself_says_where_and_by_how_much():
    """A U whose left arm leans through the right one: the arms cross where x is 2 to 6."""
    outline = [(0, 0), (10, 0), (10, 30), (6, 30), (6, 4), (4, 4), (9, 28), (5, 28)]
    corners = np.array(outline, float)
    n = len(corners)
    vertices = np.concatenate([np.insert(corners, 2, 0.0, axis=1), np.insert(corners, 2, 5.0, axis=1)])
    caps = [(0, 4, 5), (0, 1, 4), (1, 2, 4), (2, 3, 4), (0, 5, 7), (5, 6, 7)]
    walls = [face for k in range(n) for face in ((k, (k + 1) % n, n + k), ((k + 1) % n, n + (k + 1) % n, n + k))]
    faces = np.array([*(face[::-1] for face in caps), *((a + n, b + n, c + n) for a, b, c in caps), *walls])
    told = refusal(Triangles(vertices, faces))
    assert told.startswith("crosses itself by ")
    assert told.endswith("; draw it as bodies in CAD and take their union, or repair the mesh there")
    x, y, z = map(float, told.partition(" at (")[2].partition(")")[0].split(", "))
    assert 4.0 <= x <= 10.0
    assert 4.0 <= y <= 30.0
    assert 0.0 <= z <= 5.0


def test_what_is_open_says_where_and_how_wide():
    mesh = of(ring())
    middles = mesh.vertices[mesh.faces].mean(axis=1)
    torn = int(np.linalg.norm(middles - (20.0, 0.0, 0.0), axis=1).argmin())
    told = refusal(Triangles(mesh.vertices, np.delete(mesh.faces, torn, axis=0)))
    corners = mesh.vertices[mesh.faces[torn]]
    middle = (corners.max(axis=0) + corners.min(axis=0)) / 2.0
    x, y, z = map(float, told.partition("is open at (")[2].partition(")")[0].split(", "))
    assert (x, y, z) == pytest.approx(tuple(middle), abs=1e-2)
    assert " mm: 3 sides have no neighbour, a gap of " in told
    assert told.endswith("; close it in CAD, or repair the mesh there")


@pytest.mark.parametrize("suffix", ["obj", "ply"])
@pytest.mark.usefixtures("in_this_process")
def test_faces_of_four_and_more_corners(suffix, tmp_path):
    """An eight-cornered prism, its caps and sides one face each."""
    turns = np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False)
    low = np.stack([10.0 * np.cos(turns), 10.0 * np.sin(turns), 0.0 * turns], axis=1)
    vertices = np.concatenate([low, low + np.array((0, 0, 5))])
    faces = [list(range(8))[::-1], list(range(8, 16)), *([k, (k + 1) % 8, 8 + (k + 1) % 8, 8 + k] for k in range(8))]
    path = tmp_path / f"prism.{suffix}"
    corners = "\n".join(" ".join(f"{value:.17g}" for value in row) for row in vertices)
    if suffix == "obj":
        lines = [f"v {line}" for line in corners.splitlines()]
        path.write_text("\n".join([*lines, *("f " + " ".join(str(k + 1) for k in face) for face in faces)]))
    else:
        head = "ply\nformat ascii 1.0\nelement vertex 16\n" + "".join(f"property double {axis}\n" for axis in "xyz")
        head += f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
        path.write_text(head + corners + "\n" + "\n".join(" ".join(map(str, [len(face), *face])) for face in faces))
    (shape,) = read_mesh(path, "mm", "mm", "prism").shapes
    assert shape.kind == "convex"
    assert len(shape.hull.vertices_m) == 16


@pytest.mark.usefixtures("in_this_process")
def test_a_large_mesh_comes_in(tmp_path, cases):
    """A wavy tube; 400,000 triangles at full size."""
    n_around, n_along = 400, cases(25, 500)
    u, v = np.meshgrid(*(np.linspace(0.0, 2.0 * np.pi, n, endpoint=False) for n in (n_around, n_along)))
    radius = 5.0 + 0.3 * np.sin(7.0 * u) * np.cos(5.0 * v)
    places = np.stack(
        [(20 + radius * np.cos(u)) * np.cos(v), (20 + radius * np.cos(u)) * np.sin(v), radius * np.sin(u)], -1
    )
    here = np.arange(n_around * n_along).reshape(n_along, n_around)
    over, beside = np.roll(here, -1, axis=1), np.roll(here, -1, axis=0)
    beyond = np.roll(over, -1, axis=0)
    faces = np.concatenate([np.stack([here, beside, beyond], axis=2), np.stack([here, beyond, over], axis=2)])
    mesh = trimesh.Trimesh(places.reshape(-1, 3), faces.reshape(-1, 3), process=False)
    mesh.export(tmp_path / "wavy.stl")
    (shape,) = read_mesh(Path(tmp_path / "wavy.stl"), "mm", "mm", "wavy").shapes
    assert shape.kind == "facets"
    found = trimesh.Trimesh(shape.vertices_m, shape.triangles, process=False)
    assert 1e9 * found.volume == pytest.approx(abs(mesh.volume), rel=1e-6)
    assert (tmp_path / "wavy.stl.facets.npz").is_file()
