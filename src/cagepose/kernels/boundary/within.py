"""Whether a place is in a boundary, and how deep: asked in the frame of the body, of trees of boxes.

Along a ray out of the place, surfaces are left less often than they are entered if it is outside. Counted with their
sign, surfaces of parts that overlap are right, too: a place in two parts is left twice.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from cagepose.kernels.algebra.record import IntArray
from cagepose.kernels.algebra.vector import Vector, dot, vector_from
from cagepose.kernels.boundary.features import Boundary
from cagepose.kernels.boundary.surfaces import (
    crossing,
    distance_from,
    has_surface,
    height_over,
    most_crossings,
    normal_of_face,
)
from cagepose.kernels.boundary.tree import FACES, Node
from cagepose.kernels.native.kernel import kernel

OUTSIDE, AT_SURFACE = -1.0, 0.0
"""Instead of a depth: not in the body; or within what touches of its surface, on either side."""
ASIDE, FARTHER_ASIDE = 0.0173, 0.1091
"""A ray leads along an axis of the body but for these, which few borders of ordinary parts lie along; each try leads
farther aside."""
TRIES, LEAST_SLOPE = 6, 1e-9
"""Rays that are tried until one passes no border closely, and grazes no surface."""


class Nearest(NamedTuple):
    """The surface that is nearest to a place: how far it is at least, metres, and of which feature; -1: none."""

    distance: float
    feature: int


@kernel
def root_has_surfaces(own: Boundary, root: int) -> bool:
    node = own.nodes[root]
    return node.first < node.last and (root == FACES or node.is_rounded)


@kernel
def beyond_box(node: Node, place: Vector) -> float:
    """Return how far a place is beyond a box along one of its axes at least; below zero: within it."""
    farthest = -math.inf
    for k in range(3):
        farthest = max(farthest, abs(place[k] - node.middle[k]) - node.half[k])
    return farthest


@kernel
def is_beyond_all(own: Boundary, place: Vector, touch_m: float) -> bool:
    """Whether a place is farther than what touches from the boxes around all features that have a surface."""
    least = math.inf
    for root in range(3):
        if root_has_surfaces(own, root):
            least = min(least, beyond_box(own.nodes[root], place))
    return least > touch_m


@kernel
def nearest_surface(own: Boundary, place: Vector, within_m: float, waiting: IntArray) -> Nearest:
    """Return the nearest surface, if it is nearer than a length."""
    best, feature = within_m, -1
    for root in range(3):
        if not root_has_surfaces(own, root):
            continue
        waiting[0], n_waiting = root, 1
        while n_waiting > 0:
            n_waiting -= 1
            node = own.nodes[waiting[n_waiting]]
            if beyond_box(node, place) >= best:
                continue
            if node.left >= 0:
                near, far = node.left, node.right
                if beyond_box(own.nodes[far], place) < beyond_box(own.nodes[near], place):
                    near, far = far, near
                waiting[n_waiting], waiting[n_waiting + 1] = far, near
                n_waiting += 2
                continue
            for i in range(node.first, node.last):
                if root == FACES and abs(height_over(own, i, place)) >= best:
                    continue
                if has_surface(own.features[i]):
                    distance = distance_from(own, i, place, best)
                    if distance < best:
                        best, feature = distance, i
    return Nearest(best, feature)


@kernel
def ray_way(axis: int, sense: float, attempt: int) -> Vector:
    """Return the unit vector along a ray that leads nearly along an axis."""
    one, other = ASIDE + attempt * FARTHER_ASIDE, 0.618 * ASIDE - 0.734 * attempt * FARTHER_ASIDE
    size = math.sqrt(1.0 + one * one + other * other)
    way = (sense / size, one / size, other / size)
    return way if axis == 0 else ((way[2], way[0], way[1]) if axis == 1 else (way[1], way[2], way[0]))


@kernel
def ray_misses(node: Node, start: Vector, way: Vector, slack_m: float) -> bool:
    """Whether a ray passes by a box farther than a length; no coordinate of its direction is zero."""
    begin, end = 0.0, math.inf
    for k in range(3):
        middle, half = (node.middle[k] - start[k]) / way[k], (node.half[k] + slack_m) / abs(way[k])
        begin, end = max(begin, middle - half), min(end, middle + half)
    return begin > end


@kernel
def winding_along(own: Boundary, start: Vector, way: Vector, slack_m: float, waiting: IntArray) -> tuple[bool, int]:
    """Return how many times more surfaces are left than entered along a ray; False: it passes one too closely."""
    n_left = 0
    for root in range(3):
        if not root_has_surfaces(own, root):
            continue
        waiting[0], n_waiting = root, 1
        while n_waiting > 0:
            n_waiting -= 1
            node = own.nodes[waiting[n_waiting]]
            if ray_misses(node, start, way, slack_m):
                continue
            if node.left >= 0:
                waiting[n_waiting], waiting[n_waiting + 1] = node.left, node.right
                n_waiting += 2
                continue
            for i in range(node.first, node.last):
                if root == FACES and height_over(own, i, start) * dot(normal_of_face(own, i), way) >= 0.0:
                    continue
                if not has_surface(own.features[i]):
                    continue
                for which in range(most_crossings(own.features[i])):
                    met = crossing(own, i, start, way, math.inf, 0.0, which)
                    if not met.is_one or met.beyond > slack_m:
                        continue
                    if met.beyond >= -slack_m or abs(met.slope) < LEAST_SLOPE:
                        return False, 0
                    n_left += 1 if met.slope > 0.0 else -1
    return True, n_left


@kernel
def is_within(own: Boundary, place: Vector, slack_m: float, waiting: IntArray) -> bool:
    """Whether a place that is on no surface is in a body. A ray must not pass borders closer than a length."""
    axis, sense, least = 0, 1.0, math.inf
    low, high = limits_of(own)
    for k in range(3):
        if place[k] - low[k] < least:
            axis, sense, least = k, -1.0, place[k] - low[k]
        if high[k] - place[k] < least:
            axis, sense, least = k, 1.0, high[k] - place[k]
    for attempt in range(TRIES):
        is_clear, n_left = winding_along(own, place, ray_way(axis, sense, attempt), slack_m, waiting)
        if is_clear:
            return n_left > 0
    return False


@kernel
def limits_of(own: Boundary) -> tuple[Vector, Vector]:
    """Return the lowest and the highest coordinates of the surfaces of a body."""
    low, high = (math.inf, math.inf, math.inf), (-math.inf, -math.inf, -math.inf)
    for root in range(3):
        if root_has_surfaces(own, root):
            node = own.nodes[root]
            m, h = vector_from(node.middle), vector_from(node.half)
            low = (min(low[0], m[0] - h[0]), min(low[1], m[1] - h[1]), min(low[2], m[2] - h[2]))
            high = (max(high[0], m[0] + h[0]), max(high[1], m[1] + h[1]), max(high[2], m[2] + h[2]))
    return low, high


@kernel
def depth_in(own: Boundary, place: Vector, touch_m: float, waiting: IntArray) -> Nearest:
    """Return how deep a place is in a body at least, and the surface that it is nearest to; `OUTSIDE`, `AT_SURFACE`."""
    if is_beyond_all(own, place, touch_m):
        return Nearest(OUTSIDE, -1)
    near = nearest_surface(own, place, touch_m, waiting)
    if near.feature >= 0:
        return Nearest(AT_SURFACE, near.feature)
    if not is_within(own, place, touch_m, waiting):
        return Nearest(OUTSIDE, -1)
    return nearest_surface(own, place, math.inf, waiting)
