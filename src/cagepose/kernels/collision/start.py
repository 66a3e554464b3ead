"""Whether two boundaries are in each other where the object starts."""

from __future__ import annotations

from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.vector import Vector
from cagepose.kernels.boundary.features import place_boundary
from cagepose.kernels.boundary.overlap import OverlapWork, find_overlap
from cagepose.kernels.collision.geometry import Geometry, Placement, held_at
from cagepose.kernels.native.kernel import entry


@entry
def overlap_at(
    geometry: Geometry, position: Vector, quaternion: Quaternion, placement: Placement, work: OverlapWork
) -> tuple[int, int, float]:
    """Return (feature of the object, feature of the cage, depth in metres) of what is deepest in each other with the
    object at a pose; (-1, -1, 0): nothing is, by more than the touch tolerance.
    """
    held = held_at(geometry, placement)
    place_boundary(held, position, quaternion)
    found = find_overlap(held, geometry.cage, geometry.touch_m, work)
    return found.feature, found.cage_feature, found.depth_m
