"""Closed surfaces of triangles that are not convex: unions and cuts of solids, and bumpy balls."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import manifold3d
import numpy as np
import trimesh

from cagepose import Box, Facets, Pose
from cagepose.model.shapes import Shape
from cagepose.model.surface import shape_mesh

SEGMENTS = 64


def solid(shape: Shape, segments: int = SEGMENTS) -> Any:
    mesh = shape_mesh(shape, segments)
    return manifold3d.Manifold(manifold3d.Mesh64(mesh.vertices_m, mesh.triangles.astype(np.uint64)))


def united(shapes: Sequence[Shape], without: Sequence[Shape] = ()) -> Any:
    whole = manifold3d.Manifold.batch_boolean([solid(shape) for shape in shapes], manifold3d.OpType.Add)
    return manifold3d.Manifold.batch_boolean([whole, *map(solid, without)], manifold3d.OpType.Subtract)


def facets(body: Any, name: str | None = None) -> Facets:
    mesh = body.to_mesh64()
    return Facets(mesh.vert_properties[:, :3], mesh.tri_verts.astype(np.int64), name=name)


def of_boxes(boxes: Sequence[Box], name: str | None = None) -> Facets:
    return facets(united(boxes), name)


def bumpy_ball(rng: np.random.Generator, divisions: int = 3, height: float = 0.25, name: str | None = None) -> Facets:
    """A ball of radius one with hills and dents; 1,280 triangles with three divisions."""
    ball = trimesh.creation.icosphere(divisions)
    waves = [np.sin(ball.vertices @ rng.normal(0.0, 2.5, 3) + rng.uniform(0.0, 6.0)) for _ in range(6)]
    radii = 1.0 + height / 6.0 * np.sum(waves, axis=0)
    return Facets(ball.vertices * radii[:, None], ball.faces, name=name)


def drawn_facets(rng: np.random.Generator) -> Facets:
    """Some boxes that cross, less others and a few round bars; or a bumpy ball."""
    if rng.random() < 0.3:
        return bumpy_ball(rng)
    while True:
        added = [_drawn_box(rng, 0.5, 1.6) for _ in range(int(rng.integers(1, 4)))]
        cut = [_drawn_box(rng, 0.2, 0.9) for _ in range(int(rng.integers(1, 4)))]
        body = united(added, cut)
        if body.volume() > 0.1:
            return facets(body)


def _drawn_box(rng: np.random.Generator, low: float, high: float) -> Box:
    turn = rng.standard_normal(4) if rng.random() < 0.5 else None
    return Box(rng.uniform(low, high, 3), Pose(rng.uniform(-0.5, 0.5, 3), turn))


def triangles_of(shape: Facets) -> trimesh.Trimesh:
    """As trimesh has it, in the frame of the body."""
    return trimesh.Trimesh(shape.nodes_body(), shape.triangles, process=False)
