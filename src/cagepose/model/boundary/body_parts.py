"""The parts of a body as kernels take them, each with a ball around it; and a boundary seen from elsewhere."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from cagepose.kernels.algebra.record import dtype_of
from cagepose.kernels.boundary.features import BodyPart, Boundary
from cagepose.model.checks import FloatArray
from cagepose.model.hole import Hole
from cagepose.model.shapes import Shape, Turned


def body_parts(parts: Sequence[Shape | FloatArray]) -> Any:
    """Return the rows of parts in the frame of their body; which features single points are is written later."""
    solids = [part for part in parts if isinstance(part, Shape) and not isinstance(part, Hole)]
    return np.array([(0, *_ball(part, solids), -1) for part in parts], dtype_of(BodyPart))


def _ball(part: Shape | FloatArray, solids: Sequence[Shape]) -> tuple[FloatArray, float]:
    """Return a ball around a part: its middle and its reach, metres."""
    if isinstance(part, np.ndarray):
        return part, 0.0
    if isinstance(part, Hole):
        within = [solid for solid in solids if solid.name in part.in_]
        depth, _ = part.run_through(within)
        wide = max(radius for _, radius in part.rims)
        reach = math.hypot(wide, 0.5 * depth)
        return part.pose_body_shape.transform(np.array((0.0, 0.0, -0.5 * depth))), reach
    if isinstance(part, Turned):
        middle = 0.5 * (part.rims[0][0] + part.rims[-1][0])
        place = part.pose_body_shape.transform(np.array((0.0, 0.0, middle)))
        return place, part.farthest_m(place)
    place = part.nodes_body().mean(axis=0)
    return place, part.farthest_m(place)


def shifted(boundary: Boundary, by: FloatArray) -> Boundary:
    """Return a boundary moved by a travel, metres."""
    if len(boundary.features) == 0:
        return boundary
    moved: Any = Boundary(*[np.array(rows) for rows in boundary])
    moved.features["point"] += by
    moved.nodes["middle"] += by
    moved.parts["middle"] += by
    moved.covers["point"] += by
    moved.planes[3] += moved.planes[:3].T @ by
    moved.planes[5:] += np.concatenate([by, by])[:, None]
    return Boundary(*moved)
