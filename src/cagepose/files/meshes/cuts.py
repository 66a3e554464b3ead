"""A body with flat sides as convex pieces, exactly: cut along the faces at its hollow edges: `cut_until`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np

from cagepose.files.meshes.edges import reflex_edges
from cagepose.files.meshes.manifolds import ROUNDING, Triangles, manifold3d
from cagepose.model.checks import FloatArray

Piece = TypeVar("Piece")

NOT_CONVEX = 1e-5
"""Of a hull's volume: a body that is less by more is not convex."""
NOTHING = 1e-9
"""Of the whole body's volume: a piece that is less is rounding."""
MOST_PIECES = 60
"""What needs more is round where no shape of ours is."""
MOST_TRIES = 8
"""Of planes that cut nothing off, at an edge that rounding has tilted."""
ABOVE = 1e-6
"""Of a body's size: so far above a face it is cut."""
MOST_EDGES = 2000
"""Hollow ones of a body that is cut."""


def is_convex(body: Any) -> bool:
    """Whether a body fills its hull."""
    return bool(body.volume() >= (1.0 - NOT_CONVEX) * body.hull().volume())


def cut_until(parts: Sequence[Any], known: Callable[[Any], Piece | None]) -> list[Piece] | None:
    """Return what is known of bodies that are some bodies together and share no volume; None: it needs too many.

    ``known`` says it of a convex body, and maybe of another; None: it has to be cut.
    """
    least = NOTHING * sum(part.volume() for part in parts)
    pieces: list[Piece] = []
    waiting = [*parts]
    while waiting:
        part = waiting.pop()
        if part.volume() <= least:
            continue
        found = known(part)
        if found is not None:
            pieces.append(found)
        else:
            sides = _cut(part, least)
            if sides is None:
                return None
            waiting += sides
        if len(pieces) + len(waiting) > MOST_PIECES:
            return None
    return pieces


def _cut(body: Any, least: float) -> list[Any] | None:
    """Return the two sides of the plane in which the most of the hollow edges lie; None: there is none."""
    mesh = Triangles.of(body)
    allowed = ROUNDING * mesh.size
    edges = reflex_edges(mesh, allowed)
    if not 0 < len(edges.corners) <= MOST_EDGES:
        return None
    ends = mesh.vertices[edges.corners]
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    faces = np.unique(edges.faces)
    faces = faces[np.argsort(-np.linalg.norm(mesh.areas[faces], axis=1), kind="stable")]  # large ones tell planes best
    normals, heights = (
        mesh.normals[faces],
        np.einsum("ij,ij->i", mesh.normals[faces], mesh.vertices[mesh.faces[faces, 0]]),
    )
    is_in = (np.abs(ends @ normals.T - heights) <= 10.0 * allowed).all(axis=1)
    resolved = lengths @ is_in
    for plane in np.argsort(-resolved, kind="stable")[:MOST_TRIES].tolist():
        sides = cut_above(body, normals[plane], float(heights[plane]))
        if min(side.volume() for side in sides) > least:
            return [piece for side in sides for piece in separate(side.simplify(allowed))]
    return None


def cut_above(body: Any, normal: FloatArray, height: float) -> list[Any]:
    """Return what is above and below a plane along a face of the body: cut just above it, lest a film of rounding stays
    on the upper side, and then moved to it.
    """
    step = ABOVE * Triangles.of(body).size

    def onto(points: FloatArray) -> FloatArray:
        off = points @ normal - height
        moved: FloatArray = points - np.outer(np.where(np.abs(off) <= 1.5 * step, off, 0.0), normal)
        return moved

    return [side.warp_batch(onto) for side in body.split_by_plane(normal.tolist(), height + step)]


def separate(body: Any) -> list[Any]:
    """Return the parts of a body that do not hang together; all of it, where one is a cavity."""
    parts = body.decompose()
    return [body] if any(part.volume() < 0.0 for part in parts) else parts


def together(bodies: list[Any]) -> Any:
    """Return the union of bodies."""
    return manifold3d().Manifold.batch_boolean(bodies, manifold3d().OpType.Add)
