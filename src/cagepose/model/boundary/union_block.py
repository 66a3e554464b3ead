"""The boundary of a union as features: `union_block`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.record import dtype_of
from cagepose.kernels.boundary.features import FACE, HALF_SPACE, LINE, SEGMENT, VERTEX, Bound, Feature
from cagepose.model.boundary.blocks import Block, Row, block_of
from cagepose.model.boundary.record_rows import one_behind_the_other
from cagepose.model.boundary.trimmed import Edges, Faces, TrimmedUnion, Vertices
from cagepose.model.checks import FloatArray, unit_rows

RAY = np.array((0.4127, 0.5309, 0.7401))
"""A direction that few borders of ordinary parts lie along: rays of crossing parity do."""

Rows = tuple[NDArray[np.void], NDArray[np.void], FloatArray]


def union_block(union: TrimmedUnion, apart_from: frozenset[int]) -> Block:
    """Return the features of a union."""
    lengths = np.linalg.norm(union.edges.ends_m - union.edges.starts_m, axis=1)
    blocks = [_vertices(union.vertices), _edges(union.edges, lengths)]
    if len(union.faces.normals) > 0:
        blocks.append(_faces(union.faces))
    n_bounds = 0
    for own, of_own, _ in blocks:
        own["first_bound"] += n_bounds
        own["last_bound"] += n_bounds
        n_bounds += len(of_own)
    features, bounds, boxes = map(list, zip(*blocks, strict=True))
    return Block(one_behind_the_other(features), one_behind_the_other(bounds), np.concatenate(boxes), apart_from)


def with_rows(block: Block, rows: Sequence[Row]) -> Block:
    """Return a block with more features."""
    more = block_of(rows, block.apart_from)
    if not rows:
        return block
    for ends in ("first_bound", "last_bound"):
        more.features[ends] += len(block.bounds)
    features, bounds = (
        one_behind_the_other([block.features, more.features]),
        one_behind_the_other([block.bounds, more.bounds]),
    )
    return Block(features, bounds, np.concatenate([block.boxes, more.boxes]), block.apart_from)


def _vertices(vertices: Vertices) -> Rows:
    features = _features(VERTEX, vertices.parts, vertices.places_m, vertices.n_tangents)
    features["least"] = vertices.shortest_m
    return features, _half_spaces(vertices.tangents), np.stack([vertices.places_m] * 2, axis=1)


def _edges(edges: Edges, lengths: FloatArray) -> Rows:
    features = _features(LINE, edges.parts[:, 0], edges.starts_m, np.full(len(lengths), 2))
    features["direction"], features["length"], features["least"] = edges.directions, lengths, lengths
    one, other = edges.normals[:, 0], edges.normals[:, 1]
    cosines = np.einsum("ij,ij->i", one, other)[:, None]
    into = np.stack([cosines * one - other, cosines * other - one], axis=1).reshape(-1, 3)
    boxes = np.stack([np.minimum(edges.starts_m, edges.ends_m), np.maximum(edges.starts_m, edges.ends_m)], axis=1)
    return features, _half_spaces(unit_rows(into) if len(into) else into), boxes


def _faces(faces: Faces) -> Rows:
    starts, ends, inward = (faces.borders[key] for key in ("start", "end", "inward"))
    first = np.cumsum(faces.n_borders) - faces.n_borders
    middles = np.add.reduceat(starts, first) / faces.n_borders[:, None]
    of_border = np.repeat(middles, faces.n_borders, axis=0)
    starts, ends = starts - of_border, ends - of_border
    heights = faces.offsets_m - np.einsum("ij,ij->i", faces.normals, middles)
    features = _features(FACE, faces.parts, middles + heights[:, None] * faces.normals, faces.n_borders)
    features["direction"], features["toward"] = faces.normals, unit_rows(np.cross(faces.normals, RAY))
    features["least"] = np.minimum.reduceat(np.linalg.norm(ends - starts, axis=1), first)
    is_convex = np.repeat(faces.is_convex, faces.n_borders)
    bounds: Any = np.zeros(len(starts), dtype_of(Bound))
    bounds["kind"] = np.where(is_convex, HALF_SPACE, SEGMENT)
    bounds["direction"] = np.where(is_convex[:, None], -inward, starts)
    bounds["end"] = np.where(is_convex[:, None], 0.0, ends)
    bounds["limit"] = np.where(is_convex, -np.einsum("ij,ij->i", inward, starts), faces.borders["curvature"])
    bulge = _bulges(np.linalg.norm(ends - starts, axis=1), faces.borders["curvature"])[:, None]
    lowest = np.minimum.reduceat(np.minimum(faces.borders["start"], faces.borders["end"]) - bulge, first)
    highest = np.maximum.reduceat(np.maximum(faces.borders["start"], faces.borders["end"]) + bulge, first)
    return features, bounds, np.stack([lowest, highest], axis=1)


def _bulges(chords: FloatArray, curvatures: FloatArray) -> FloatArray:
    """Return how far arcs are from their chords at most, metres."""
    half_turns = np.arcsin(np.clip(0.5 * chords * np.abs(curvatures), 0.0, 1.0))
    bulges: FloatArray = 0.5 * chords * np.tan(0.5 * half_turns)
    return bulges


def _features(kind: int, parts: NDArray[np.int64], points: FloatArray, n_bounds: NDArray[np.int64]) -> Any:
    """Return straight features, all else of which is zero."""
    features: Any = np.zeros(len(points), dtype_of(Feature))
    features["kind"], features["part"], features["point"] = kind, parts, points
    features["last_bound"] = np.cumsum(n_bounds)
    features["first_bound"] = features["last_bound"] - n_bounds
    return features


def _half_spaces(directions: FloatArray) -> NDArray[np.void]:
    bounds: Any = np.zeros(len(directions), dtype_of(Bound))
    bounds["kind"], bounds["direction"] = HALF_SPACE, directions
    found: NDArray[np.void] = bounds
    return found
