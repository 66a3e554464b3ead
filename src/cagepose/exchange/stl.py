"""Bodies as triangles: `stl_text` of a scene, and `binary_stl` of one mesh. Lengths are metres."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from cagepose.errors import Problem, SceneError
from cagepose.exchange.extra import manifold3d
from cagepose.exchange.solids import POINT_OF_SIZE
from cagepose.files.write import MADE_BY
from cagepose.model.checks import FloatArray
from cagepose.model.hole import Hole
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.model.shapes import Disc, Rounded, Shape, Sphere, Turned
from cagepose.model.surface import Mesh, shape_mesh

SEGMENTS = 64
"""Chords of a full circle."""
POINT_SEGMENTS = 4
"""Of the ball that stands for a cage point."""


def stl_text(scene: Scene, pose_world_object: Pose) -> tuple[str, tuple[str, ...]]:
    """Return a solid for each part of object and cage, in the world, and what the file cannot say, in sentences.

    Raises
    ------
    SceneError
        Discs, which enclose nothing, and holes that stand alone, which are solid without end; by their names.
    MissingExtraError
        Parts with holes need manifold3d.
    """
    problems = []
    notes = ["lengths in metres, which an STL file cannot say", "no masses, loads or friction"]
    radius_m = POINT_OF_SIZE * scene.size_m
    points = [
        Sphere(radius_m, Pose(point), name)
        for point, name in zip(scene.cage.points_cage, scene.cage.names, strict=True)
    ]
    if points:
        notes.append(f"cage points are balls of radius {radius_m:.3g} m")
    lines = []
    widest_m = 0.0
    for body, pose, shapes, holes in (
        ("cage", scene.cage.pose_world_cage, (*points, *scene.cage.shapes), scene.cage.holes),
        ("object", pose_world_object, scene.object.parts, scene.object.holes),
    ):
        for shape in (*shapes, *(hole for hole in holes if not hole.in_)):
            if isinstance(shape, Disc | Hole):
                what = (
                    "is a disc, which encloses nothing" if isinstance(shape, Disc) else "stands alone, without an end"
                )
                problems.append(Problem((body, str(shape.name)), f"{what}; no STL can hold it: leave it out"))
                continue
            cuts = [hole for hole in holes if shape.name in hole.in_]
            is_point = any(shape is point for point in points)
            if not is_point:
                widest_m = max(widest_m, *(_radius_m(round_one) for round_one in (shape, *cuts)))
            mesh = _drilled(shape, cuts) if cuts else shape_mesh(shape, POINT_SEGMENTS if is_point else SEGMENTS)
            lines.append(_solid_text(f"{body}/{shape.name}", Mesh(pose.transform(mesh.vertices_m), mesh.triangles)))
    if problems:
        raise SceneError(problems)
    if widest_m > 0.0:
        sagitta_m = widest_m * (1.0 - math.cos(math.pi / SEGMENTS))
        notes.append(f"what is round has {SEGMENTS} chords, at most {sagitta_m:.3g} m within it")
    return "".join(lines), tuple(notes)


def binary_stl(mesh: Mesh) -> bytes:
    """Return a mesh as a binary STL file."""
    corners = mesh.vertices_m[mesh.triangles]
    record = np.zeros(len(corners), np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("unused", "<u2")]))
    record["normal"], record["corners"] = _normals(corners), corners
    return MADE_BY.encode().ljust(80) + len(corners).to_bytes(4, "little") + record.tobytes()


def _radius_m(shape: Shape) -> float:
    """Return the greatest radius of what is round in a shape; 0: nothing is."""
    if isinstance(shape, Turned):
        return max(radius for _, radius in shape.rims)
    return shape.radius_m if isinstance(shape, Rounded) else 0.0


def _drilled(part: Shape, holes: Sequence[Hole]) -> Mesh:
    library = manifold3d()
    origin = part.nodes_body().mean(axis=0)
    unit_m = 2.0 ** float(np.frexp(part.farthest_m(origin))[1])
    bodies = []
    for shape in (part, *holes):
        mesh = shape_mesh(shape, SEGMENTS)
        vertices = (mesh.vertices_m - origin) / unit_m
        bodies.append(library.Manifold(library.Mesh64(vertices, mesh.triangles.astype(np.uint64))))
    found = library.Manifold.batch_boolean(bodies, library.OpType.Subtract).to_mesh64()
    return Mesh(found.vert_properties[:, :3] * unit_m + origin, found.tri_verts.astype(np.int64))


def _normals(corners: FloatArray) -> FloatArray:
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(areas, axis=1, keepdims=True)
    found: FloatArray = np.divide(areas, lengths, out=np.zeros_like(areas), where=lengths > 0.0)
    return found


def _solid_text(name: str, mesh: Mesh) -> str:
    corners = mesh.vertices_m[mesh.triangles]
    lines = [f"solid {name}, {MADE_BY}"]
    for normal, triangle in zip(_normals(corners).tolist(), corners.tolist(), strict=True):
        lines += [f"facet normal {_numbers(normal)}", "outer loop"]
        lines += [f"vertex {_numbers(corner)}" for corner in triangle]
        lines += ["endloop", "endfacet"]
    return "\n".join((*lines, f"endsolid {name}", ""))


def _numbers(values: list[float]) -> str:
    return " ".join(f"{value:.9g}" for value in values)
