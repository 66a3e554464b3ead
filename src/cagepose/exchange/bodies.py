"""Parts as bodies of manifold3d, which cuts best near its origin and near a size of one: `Scale`."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from cagepose.files.meshes.manifolds import Triangles
from cagepose.model.checks import FloatArray
from cagepose.model.shapes import Shape
from cagepose.model.surface import Mesh


class Scale(NamedTuple):
    """Where bodies have their origin, metres, and what their unit is, a power of two of a metre."""

    origin_m: FloatArray
    unit_m: float

    @classmethod
    def of(cls, part: Shape) -> Scale:
        """Return that which suits a part and what is cut out of it."""
        origin_m = part.nodes_body().mean(axis=0)
        return cls(origin_m, 2.0 ** math.frexp(part.farthest_m(origin_m))[1])

    def body(self, mesh: Mesh) -> Any:
        """Return the body within a surface."""
        return Triangles((mesh.vertices_m - self.origin_m) / self.unit_m, mesh.triangles).body()

    def mesh(self, body: Any) -> Mesh:
        """Return the surface of a body."""
        found = Triangles.of(body)
        return Mesh(found.vertices * self.unit_m + self.origin_m, found.faces)

    def above(self, body: Any, normal: FloatArray, point_m: FloatArray) -> Any:
        """Return what of a body lies on the side of a plane that ``normal`` points to."""
        return body.trim_by_plane(normal.tolist(), float(normal @ (point_m - self.origin_m)) / self.unit_m)
