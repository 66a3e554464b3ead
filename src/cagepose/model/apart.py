"""Whether two convex shapes share no volume, shown by a plane between them."""

from __future__ import annotations

import numpy as np

from cagepose.model.box import Box
from cagepose.model.checks import FloatArray, unit_rows
from cagepose.model.nearest import core_of, nearest_points
from cagepose.model.pose import Pose
from cagepose.model.shapes import Convex, Shape, Turned
from cagepose.model.tolerances import OVERLAP_OF_TOUCH, PARALLEL_SINE


def are_apart(one: Shape, other: Shape) -> bool:
    """Return whether a plane between the two was found: normal to a face, an axis or two edges, or to the line between
    their nearest points. Where none was, they may still be apart by a hair.
    """
    middle, other_middle = one.nodes_body().mean(axis=0), other.nodes_body().mean(axis=0)
    offset = other_middle - middle
    reach = one.farthest_m(middle) + other.farthest_m(other_middle)
    if float(np.linalg.norm(offset)) >= reach:
        return True
    lines, other_lines = _lines(one), _lines(other)
    both = np.concatenate([lines, other_lines])
    candidates = [
        offset[None],
        _across_faces(one),
        _across_faces(other),
        np.cross(lines[:, None], other_lines[None]).reshape(-1, 3),
        np.cross(np.cross(both, offset), both),
    ]
    directions = np.concatenate([_directions(vectors) for vectors in candidates])
    if _largest_gap(one, other, np.concatenate([directions, -directions])) >= -OVERLAP_OF_TOUCH * reach:
        return True
    cores = (core_of(shape, Pose())._replace(radius_m=0.0) for shape in (one, other))
    foot, place = nearest_points(*cores)
    return _largest_gap(one, other, _directions((place - foot)[None])) >= -OVERLAP_OF_TOUCH * reach


def _largest_gap(one: Shape, other: Shape, directions: FloatArray) -> float:
    """Return how far apart two planes across one of the directions (n, 3) are, with a shape behind each, at most."""
    return float((-one.heights_m(directions) - other.heights_m(-directions)).max(initial=-np.inf))


def _directions(vectors: FloatArray) -> FloatArray:
    """Return vectors (n, 3) scaled to length one, without those that are short beside the others or beside one."""
    lengths = np.linalg.norm(vectors, axis=1)
    long_enough = lengths > PARALLEL_SINE * lengths.max(initial=0.0)
    return unit_rows(vectors[long_enough]) if long_enough.any() else np.zeros((0, 3))


def _across_faces(shape: Shape) -> FloatArray:
    """Directions across the shape's flat faces, (n, 3)."""
    turn = shape.pose_body_shape.rotation
    if isinstance(shape, Box):
        return turn.T
    if isinstance(shape, Turned):
        return turn[:, 2:].T
    return shape.hull.normals @ turn.T if isinstance(shape, Convex) else np.zeros((0, 3))


def _lines(shape: Shape) -> FloatArray:
    """Directions of the shape's straight edges, or of its axis, (n, 3)."""
    turn = shape.pose_body_shape.rotation
    if isinstance(shape, Box):
        return turn.T
    if isinstance(shape, Convex):
        start, end = np.moveaxis(shape.hull.vertices_m[shape.hull.edges], 1, 0)
        return _directions(end - start) @ turn.T
    return turn[:, 2:].T
