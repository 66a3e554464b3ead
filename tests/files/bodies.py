"""Bodies of triangles made of shapes, and what is recognised of them when they are turned."""

from __future__ import annotations

import numpy as np
import pytest

from cagepose import Pose
from cagepose.files.meshes.manifolds import Triangles
from cagepose.files.meshes.mesh_file import checked
from cagepose.files.meshes.mesh_shapes import MeshShapes, mesh_shapes
from cagepose.model.shapes import Shape
from cagepose.model.surface import shape_mesh

manifold3d = pytest.importorskip("manifold3d")

PLACE = Pose((3.0, 4.0, 5.0), euler_zyx=(0.4, -0.7, 1.1))
SEGMENTS = 64


def body(*added: Shape, without: tuple[Shape, ...] = ()):
    """A body of manifold3d: shapes, less others."""

    def of(shape: Shape):
        mesh = shape_mesh(shape, SEGMENTS)
        return manifold3d.Manifold(manifold3d.Mesh64(mesh.vertices_m, mesh.triangles.astype(np.uint64)))

    union = manifold3d.Manifold.batch_boolean([of(shape) for shape in added], manifold3d.OpType.Add)
    return manifold3d.Manifold.batch_boolean([union, *map(of, without)], manifold3d.OpType.Subtract)


def turned(solid) -> Triangles:
    """Its surface where `PLACE` says."""
    mesh = Triangles.of(solid)
    return Triangles(PLACE.transform(mesh.vertices), mesh.faces)


def shapes_of(solid, *, single: bool = False) -> MeshShapes:
    """What is recognised of a body that is turned and, as in an STL file, in single precision."""
    mesh = turned(solid)
    vertices = mesh.vertices.astype(np.float32).astype(np.float64) if single else mesh.vertices
    return mesh_shapes(checked(Triangles(vertices, mesh.faces), ""), "part", "mm")
