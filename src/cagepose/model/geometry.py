"""Nouns as the arrays that kernels take."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from cagepose.kernels.boundary.features import Bodies, Boundary, Placing, body_of, empty_placing, place_boundary
from cagepose.kernels.boundary.geometry import Geometry
from cagepose.kernels.collision.boxes import BoxesAndPoints
from cagepose.model.boundary.bodies import joined
from cagepose.model.boundary.features import boundary_of
from cagepose.model.cage import Cage
from cagepose.model.checks import FloatArray
from cagepose.model.hole import Hole
from cagepose.model.parts import Object
from cagepose.model.seams import PlacedBox, Seams, close_seams
from cagepose.model.shapes import Shape

Part = Shape | FloatArray
"""A shape, a hole, or a point (3,)."""


def object_seams(held: Object, touch_m: float) -> Seams:
    """Close the seams between boxes that meet flush within ``touch_m``.

    Those of the last few objects are remembered: what moves from scene to scene of a study or a viewer is the cage, and
    fifty boxes take longer to compare with each other than the scene to run.
    """
    numbers = [np.concatenate([box.half_size, box.position, box.rotation.ravel()]) for box in _placed(held)]
    return _seams_of(np.array(numbers).tobytes(), touch_m)


@lru_cache(maxsize=8)
def _seams_of(boxes: bytes, touch_m: float) -> Seams:
    rows = np.frombuffer(boxes).reshape(-1, 15)
    return close_seams([PlacedBox(row[:3], row[3:6], row[6:].reshape(3, 3)) for row in rows], touch_m)


def boxes_and_points(held: Object, cage: Cage, bridges: list[PlacedBox]) -> BoxesAndPoints:
    """Return the boxes in the object's frame, its own first and then the bridges, and the cage points in the world."""
    placed = _placed(held) + bridges
    return BoxesAndPoints(
        half_sizes=np.array([box.half_size for box in placed]).reshape(-1, 3),
        box_positions=np.array([box.position for box in placed]).reshape(-1, 3),
        box_rotations=np.array([box.rotation for box in placed]).reshape(-1, 3, 3),
        n_own_boxes=len(held.boxes),
        points_world=np.ascontiguousarray(cage.points_world()),
    )


def scene_geometry(held: Object, cage: Cage, touch_m: float) -> Geometry:
    """Return the boundaries of the object, in its frame, and of the cage, in the world."""
    bodies = cage_bodies(cage, touch_m)
    return Geometry(_boundary((*held.parts, *held.holes), touch_m), bodies, placed_bodies(cage, bodies), touch_m)


def pair_geometry(parts: Sequence[Part], others: Sequence[Part], touch_m: float) -> Geometry:
    """Return the boundaries of parts of an object and of elements of one body of a cage, each in the frame of its body,
    with memory for the second at a pose. Parts have the numbers of these sequences.
    """
    own = _boundary(tuple(others), touch_m)
    bodies = joined([own], [np.arange(len(others))])
    return Geometry(_boundary(tuple(parts), touch_m), bodies, empty_placing(own, 1), touch_m)


def placed_bodies(cage: Cage, bodies: Bodies) -> Placing:
    """Return the bodies of a cage in the world, where they start, in memory of their own."""
    n_bodies = len(bodies.first_nodes) - 1
    memory = empty_placing(bodies.own, n_bodies)
    for body in range(n_bodies):
        place_boundary(body_of(bodies, memory, body), *cage.pose_world_cage.as_tuples())
    return memory


def cage_bodies(cage: Cage, touch_m: float) -> Bodies:
    """Return what of the cage stands still, then its bodies where they start, all in the frame of the cage. Parts have
    the numbers of `Cage.element_names`.
    """
    elements, body_of_each = (*cage.points_cage, *cage.shapes, *cage.holes), np.array(cage.element_bodies)
    numbers = [np.flatnonzero(body_of_each == body) for body in range(1 + len(cage.bodies))]
    return joined([_boundary(tuple(elements[k] for k in own.tolist()), touch_m) for own in numbers], numbers)


