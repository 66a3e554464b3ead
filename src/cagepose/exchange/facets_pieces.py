"""A body of facets as convex pieces, which other programs need: `facets_pieces`."""

from __future__ import annotations

from typing import Any

import numpy as np

from cagepose.exchange.bodies import Scale
from cagepose.files.meshes.cuts import cut_until, separate
from cagepose.files.meshes.edges import hollow_depth
from cagepose.files.meshes.flat_sides import FlatSides
from cagepose.files.meshes.manifolds import Triangles, without_rounding
from cagepose.files.meshes.tolerances import ROUNDING_OF_MESH
from cagepose.model.checks import FloatArray
from cagepose.model.facets import Facets
from cagepose.model.shapes import Convex
from cagepose.model.surface import Mesh


def facets_pieces(shape: Facets) -> list[Convex] | None:
    """Return convex pieces, in the frame of the body, that are a body of facets together; None: they would be many.

    Raises
    ------
    MissingExtraError
        manifold3d is not installed.
    """
    scale = Scale.of(shape)
    body = without_rounding(scale.body(Mesh(shape.nodes_body(), shape.triangles)))
    sides = FlatSides.of(Triangles.of(body))

    def corners(piece: Any) -> FloatArray | None:
        is_convex = hollow_depth(piece, ROUNDING_OF_MESH) == 0.0
        return Triangles.of(piece.hull()).vertices if is_convex else None

    pieces = cut_until(separate(body), corners, sides, [])
    if pieces is None:
        return None
    return [Convex(np.asarray(scale.origin_m) + scale.unit_m * sides.taking(found)) for found in pieces]
