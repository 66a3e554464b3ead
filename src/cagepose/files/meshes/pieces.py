"""A body as convex shapes, its round holes filled, and made coarser where that needs too many: `convex_pieces`."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any, NamedTuple

from cagepose.files.meshes.around_holes import cut_at_steps, set_apart
from cagepose.files.meshes.convex_shapes import Recognised, convex_shape
from cagepose.files.meshes.cuts import cut_until
from cagepose.files.meshes.edges import hollow_depth, reflex_edges
from cagepose.files.meshes.flat_sides import FlatSides
from cagepose.files.meshes.manifolds import Triangles, manifold3d, without_rounding
from cagepose.files.meshes.surface_distance import farthest_from
from cagepose.files.meshes.tolerances import LEAST_SHARED, ROUNDING_OF_MESH
from cagepose.model.hole import Hole
from cagepose.model.shapes import Convex, Shape
from cagepose.model.surface import shape_mesh

MOST_CORNERS = 300
"""A convex shape has at most so many corners: the time of runs grows with the square of it."""
MOST_TRIANGLES = 10_000
"""A body that is not convex has at most so many triangles; more of them are simplified first."""
FIRST_STEP = 1e-5
"""Fraction of the size. Corners are moved first by this where there are too many."""
HALVINGS_OF_STEP = 4
"""The last such step is halved so many times for a convex body: as many of its corners as may be should stay."""
SHARE_OF_HULL = 0.97
"""Share of its hull's volume. What is round has more."""
COARSER_STEPS = (0.0, *(1e-4 * 2.0**step for step in range(7)))
"""Fractions of the size. Corners of a body may be moved by these so that fewer cuts do. coacd is off by 0.01 to 0.04.
"""
MOST_HOLLOW = 300
"""Edges of a body that is made coarser: more are not cut by few planes."""
DEPTH_OF_DENT = 10.0 * ROUNDING_OF_MESH
"""Fraction of the size. What is hollow by less is so by rounding, or as corners were left out that stood out by that.
"""
CHORDS_OF_ROUND = 64
"""Chords of what is round, where it is asked whether a hole is in a piece."""


class Pieces(NamedTuple):
    """Convex shapes that are a body together, and by how much the body that they were cut out of is off from it."""

    found: list[Recognised]
    error: float


def simplified(body: Any) -> tuple[Any, float]:
    """Return a body that is not convex with fewer triangles, where it has too many, and how far they are moved."""
    if body.num_tri() <= MOST_TRIANGLES or hollow_depth(body, DEPTH_OF_DENT) is not None:
        return body, 0.0
    tolerance, moved = FIRST_STEP, 0.0
    while body.num_tri() > MOST_TRIANGLES:
        body, moved = body.simplify(tolerance), moved + tolerance
        tolerance *= 2.0
    return body, moved


def convex_pieces(body: Any, holes: Sequence[Hole]) -> Pieces | None:
    """Return the convex shapes that a body is cut into; None: it needs too many.

    Where that is as it has fillets or the like, it is made coarser, until it does not. What is around a hole that is
    divided by cuts is set apart before them, so that it is one shape.

    Parameters
    ----------
    body
        Of a size of one half to one.
    holes
        They are filled in it.
    """
    sides = FlatSides.of(Triangles.of(body))
    known = partial(_recognised, sides)
    n_triangles = 0
    for tolerance in COARSER_STEPS:
        coarse = body.simplify(tolerance) if tolerance > 0.0 else body
        is_new = coarse.num_tri() != n_triangles
        if not is_new or (
            tolerance > 0.0 and len(reflex_edges(Triangles.of(coarse), ROUNDING_OF_MESH).corners) > MOST_HOLLOW
        ):
            continue
        n_triangles = coarse.num_tri()
        pieces = cut_until(cut_at_steps(coarse, holes), known, sides, holes)
        if pieces is None:
            continue
        divided = [hole for hole in holes if hole.divided_by(parts_of(hole, [one.shape for one in pieces]))]
        if divided:
            blocks, rest = set_apart(coarse, divided)
            pieces = cut_until([*blocks, *cut_at_steps(rest, holes)], known, sides, holes) or pieces
        return Pieces(pieces, _distance(Triangles.of(body), Triangles.of(coarse)) if tolerance > 0.0 else 0.0)
    return None


def parts_of(hole: Hole, shapes: Sequence[Shape]) -> list[Shape]:
    """Return the shapes that a hole is cut out of."""
    plug = _body(hole)
    least = LEAST_SHARED * plug.volume()
    return [shape for shape in shapes if (plug ^ _body(shape)).volume() > least]


def _distance(one: Triangles, other: Triangles) -> float:
    return max(farthest_from(one, other), farthest_from(other, one))


def _recognised(sides: FlatSides, piece: Any) -> Recognised | None:
    """Return the shape of a convex piece, with fewer corners where it has too many; None: it is not convex.

    Triangles between the corners of a cone may be a little hollow.
    """
    depth = hollow_depth(piece, DEPTH_OF_DENT)
    if depth is None:
        is_round = piece.volume() >= SHARE_OF_HULL * piece.hull().volume()
        return convex_shape(Triangles.of(piece)) if is_round else None
    error = depth if depth > DEPTH_OF_DENT else 0.0
    surface = without_rounding(piece.hull())
    found = convex_shape(Triangles.of(surface))
    if found is not None:
        return Recognised(found.shape, found.error + error)
    corners = Triangles.of(surface).vertices
    if len(corners) > MOST_CORNERS:
        corners = Triangles.of(_with_fewer_corners(surface).hull()).vertices
        error += farthest_from(Triangles.of(surface), Triangles.of(manifold3d().Manifold.hull_points(corners)))
    in_sides = sides.taking(corners)
    is_flat = manifold3d().Manifold.hull_points(in_sides).volume() < 0.5 * surface.hull().volume()  # a thin one
    return Recognised(Convex(corners if is_flat else in_sides), error)


def _with_fewer_corners(body: Any) -> Any:
    """Return a body with as many corners as are allowed, and not many fewer."""
    found, tolerance = body.simplify(FIRST_STEP), FIRST_STEP
    while found.num_vert() > MOST_CORNERS:
        body, tolerance = found, 2.0 * tolerance
        found = body.simplify(tolerance)
    few, many = tolerance, tolerance / 2.0
    for _ in range(HALVINGS_OF_STEP):
        middle = (few + many) / 2.0
        simple = body.simplify(middle)
        if simple.num_vert() <= MOST_CORNERS:
            found, few = simple, middle
        else:
            many = middle
    return found


def _body(shape: Shape) -> Any:
    mesh = shape_mesh(shape, CHORDS_OF_ROUND)
    return Triangles(mesh.vertices_m, mesh.triangles).body()