def _boundary(parts: tuple[Part, ...], touch_m: float) -> Boundary:
    """Return the boundary of a body. Those of the last few bodies are remembered, as seams are."""
    keys = (
        part.tobytes() if isinstance(part, np.ndarray) else (part.form, part.name, *part.pose_body_shape.key)
        for part in parts
    )
    holes = tuple(part.in_ for part in parts if isinstance(part, Hole))
    return _boundary_of(_Body((*keys, *holes), parts), touch_m)


@dataclass(frozen=True)
class _Body:
    """The parts of a body, and all that their boundary depends on."""

    key: tuple[object, ...]
    parts: tuple[Part, ...] = field(compare=False)


@lru_cache(maxsize=16)
def _boundary_of(body: _Body, touch_m: float) -> Boundary:
    return boundary_of(body.parts, touch_m)


def has_shapes(held: Object, cage: Cage) -> bool:
    """Whether a scene has other shapes than boxes and points."""
    return bool(held.shapes or held.holes or cage.shapes or cage.holes)


def _placed(held: Object) -> list[PlacedBox]:
    return [
        PlacedBox(box.size_m / 2.0, box.pose_object_box.position_m, box.pose_object_box.rotation) for box in held.boxes
    ]


def scene_size(held: Object, cage: Cage) -> float:
    """The scene's length scale, metres: the diameter of the object or of the cage, whichever is greater.

    Each is measured as twice the greatest distance from the middle, so the size does not depend on any frame.
    """
    return max(object_size(held), _body_size(cage.nodes_cage(), (*cage.shapes, *cage.holes)))


def sizes_with_points(held: Object, cage: Cage, points_cage: FloatArray) -> FloatArray:
    """The sizes of scenes whose cage has other points, (n, n_points, 3), metres; (n,)."""
    shapes = (*cage.shapes, *cage.holes)
    if not shapes:
        sizes: FloatArray = np.maximum(object_size(held), cage_sizes(points_cage))
        return sizes
    nodes = np.concatenate([shape.nodes_body() for shape in shapes])
    of_cage = [_body_size(np.concatenate([points, nodes]), shapes) for points in points_cage]
    with_shapes: FloatArray = np.maximum(object_size(held), np.array(of_cage))
    return with_shapes


def object_size(held: Object) -> float:
    """The object's diameter, metres."""
    nodes = [part.nodes_body() for part in (*held.parts, *held.holes)]
    return _body_size(np.concatenate(nodes), (*held.shapes, *held.holes))


def _body_size(nodes: FloatArray, shapes: tuple[Shape, ...]) -> float:
    """The diameter of all nodes of a body and of its shapes, about the middle of the nodes."""
    middle = nodes.mean(axis=0)
    return max(float(cage_sizes(nodes)), *(2.0 * shape.farthest_m(middle) for shape in shapes), 0.0)


def body_limits(shapes: Sequence[Shape], points: FloatArray | None = None) -> FloatArray:
    """The lowest and highest coordinates of shapes and points (n, 3) in their body's frame, (2, 3), metres."""
    ends = np.array([shape.limits_m() for shape in shapes]).reshape(-1, 2, 3)
    lows, highs = np.moveaxis(ends, 1, 0)
    given = np.zeros((0, 3)) if points is None else points
    return np.array([np.concatenate([lows, given]).min(axis=0), np.concatenate([highs, given]).max(axis=0)])


def cage_sizes(points: FloatArray) -> FloatArray:
    """The diameters of sets of points (..., n, 3), metres."""
    squares = (points - points.mean(axis=-2, keepdims=True)) ** 2
    sizes: FloatArray = 2.0 * np.sqrt((squares[..., 0] + squares[..., 1] + squares[..., 2]).max(axis=-1))
    return sizes
