"""What does not change during a run (`Geometry`), and what follows from one pose (`Placement`): two boundaries."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.record import FloatArray, Rows, empty_rows
from cagepose.kernels.algebra.vector import Vector
from cagepose.kernels.boundary.features import (
    BodyPart,
    Boundary,
    Feature,
    PlacedBoundary,
    Placing,
    empty_placing,
    place_boundary,
    placed_in,
)
from cagepose.kernels.boundary.groups import number_groups
from cagepose.kernels.boundary.meetings import find_meetings
from cagepose.kernels.boundary.overlap import OverlapWork, empty_overlap_work, find_overlap
from cagepose.kernels.boundary.queue import MOST_WAITING, Queue, empty_queue
from cagepose.kernels.boundary.touching import Meetings, empty_meetings, most_meetings
from cagepose.kernels.boundary.tree import Node
from cagepose.kernels.native.interrupt import heed_interrupt
from cagepose.kernels.native.kernel import entry, kernel

FEATURES_OF_PART = 64
"""What has so many times more features may touch in as many times more places."""


class Geometry(NamedTuple):
    """The boundaries of two bodies.

    Attributes
    ----------
    held, cage
        All parts of the object, its own boxes first, in its frame, and of the cage, its points first, in the world.
    touch_m
        Parts within this distance touch.
    """

    held: Boundary
    cage: PlacedBoundary
    touch_m: float


class Placement(NamedTuple):
    """The object at one pose, and where it touches the cage.

    Attributes
    ----------
    body
        Memory for the object's boundary, see `held_at`.
    moved
        Memory for it at a pose that is tried, see `held_moved`.
    meetings
        Where it touches the cage's.
    queue
        Memory for pairs of nodes that may touch on the way.
    """

    body: Placing
    moved: Placing
    meetings: Meetings
    queue: Queue


class PlacedCage(NamedTuple):
    """Memory for the cage of a case, in the world: its points, (n_points, 3), metres; its boundary at a pose; as single
    points may be elsewhere from case to case, features, parts and trees of its own; and for the start check.
    """

    points_world: FloatArray
    placing: Placing
    features: Rows[Feature]
    parts: Rows[BodyPart]
    nodes: Rows[Node]
    overlap: OverlapWork


def empty_placement(geometry: Geometry) -> Placement:
    """Return a workspace for one placement (plain Python: making arrays in compiled code is slow to compile)."""
    n_features = max(len(geometry.held.features), len(geometry.cage.features))
    return Placement(
        empty_placing(geometry.held),
        empty_placing(geometry.held),
        empty_meetings(n_features, most_rows(geometry)),
        empty_queue(max(MOST_WAITING, len(geometry.held.features) + len(geometry.cage.own.features))),
    )


def most_rows(geometry: Geometry) -> int:
    """Return how many meetings of the two boundaries there is memory for (plain Python)."""
    held, own, n_points = geometry.held, geometry.cage.own, number_of_points(geometry)
    n_parts = max(len(held.parts), len(held.features) // FEATURES_OF_PART)
    n_others = max(len(own.parts) - n_points, (len(own.features) - n_points) // FEATURES_OF_PART)
    return most_meetings(n_parts, n_points, n_others)


def number_of_points(geometry: Geometry) -> int:
    """Return how many single points the cage has (plain Python)."""
    return int((np.asarray(geometry.cage.own.parts)["point"] >= 0).sum())


def most_elements(geometry: Geometry) -> int:
    """Return how many points and shapes the cage has (plain Python)."""
    return len(geometry.cage.own.parts)


def empty_cage(geometry: Geometry) -> PlacedCage:
    """Return memory for the cage of a case (plain Python)."""
    own = geometry.cage.own
    return PlacedCage(
        np.empty((number_of_points(geometry), 3)),
        empty_placing(own),
        empty_rows(Feature, len(own.features)),
        empty_rows(BodyPart, len(own.parts)),
        empty_rows(Node, len(own.nodes)),
        empty_overlap_work(geometry.held, own),
    )


@kernel
def held_at(geometry: Geometry, placement: Placement) -> PlacedBoundary:
    """Return the object's boundary at its pose."""
    return placed_in(geometry.held, placement.body)


@kernel
def held_moved(geometry: Geometry, placement: Placement) -> PlacedBoundary:
    """Return memory for the object's boundary at a pose that is tried."""
    return placed_in(geometry.held, placement.moved)


@entry
def place_object(geometry: Geometry, position: Vector, quaternion: Quaternion, placement: Placement) -> None:
    """Fill ``placement`` for the object at the given pose."""
    heed_interrupt()
    held = held_at(geometry, placement)
    place_boundary(held, position, quaternion)
    find_meetings(held, geometry.cage, geometry.touch_m, placement.meetings)
    number_groups(held, geometry.cage, geometry.touch_m, placement.meetings)


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
