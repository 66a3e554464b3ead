"""Shapes stretched along a direction, as far as they are then shapes of ours: `stretched`."""

from __future__ import annotations

import math
from functools import singledispatch
from typing import NamedTuple

import numpy as np

from cagepose.model.box import Box
from cagepose.model.checks import FloatArray
from cagepose.model.facets import Facets
from cagepose.model.hole import Chamfer, Hole
from cagepose.model.pose import Pose
from cagepose.model.shapes import Cone, Convex, Cylinder, Shape, Turned

ALONG = 1e-12
"""Radians. An axis that is this near to the direction is along it."""


class Stretch(NamedTuple):
    """Points of a body move along a unit vector (3,) of its frame: heights along it above a level, metres, become so
    many times as great.
    """

    axis: FloatArray
    level_m: float
    times: float

    def moved(self, points_body: FloatArray) -> FloatArray:
        """Return where points (..., 3) go."""
        heights = points_body @ self.axis - self.level_m
        found: FloatArray = points_body + (self.times - 1.0) * heights[..., None] * self.axis
        return found

    def pose(self, pose_body_shape: Pose) -> Pose:
        """Return a pose with its place moved."""
        return Pose(self.moved(pose_body_shape.position_m), pose_body_shape.quaternion_wxyz)

    def axis_along(self, shape: Shape) -> int | None:
        """Return which axis of a shape is along it; None: none is."""
        across = np.linalg.norm(np.cross(shape.pose_body_shape.rotation.T, self.axis), axis=1)
        return int(across.argmin()) if across.min() <= ALONG else None


@singledispatch
def stretched(_shape: Shape, _by: Stretch) -> Shape | None:
    """Return a shape of a body that is stretched; None: it is no shape of ours, as a ball that becomes an ellipsoid."""
    return None


@stretched.register
def _box(box: Box, by: Stretch) -> Shape | None:
    along = by.axis_along(box)
    if along is None:
        return Convex(by.moved(box.corners_object()), name=box.name)
    return Box(np.where(np.arange(3) == along, by.times, 1.0) * box.size_m, by.pose(box.pose_body_shape), box.name)


@stretched.register
def _convex(convex: Convex, by: Stretch) -> Shape | None:
    if convex.radius_m > 0.0:
        return None
    return Convex(by.moved(convex.pose_body_shape.transform(convex.vertices_m)), name=convex.name)


@stretched.register
def _facets(facets: Facets, by: Stretch) -> Shape | None:
    if facets.is_round:
        return None
    corners = by.moved(facets.pose_body_shape.transform(facets.vertices_m))
    return Facets(corners, facets.triangles, facets.flat_m, name=facets.name)


@stretched.register
def _turned(shape: Turned, by: Stretch) -> Shape | None:
    """What is flat keeps its measures."""
    return shape.moved(by.pose(shape.pose_body_shape)) if by.axis_along(shape) == 2 else None


@stretched.register
def _cylinder(bar: Cylinder, by: Stretch) -> Shape | None:
    if by.axis_along(bar) != 2:
        return None
    return Cylinder(bar.radius_m, by.times * bar.length_m, by.pose(bar.pose_body_shape), bar.name)


@stretched.register
def _cone(cone: Cone, by: Stretch) -> Shape | None:
    if by.axis_along(cone) != 2:
        return None
    radii = cone.radius_bottom_m, cone.radius_top_m
    return Cone(*radii, by.times * cone.length_m, by.pose(cone.pose_body_shape), cone.name)


@stretched.register
def _hole(hole: Hole, by: Stretch) -> Shape | None:
    if by.axis_along(hole) != 2:
        return None
    chamfer = hole.chamfer
    if chamfer is not None:
        chamfer = Chamfer(chamfer.width_m, math.atan(math.tan(chamfer.angle_rad) / by.times))
    return Hole(hole.radius_m, by.times * hole.depth_m, chamfer, hole.in_, by.pose(hole.pose_body_shape), hole.name)
