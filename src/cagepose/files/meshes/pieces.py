"""A body, its round holes filled, as shapes that we know: `known_pieces`."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

from cagepose.files.meshes.around_holes import cut_at_steps, set_apart
from cagepose.files.meshes.convex_shapes import Recognised, convex_shape
from cagepose.files.meshes.cuts import cut_until
from cagepose.files.meshes.edges import hollow_depth
from cagepose.files.meshes.flat_sides import FlatSides
from cagepose.files.meshes.manifolds import Triangles, manifold3d, without_rounding
from cagepose.files.meshes.tolerances import LEAST_SHARED, ROUNDING_OF_MESH
from cagepose.model.box import Box
from cagepose.model.hole import Hole
from cagepose.model.shapes import Convex, Shape
from cagepose.model.surface import shape_mesh

MOST_CORNERS = 300
"""A convex hull has at most so many corners; what has more stays facets, which take less time."""
SHARE_OF_HULL = 0.97
"""Share of its hull's volume. What is round has more."""
DEPTH_OF_DENT = 10.0 * ROUNDING_OF_MESH
"""Fraction of the size. What is hollow by less is so by rounding, or as corners were left out that stood out by that.
"""
CHORDS_OF_ROUND = 64
"""Chords of what is round, where it is asked whether a hole is in a piece."""


def known_pieces(body: Any, holes: Sequence[Hole]) -> list[Recognised] | None:
    """Return the one convex shape that a body is; or boxes and round shapes that it is cut into; None: it is neither.

    What is around a hole that is divided by cuts is set apart before them, so that it is one shape.

    Parameters
    ----------
    body
        Of a size of one half to one.
    holes
        They are filled in it.
    """
    sides = FlatSides.of(Triangles.of(body))
    parts = cut_at_steps(body, holes)
    if len(parts) == 1 and hollow_depth(body, DEPTH_OF_DENT) is not None:
        alone = _recognised(sides, body)
        return None if alone is None else [alone]
    known = partial(_recognised_as_known, sides)
    pieces = cut_until(parts, known, sides, holes)
    if pieces is None:
        return None
    divided = [hole for hole in holes if hole.divided_by(parts_of(hole, [one.shape for one in pieces]))]
    if divided:
        blocks, rest = set_apart(body, divided)
        pieces = cut_until([*blocks, *cut_at_steps(rest, holes)], known, sides, holes) or pieces
    return pieces


def parts_of(hole: Hole, shapes: Sequence[Shape]) -> list[Shape]:
    """Return the shapes that a hole is cut out of."""
    plug = _body(hole)
    least = LEAST_SHARED * plug.volume()
    return [shape for shape in shapes if (plug ^ _body(shape)).volume() > least]


def _recognised_as_known(sides: FlatSides, piece: Any) -> Recognised | None:
    """Return the box or the round shape that a piece is; None: it is neither."""
    found = _recognised(sides, piece)
    if found is None or (isinstance(found.shape, Convex) and found.shape.radius_m == 0.0):
        return None
    return found


def _recognised(sides: FlatSides, piece: Any) -> Recognised | None:
    """Return the shape of a convex piece; None: it is not convex, or has too many corners.

    Triangles between the corners of what is round may be a little hollow.
    """
    depth = hollow_depth(piece, DEPTH_OF_DENT)
    if depth is None:
        is_round = piece.volume() >= SHARE_OF_HULL * piece.hull().volume()
        return convex_shape(Triangles.of(piece)) if is_round else None
    error = depth if depth > DEPTH_OF_DENT else 0.0
    surface = without_rounding(piece.hull())
    found = convex_shape(Triangles.of(surface))
    if found is not None and (error == 0.0 or not isinstance(found.shape, Box)):
        return Recognised(found.shape, found.error + error)
    corners = Triangles.of(surface).vertices
    if len(corners) > MOST_CORNERS or error > 0.0:
        return None
    in_sides = sides.taking(corners)
    is_flat = manifold3d().Manifold.hull_points(in_sides).volume() < 0.5 * surface.hull().volume()  # a thin one
    return Recognised(Convex(corners if is_flat else in_sides), error)


def _body(shape: Shape) -> Any:
    mesh = shape_mesh(shape, CHORDS_OF_ROUND)
    return Triangles(mesh.vertices_m, mesh.triangles).body()
