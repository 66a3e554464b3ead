"""Boxes around features in binary trees: which features of two bodies are near, or may meet on a motion.

There are three trees, of vertices, of edges and of faces, as these meet with different ones of the other body. A box
has the axes of its body; placed in the world it is widened to the world's axes.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from cagepose.kernels.algebra.motion import Motion, velocity_at
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.vector import Matrix, Vector, dot, minus, norm, plus, scaled, times, vector_from
from cagepose.kernels.native.kernel import kernel

VERTICES, EDGES, FACES = 0, 1, 2
"""The first three nodes: the roots of the trees. Lines and circles are edges."""
SAFE = 1.0 + 1e-9
"""So that rounding passes over nothing that is just in reach."""


class Node:
    """A box around some features; a record.

    Attributes
    ----------
    middle, half
        Its middle and half its edges, in the frame of the body, metres, radii of the features included.
    left, right
        Its two halves; -1: it is a leaf.
    first, last
        Its features, the last one not included: those of a root may be none.
    is_rounded, has_circles
        Of a root: whether one of its features has a radius, and whether one is a circle.
    """

    middle: Annotated[FloatArray, 3]
    half: Annotated[FloatArray, 3]
    left: int
    right: int
    first: int
    last: int
    is_rounded: bool
    has_circles: bool


@kernel
def may_touch(root: int, one: Node, other_root: int, other: Node) -> bool:
    """Whether features of two trees can touch: a face meets vertices and circles, edges meet edges, and the others need
    a radius.
    """
    if root == FACES or other_root == FACES:
        edges = other if root == FACES else one
        return root != other_root and (VERTICES in (root, other_root) or edges.has_circles)
    return (root == EDGES and other_root == EDGES) or one.is_rounded or other.is_rounded


class PlacedBox(NamedTuple):
    """A box with the axes of the world: its middle and half its edges, metres."""

    middle: Vector
    half: Vector


@kernel
def placed_box(node: Node, position: Vector, rotation: Matrix) -> PlacedBox:
    """Return the box of the world around a node of a body at a pose."""
    half, r = node.half, rotation
    return PlacedBox(
        plus(position, times(rotation, vector_from(node.middle))),
        (
            abs(r[0][0]) * half[0] + abs(r[0][1]) * half[1] + abs(r[0][2]) * half[2],
            abs(r[1][0]) * half[0] + abs(r[1][1]) * half[1] + abs(r[1][2]) * half[2],
            abs(r[2][0]) * half[0] + abs(r[2][1]) * half[1] + abs(r[2][2]) * half[2],
        ),
    )


@kernel
def boxes_apart(one: PlacedBox, other: PlacedBox) -> float:
    """Return how far apart two boxes are along one of the axes at least; below zero: they overlap."""
    between = minus(other.middle, one.middle)
    return max(
        abs(between[0]) - one.half[0] - other.half[0],
        abs(between[1]) - one.half[1] - other.half[1],
        abs(between[2]) - one.half[2] - other.half[2],
    )


class Span(NamedTuple):
    """Amounts of a motion between which two boxes may overlap; from inf: they never do."""

    begin: float
    end: float


@kernel
def span_of_overlap(one: PlacedBox, other: PlacedBox, motion: Motion, end: float, within_m: float) -> Span:
    """Return between which amounts, up to ``end``, a box that moves may come within a length of one that does not.

    A point of the box moves by s v, give or take s times what its velocity differs from that of the middle now: by the
    turn up to the end, and by how far it is from the middle.
    """
    velocity, half = velocity_at(motion, one.middle), one.half
    turning = norm(minus(velocity, scaled(motion.axis, dot(motion.axis, velocity)))) if motion.rate > 0.0 else 0.0
    differs = turning * min(motion.rate * end, 2.0) + motion.rate * norm(half)
    between, begin = minus(other.middle, one.middle), 0.0
    for k in range(3):
        apart = half[k] + other.half[k] + within_m
        fastest, slowest = velocity[k] + differs, velocity[k] - differs
        from_below, from_above = between[k] - apart, between[k] + apart  # may overlap while s slowest <= from_above ...
        if from_below > 0.0:
            begin = max(begin, from_below / fastest if fastest > 0.0 else math.inf)
        elif fastest < 0.0:
            end = min(end, from_below / fastest)
        if from_above < 0.0:
            begin = max(begin, from_above / slowest if slowest < 0.0 else math.inf)
        elif slowest > 0.0:
            end = min(end, from_above / slowest)
    begin /= SAFE
    return Span(begin, SAFE * end) if begin <= SAFE * end else Span(math.inf, math.inf)
