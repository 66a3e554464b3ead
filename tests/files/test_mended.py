"""Cracks of meshes are closed, and corners in the middle of sides divide these; what is missing stays missing."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest

from cagepose import Box, Facets, SceneError
from cagepose.exchange.stl import binary_stl
from cagepose.files.meshes.manifolds import Triangles
from cagepose.files.meshes.mended import mended
from cagepose.files.meshes.mesh_file import read_mesh
from cagepose.model.sides import open_sides
from cagepose.model.surface import Mesh

trimesh = pytest.importorskip("trimesh")
pytest.importorskip("manifold3d")

CORNERS = np.array([[x, y, z] for x in (0, 10) for y in (0, 10) for z in (0, 10)], float)
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def soup(triangles) -> Triangles:
    """Triangles whose corners are one where they are at the same place."""
    places, same = np.unique(np.array(triangles).reshape(-1, 3), axis=0, return_inverse=True)
    return Triangles(places, same.ravel().reshape(-1, 3))


def cube_with_corners_on_an_edge(shares=(0.5,)) -> Triangles:
    """Used by one of the two faces beside the edge alone."""
    found = []
    for a, b, c, d in SIDES:
        if (a, b, c, d) == SIDES[-1]:
            on_edge = [CORNERS[5], *((1 - s) * CORNERS[5] + s * CORNERS[7] for s in shares), CORNERS[7]]
            found += [(CORNERS[1], one, other) for one, other in itertools.pairwise(on_edge)]
            found.append((CORNERS[1], CORNERS[7], CORNERS[3]))
        else:
            found += [(CORNERS[a], CORNERS[b], CORNERS[c]), (CORNERS[a], CORNERS[c], CORNERS[d])]
    return soup(found)


@pytest.mark.parametrize("shares", [(0.5,), (0.25, 0.5, 0.75), (0.1, 0.11, 0.9999)])
def test_corners_in_the_middle_of_a_side_divide_it(shares):
    """The crack has no area, and nothing is moved."""
    cube = cube_with_corners_on_an_edge(shares)
    assert len(open_sides(cube.faces)) > 0
    found = mended(cube)
    assert found.moved < 1e-14
    assert len(open_sides(found.mesh.faces)) == 0
    assert found.mesh.body().volume() == pytest.approx(1000.0, rel=1e-12)


@pytest.mark.parametrize("width", [1e-6, 1e-3])
def test_cracks_are_welded_within_a_distance_that_is_told(width):
    """All corners of all triangles of a ball of radius 1 are off by themselves."""
    ball = trimesh.creation.icosphere(3)
    rng = np.random.default_rng(0)
    corners = ball.triangles + rng.uniform(-0.2, 0.2, (len(ball.faces), 3, 3)) * width
    found = mended(Triangles(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3)))
    assert len(open_sides(found.mesh.faces)) == 0
    assert 0.1 * width < found.moved <= 4.0 * width
    assert found.mesh.body().volume() == pytest.approx(ball.volume, rel=width)


def test_a_missing_triangle_stays_missing():
    ball = trimesh.creation.icosphere(2)
    torn = Triangles(np.array(ball.vertices), np.array(ball.faces)[1:])
    assert mended(torn).mesh is torn


def written(folder: Path, mesh: Triangles) -> Path:
    path = folder / "part.stl"
    path.write_bytes(binary_stl(Mesh(mesh.vertices, mesh.faces)))
    return path


@pytest.mark.usefixtures("in_this_process")
def test_files_with_cracks_are_bodies_and_say_so(tmp_path):
    (box,) = read_mesh(written(tmp_path, cube_with_corners_on_an_edge()), "mm", "mm", "cube").shapes
    assert isinstance(box, Box)
    assert sorted(box.size_m) == pytest.approx([0.01] * 3, abs=1e-12)
    ring = trimesh.creation.torus(10.0, 3.0, major_sections=24, minor_sections=12)
    corners = np.array(ring.triangles)
    corners[7] += 0.002  # one triangle is a little off on all sides
    found = read_mesh(written(tmp_path, soup(corners)), "mm", "mm", "ring")
    assert isinstance(found.shapes[0], Facets)
    assert found.notes[0].startswith("'ring' has cracks of up to 0.00")
    assert found.notes[0].endswith(" mm, which are closed here")


@pytest.mark.usefixtures("in_this_process")
def test_what_is_open_is_refused(tmp_path):
    ring = trimesh.creation.torus(10.0, 3.0, major_sections=24, minor_sections=12)
    with pytest.raises(SceneError, match=r"is open at \("):
        read_mesh(written(tmp_path, soup(np.array(ring.triangles)[1:])), "mm", "mm", "ring")
