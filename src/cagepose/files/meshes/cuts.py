"""A body with flat sides as convex pieces, exactly: cut along the faces at its hollow edges: `cut_until`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from cagepose.files.meshes.edges import reflex_edges
from cagepose.files.meshes.flat_sides import FlatSides
from cagepose.files.meshes.manifolds import Triangles, manifold3d
from cagepose.files.meshes.tolerances import HEIGHT_OF_CUT, LEAST_PIECE, ROUNDING_OF_MESH, SINE_ACROSS, SINGLE_PRECISION
from cagepose.model.checks import FloatArray
from cagepose.model.hole import Hole

Piece = TypeVar("Piece")

MOST_PIECES = 60
"""What needs more is round where no shape of ours is."""
MOST_TRIES = 8
"""So many planes may cut nothing off, at an edge that rounding has tilted."""
DISTANCE_OF_CUT = 1.5 * SINGLE_PRECISION
"""Fraction of a body's size. What is as near to the plane of a cut is in it. It is more than single precision, as such
a plane is rounded itself."""
MOST_EDGES = 500
"""Hollow ones of a body that is cut."""


def cut_until(
    parts: Sequence[Any], known: Callable[[Any], Piece | None], sides: FlatSides, holes: Sequence[Hole]
) -> list[Piece] | None:
    """Return what is known of bodies that are some bodies together and share no volume; None: it needs too many.

    Parameters
    ----------
    parts
        Bodies, their holes filled.
    known
        Says it of a convex body, and maybe of another; None: it has to be cut.
    sides
        Of the bodies.
    holes
        Cuts run along as few of them as may be.
    """
    least = LEAST_PIECE * sum(part.volume() for part in parts)
    allowed = ROUNDING_OF_MESH * max((Triangles.of(part).size for part in parts), default=0.0)
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
            halves = _cut(part, least, allowed, sides, holes)
            if halves is None:
                return None
            waiting += halves
        if len(pieces) + len(waiting) > MOST_PIECES:
            return None
    return pieces


def _cut(body: Any, least: float, allowed: float, sides: FlatSides, holes: Sequence[Hole]) -> list[Any] | None:
    """Return the two sides of the plane that runs along the fewest holes, of these the one in which the most of the
    hollow edges lie; None: there is none.
    """
    mesh = Triangles.of(body)
    edges = reflex_edges(mesh, allowed)
    if not 0 < len(edges.corners) <= MOST_EDGES:
        return None
    ends = mesh.vertices[edges.corners]
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    faces = np.unique(edges.faces)
    faces = faces[np.argsort(-np.linalg.norm(mesh.areas[faces], axis=1), kind="stable")]  # large ones tell planes best
    normals, heights = sides.planes(mesh, faces)
    is_in = (np.abs(ends @ normals.T - heights) <= 10.0 * allowed).all(axis=1)
    resolved = lengths @ is_in
    n_along = sum((_run_along(hole, normals, heights, allowed) for hole in holes), np.zeros(len(faces)))
    for plane in np.lexsort((-resolved, n_along))[:MOST_TRIES].tolist():
        halves = cut_above(body, normals[plane], float(heights[plane]))
        if min(half.volume() for half in halves) > least:
            return tidy(halves, allowed)
    return None


def _run_along(hole: Hole, normals: FloatArray, heights: FloatArray, allowed: float) -> NDArray[np.bool_]:
    """Return which planes, each a unit normal (n, 3) and a height (n,), divide a hole other than across its axis."""
    aslant = np.linalg.norm(np.cross(normals, hole.pose_body_shape.rotation[:, 2]), axis=1)
    centers = hole.pose_body_shape.transform(np.array([(0.0, 0.0, height) for height, _ in hole.rims]))
    off = centers @ normals.T - heights
    reach = np.outer([radius for _, radius in hole.rims], aslant)
    is_cut = ((off - reach).min(axis=0) < -allowed) & ((off + reach).max(axis=0) > allowed)
    found: NDArray[np.bool_] = is_cut & (aslant > SINE_ACROSS)
    return found


def cut_above(body: Any, normal: FloatArray, height: float) -> list[Any]:
    """Return what is above and below a plane along a face of the body.

    What is in the plane but for rounding is moved into it, and the body is cut just above, lest a film of the face
    stays on the upper side.
    """
    size = Triangles.of(body).size

    def within(distance: float, points: FloatArray) -> FloatArray:
        off = points @ normal - height
        moved: FloatArray = points - np.outer(np.where(np.abs(off) <= distance, off, 0.0), normal)
        return moved

    flat = body.warp_batch(partial(within, DISTANCE_OF_CUT * size))
    sides = flat.split_by_plane(normal.tolist(), height + HEIGHT_OF_CUT * size)
    return [side.warp_batch(partial(within, 2.0 * HEIGHT_OF_CUT * size)) for side in sides]


def tidy(bodies: Sequence[Any], allowed: float) -> list[Any]:
    """Return the parts that hang together of bodies that were cut, without corners and films that are rounding."""
    parts = [part for body in bodies for part in separate(body.as_original().simplify(allowed))]
    return [part for part in parts if part.volume() > allowed * part.surface_area()]


def separate(body: Any) -> list[Any]:
    """Return the parts of a body that do not hang together; all of it, where one is a cavity."""
    parts = body.decompose()
    return [body] if any(part.volume() < 0.0 for part in parts) else parts


def together(bodies: list[Any]) -> Any:
    """Return the union of bodies."""
    return manifold3d().Manifold.batch_boolean(bodies, manifold3d().OpType.Add)
