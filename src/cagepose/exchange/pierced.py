"""A convex part with round holes as convex pieces: wedges around each hole, and what is below its bottom.

Each wedge is the part cut by planes: two through the hole's axis, one along the hole's wall, and one above and below.
The walls touch the hole from outside, so that what is round meets them where it would meet the hole.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from cagepose.exchange.bodies import Scale
from cagepose.files.meshes.tolerances import LEAST_PIECE
from cagepose.model.checks import FloatArray, unit_rows
from cagepose.model.hole import Hole
from cagepose.model.shapes import Convex, Shape
from cagepose.model.surface import shape_mesh

SIDES_OF_ROUND = 128
"""Flat sides that stand for something round."""
SIDES_AROUND_HOLES = 512
"""Flat sides of a round part with holes: each wedge has few of them."""


def pierced_pieces(part: Shape, holes: Sequence[Hole]) -> list[Convex]:
    """Return convex pieces (in the body's frame) that are a convex part without its parallel holes.

    Raises
    ------
    MissingExtraError
        manifold3d is not installed.
    """
    scale = Scale.of(part)
    whole = scale.body(shape_mesh(part, SIDES_AROUND_HOLES))
    pieces = []
    for hole in holes:
        cell = whole
        for other in holes:
            if other is not hole:
                one, two = hole.pose_body_shape.position_m, other.pose_body_shape.position_m
                axis = hole.pose_body_shape.rotation[:, 2]
                across = (one - two) - ((one - two) @ axis) * axis
                cell = scale.above(cell, unit_rows(across[None])[0], (one + two) / 2.0)
        pieces += _around(cell, hole, scale.above)
    least = LEAST_PIECE * whole.volume()
    return [Convex(scale.mesh(piece).vertices_m) for piece in pieces if piece.volume() > least]


def _around(cell: Any, hole: Hole, cut: Callable[[Any, FloatArray, FloatArray], Any]) -> list[Any]:
    """Return the pieces of a cell around its hole; ``cut`` as `Scale.above`."""
    place, turn = hole.pose_body_shape, hole.pose_body_shape.rotation
    axis = turn[:, 2]
    pieces = [cut(cell, -axis, place.transform((0.0, 0.0, hole.rims[0][0])))]
    for side in range(SIDES_OF_ROUND):
        angle, half = 2.0 * math.pi * side / SIDES_OF_ROUND, math.pi / SIDES_OF_ROUND
        wedge = cell
        for along, sign in ((angle - half, 1.0), (angle + half, -1.0)):
            beside = turn @ (-sign * math.sin(along), sign * math.cos(along), 0.0)
            wedge = cut(wedge, beside, place.position_m)
        out = np.array((math.cos(angle), math.sin(angle), 0.0))
        for (low, low_radius), (high, high_radius) in pairwise(hole.rims):
            wall = unit_rows(np.array([out * (high - low) - (0.0, 0.0, high_radius - low_radius)]))[0]
            piece = cut(wedge, turn @ wall, place.transform(low_radius * out + (0.0, 0.0, low)))
            piece = cut(piece, axis, place.transform((0.0, 0.0, low)))
            is_mouth = high == hole.rims[-1][0]
            pieces.append(piece if is_mouth else cut(piece, -axis, place.transform((0.0, 0.0, high))))
    return pieces
