"""Facets and other polyhedra of one body that meet, joined to one surface: `surface_groups`, `joined_surface`."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from cagepose.errors import MissingExtraError
from cagepose.model.boundary.surface_union import union_of_triangles
from cagepose.model.boundary.trimmed import TrimmedUnion
from cagepose.model.checks import FloatArray
from cagepose.model.facets import FLAT, Facets
from cagepose.model.near_pairs import near_pairs
from cagepose.model.shapes import Shape
from cagepose.model.sides import IntArray
from cagepose.model.surface import LEAST_SEGMENTS, Mesh, mesh_in_own_frame

FLUSH = 4.0
"""In touch tolerances: faces of several parts that are this near to one plane are one."""


def surface_groups(polyhedra: Mapping[int, Shape], touch_m: float) -> list[frozenset[int]]:
    """Return the numbers of polyhedra in groups of which each has facets: those whose boxes are near each other, to
    what touches, and what is near these in turn.
    """
    numbers = list(polyhedra)
    if not any(isinstance(part, Facets) for part in polyhedra.values()):
        return []
    limits = np.array([part.limits_m() for part in polyhedra.values()])
    group = {number: {number} for number in numbers}
    for one, other in near_pairs(limits[:, 0] - touch_m, limits[:, 1] + touch_m).tolist():
        joined = group[numbers[one]] | group[numbers[other]]
        group.update(dict.fromkeys(joined, joined))
    groups = {frozenset(members) for members in group.values()}
    return sorted((each for each in groups if any(isinstance(polyhedra[k], Facets) for k in each)), key=min)


def joined_surface(shapes: Sequence[Shape], parts: Sequence[int], touch_m: float) -> TrimmedUnion:
    """Return the boundary of the union of polyhedra, in the frame of their body; ``parts`` has the number of each.

    Where there are several, all but the first facets are larger by what touches on all sides: flush ones overlap.

    Raises
    ------
    MissingExtraError
        There are several, and manifold3d is not installed.
    """
    first = next((shape for shape in shapes if isinstance(shape, Facets)), None)
    meshes = [_larger(shape, 0.0 if shape is first else touch_m) for shape in shapes]
    size = float(np.ptp(np.concatenate([mesh.vertices_m for mesh in meshes]), axis=0).max())
    flat_m = max(FLAT * size, *_flat(shapes), FLUSH * touch_m if len(shapes) > 1 else 0.0)
    if len(meshes) == 1:
        (mesh,), (part,) = meshes, parts
        return union_of_triangles(mesh.vertices_m, mesh.triangles, np.full(len(mesh.triangles), part), flat_m)
    try:
        import manifold3d  # 20 ms and an extra, for bodies of several parts with facets alone
    except ImportError as error:
        raise MissingExtraError(
            "a mesh of facets that meets other parts needs manifold3d, which is not installed; install the shapes"
            " extra: pip install 'cagepose[shapes]', or make one mesh of what is one"
        ) from error
    origin = meshes[0].vertices_m.mean(axis=0)
    bodies, part_of = [], dict[int, int]()
    for mesh, part in zip(meshes, parts, strict=True):
        triangles = mesh.triangles.astype(np.uint64)
        body = manifold3d.Manifold(manifold3d.Mesh64(mesh.vertices_m - origin, triangles)).as_original()
        bodies.append(body)
        part_of[body.original_id()] = part
    found = manifold3d.Manifold.batch_boolean(bodies, manifold3d.OpType.Add).to_mesh64()
    runs = np.diff(np.array(found.run_index)) // 3
    of_triangles = np.repeat([part_of[each] for each in found.run_original_id], runs)
    vertices = found.vert_properties[:, :3] + origin
    joined, kept = _welded(vertices, found.tri_verts.astype(np.int64), FLUSH * touch_m)
    return union_of_triangles(vertices, joined, of_triangles[kept], flat_m)


def _larger(shape: Shape, by_m: float) -> Mesh:
    """Return the surface of a shape in the frame of its body, its sides farther out by a length."""
    mesh = mesh_in_own_frame(shape, LEAST_SEGMENTS)
    low, high = mesh.vertices_m.min(axis=0), mesh.vertices_m.max(axis=0)
    grown = mesh.vertices_m + by_m * (2.0 * mesh.vertices_m - low - high) / (high - low)
    return Mesh(shape.pose_body_shape.transform(grown), mesh.triangles)


def _welded(vertices: FloatArray, triangles: IntArray, within_m: float) -> tuple[IntArray, IntArray]:
    """Return triangles whose corners are one where they are near each other, and which these are: steps of faces that
    were flush are none then.
    """
    same = np.arange(len(vertices))
    for one, other in near_pairs(vertices - 0.5 * within_m, vertices + 0.5 * within_m).tolist():
        same[other] = min(same[other], same[one])
    found = same[triangles]
    kept = np.flatnonzero((found != np.roll(found, 1, axis=1)).all(axis=1))
    first = np.argmin(found[kept], axis=1)
    turned = np.stack([found[kept, (first + k) % 3] for k in range(3)], axis=1)
    flipped = turned[:, [0, 2, 1]]
    _, number = np.unique(np.concatenate([turned, flipped]), axis=0, return_inverse=True)
    here, back = np.split(number.ravel(), 2)
    kept = kept[~np.isin(here, back)]  # two triangles back to back enclose nothing
    return found[kept], kept


def _flat(shapes: Iterable[Shape]) -> list[float]:
    return [shape.flat_m for shape in shapes if isinstance(shape, Facets)] or [0.0]
