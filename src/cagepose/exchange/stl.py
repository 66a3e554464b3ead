"""Bodies as triangles: `stl_text` of a scene, in millimetres, and `binary_stl` of one mesh, in metres."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from cagepose.exchange.bodies import Scale
from cagepose.exchange.tolerances import PAST_FACE
from cagepose.exchange.world_parts import world_parts
from cagepose.files.meshes.manifolds import manifold3d
from cagepose.files.write import MADE_BY
from cagepose.model.checks import FloatArray
from cagepose.model.hole import Hole
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.model.shapes import Rounded, Shape, Turned
from cagepose.model.surface import Mesh, shape_mesh

CHORDS_OF_CIRCLE = 64
"""Chords of a full circle."""
POINT_SEGMENTS = 4
"""Chords of a full circle of the ball that stands for a cage point."""
MM_PER_M = 1e3
"""Millimetres of a metre."""
NOTE_BESIDE = "loads, mass, friction and the start pose are in the note for cagepose alone"


def stl_text(scene: Scene, pose_world_object: Pose) -> tuple[str, tuple[str, ...]]:
    """Return a solid for each part of object and cage, in the world, and what the file cannot say, in sentences.

    Raises
    ------
    SceneError
        A part that is no solid, see `world_parts`.
    MissingExtraError
        Parts with holes need manifold3d.
    """
    parts, notes = world_parts(scene, pose_world_object)
    lines = []
    for part in parts:
        segments = POINT_SEGMENTS if part.is_point else CHORDS_OF_CIRCLE
        mesh = _drilled(part.shape, part.holes) if part.holes else shape_mesh(part.shape, segments)
        lines.append(_solid_text(part.name, Mesh(MM_PER_M * part.pose.transform(mesh.vertices_m), mesh.triangles)))
    widest_m = max(_radius_m(shape) for part in parts if not part.is_point for shape in (part.shape, *part.holes))
    if widest_m > 0.0:
        sagitta_m = widest_m * (1.0 - math.cos(math.pi / CHORDS_OF_CIRCLE))
        notes.append(f"what is round has {CHORDS_OF_CIRCLE} chords, at most {sagitta_m:.3g} m within it")
    return "".join(lines), ("lengths in millimetres, which an STL file cannot say", NOTE_BESIDE, *notes)


def binary_stl(mesh: Mesh) -> bytes:
    """Return a mesh as a binary STL file, in metres."""
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
    scale, library = Scale.of(part), manifold3d()
    bodies = [
        scale.body(mesh)
        for mesh in (shape_mesh(part, CHORDS_OF_CIRCLE), *(_longer(hole, part, scale) for hole in holes))
    ]
    return scale.mesh(library.Manifold.batch_boolean(bodies, library.OpType.Subtract))


def _longer(hole: Hole, part: Shape, scale: Scale) -> Mesh:
    """Return the surface of a hole whose open ends are moved out by nearly nothing: they lie in faces of the part,
    where rounding would leave films over them.
    """
    mesh = shape_mesh(hole, CHORDS_OF_CIRCLE)
    heights = hole.pose_body_shape.inverse_transform(mesh.vertices_m)[:, 2]
    is_end = np.abs(heights[:, None] - (0.0, -hole.depth_m)) < 1e-9 * hole.depth_m
    _, is_open = hole.run_through([part])
    out = PAST_FACE * scale.unit_m * (is_end @ (1.0, -float(is_open)))
    return Mesh(mesh.vertices_m + np.outer(out, hole.pose_body_shape.rotation[:, 2]), mesh.triangles)


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
    return " ".join(repr(value) for value in values)
