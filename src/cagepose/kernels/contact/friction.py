"""Which coefficient of friction a contact has: that of its cage point, else of its box, else of the scene."""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.native.kernel import kernel


class Friction(NamedTuple):
    """Coefficients of friction of one case.

    Attributes
    ----------
    greatest
        Of all contacts that there can be.
    scene
        Of those whose point and box have none of their own.
    of_points, of_boxes
        Their own, (n_points,) and (n_boxes,); NaN: none.
    """

    greatest: float
    scene: float
    of_points: FloatArray
    of_boxes: FloatArray


@kernel
def friction_of(scene: float, of_points: FloatArray, of_boxes: FloatArray) -> Friction:
    """Return the coefficients of a case; see `Friction`."""
    greatest, boxes_count, scene_counts = 0.0, False, False
    for own in of_points:
        boxes_count = boxes_count or math.isnan(own)
        greatest = greatest if math.isnan(own) else max(greatest, own)
    if boxes_count:
        for own in of_boxes:
            scene_counts = scene_counts or math.isnan(own)
            greatest = greatest if math.isnan(own) else max(greatest, own)
    return Friction(max(greatest, scene) if scene_counts else greatest, scene, of_points, of_boxes)


@kernel
def friction_share(friction: Friction, point: int, box: int) -> float:
    """Return the coefficient of a contact as a part of the greatest one; 1 where there is no friction."""
    if friction.greatest == 0.0:
        return 1.0
    own = friction.of_points[point]
    if math.isnan(own):
        own = friction.of_boxes[box]
    return (friction.scene if math.isnan(own) else own) / friction.greatest
