"""What does not change during a run (`Geometry`), and what follows from one pose (`Placement`): two boundaries."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.record import FloatArray, IntArray, Rows, empty_rows
from cagepose.kernels.algebra.vector import Vector
from cagepose.kernels.boundary.features import (
    Bodies,
    BodyPart,
    Boundary,
    Feature,
    PlacedBoundary,
    Placing,
    body_of,
    empty_placing,
    middle_of_part,
    number_of_bodies,
    place_boundary,
    placed_in,
)
from cagepose.kernels.boundary.groups import number_groups
from cagepose.kernels.boundary.meetings import find_meetings
from cagepose.kernels.boundary.overlap import (
    NO_OVERLAP,
    Overlap,
    OverlapWork,
    empty_overlap_work,
    find_overlap,
    with_shells_of,
)
from cagepose.kernels.boundary.queue import MOST_WAITING, Queue, empty_queue
from cagepose.kernels.boundary.touching import Meetings, empty_meetings, most_meetings
from cagepose.kernels.boundary.tree import FACES, VERTICES, Node
from cagepose.kernels.native.interrupt import heed_interrupt
from cagepose.kernels.native.kernel import entry, kernel

FEATURES_OF_PART = 64
"""What has so many times more features may touch in as many times more places."""


class Geometry(NamedTuple):
    """The boundaries of all bodies.

    Attributes
    ----------
    held
        All parts of the object, its own boxes first, in its frame.
    cage
        The bodies of the cage, each in its frame: first what stands still, its points first.
    placed
        Memory for these in the world, see `cage_at`.
    touch_m
        Parts within this distance touch.
    """

    held: Boundary
    cage: Bodies
    placed: Placing
    touch_m: float


class Placement(NamedTuple):
    """The object at one pose, and where it touches the cage.

    Attributes
    ----------
    body
        Memory for the object's boundary, see `held_at`.
    moved
        Memory for it at a pose that is tried, see `held_moved`.
    counts, first_rows
        How many meetings there are with each body of the cage, (n_bodies, 2), as in `Meetings.used`, and where they
        begin, (n_bodies + 1,).
    memory
        For all of them, see `meetings_with`.
    queue
        Memory for pairs of nodes that may touch on the way.
    """

    body: Placing
    moved: Placing
    counts: IntArray
    first_rows: IntArray
    memory: Meetings
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
    n_features = max(len(geometry.held.features), len(geometry.cage.own.features))
    rows_of_bodies = _rows_of_bodies(geometry)
    return Placement(
        empty_placing(geometry.held),
        empty_placing(geometry.held),
        np.zeros((len(rows_of_bodies), 2), np.int64),
        np.cumsum([0, *rows_of_bodies]),
        empty_meetings(n_features, sum(rows_of_bodies)),
        empty_queue(max(MOST_WAITING, len(geometry.held.features) + len(geometry.cage.own.features))),
    )


def _rows_of_bodies(geometry: Geometry) -> list[int]:
    """Return how many meetings with each body of the cage there is memory for (plain Python)."""
    held, parts = geometry.held, np.asarray(geometry.cage.own.parts)
    n_held = max(len(held.parts), len(held.features) // FEATURES_OF_PART)
    found = list[int]()
    for body in range(len(geometry.cage.first_nodes) - 1):
        n_features = _number_of_features(geometry.cage, body)
        of_body = parts["body"] == body
        n_points = int((of_body & (parts["point"] >= 0)).sum())
        n_others = max(int(of_body.sum()) - n_points, (n_features - n_points) // FEATURES_OF_PART)
        found.append(most_meetings(n_held, n_points, n_others))
    return found


def _number_of_features(bodies: Bodies, body: int) -> int:
    """Return how many features a body has (plain Python)."""
    first, nodes = int(bodies.first_nodes[body]), bodies.own.nodes
    return int(nodes[first + FACES].last - nodes[first + VERTICES].first)


def most_rows(geometry: Geometry) -> int:
    """Return how many meetings of the object with the cage there is memory for (plain Python)."""
    return sum(_rows_of_bodies(geometry))


def most_elements(geometry: Geometry) -> int:
    """Return how many points and shapes the cage has (plain Python)."""
    return len(geometry.cage.own.parts)


def empty_cage(geometry: Geometry) -> PlacedCage:
    """Return memory for the cage of a case (plain Python)."""
    own, n_bodies = geometry.cage.own, len(geometry.cage.first_nodes) - 1
    parts = np.asarray(own.parts)
    return PlacedCage(
        np.empty((int((parts["point"] >= 0).sum()), 3)),
        empty_placing(own, n_bodies),
        empty_rows(Feature, len(own.features)),
        empty_rows(BodyPart, len(own.parts)),
        empty_rows(Node, len(own.nodes)),
        empty_overlap_work(geometry.held, own, n_bodies),
    )


@kernel
def held_at(geometry: Geometry, placement: Placement) -> PlacedBoundary:
    """Return the object's boundary at its pose."""
    return placed_in(geometry.held, placement.body)


@kernel
def held_moved(geometry: Geometry, placement: Placement) -> PlacedBoundary:
    """Return memory for the object's boundary at a pose that is tried."""
    return placed_in(geometry.held, placement.moved)


@kernel
def cage_at(geometry: Geometry, body: int) -> PlacedBoundary:
    """Return one of the cage's bodies at its pose."""
    return body_of(geometry.cage, geometry.placed, body)


@kernel
def cage_of(geometry: Geometry, cage_feature: int) -> PlacedBoundary:
    """Return the body of the cage that a feature is of."""
    return cage_at(geometry, geometry.cage.own.parts[geometry.cage.own.features[cage_feature].part].body)


@kernel
def middle_of_cage_part(geometry: Geometry, part: int) -> Vector:
    """Return the middle of the ball around a part of the cage, in the world."""
    own = geometry.cage.own.parts[part]
    return middle_of_part(cage_at(geometry, own.body), part)


@kernel
def meetings_with(placement: Placement, body: int) -> Meetings:
    """Return where the object touches one of the cage's bodies."""
    first, last, memory = placement.first_rows[body], placement.first_rows[body + 1], placement.memory
    return Meetings(
        placement.counts[body],
        memory.rows[first:last],
        memory.order[first:last],
        memory.heads,
        memory.behind[first:last],
        memory.pairs,
        memory.places,
        memory.kept,
        memory.waiting,
        memory.heights,
    )


@entry
def place_object(geometry: Geometry, position: Vector, quaternion: Quaternion, placement: Placement) -> None:
    """Fill ``placement`` for the object at the given pose."""
    heed_interrupt()
    held = held_at(geometry, placement)
    place_boundary(held, position, quaternion)
    for body in range(number_of_bodies(geometry.cage)):
        cage, meetings = cage_at(geometry, body), meetings_with(placement, body)
        find_meetings(held, cage, geometry.touch_m, meetings)
        number_groups(held, cage, geometry.touch_m, meetings)


@entry
def overlap_at(
    geometry: Geometry, position: Vector, quaternion: Quaternion, placement: Placement, work: OverlapWork
) -> tuple[int, int, float]:
    """Return (feature of the object, feature of the cage, depth in metres) of what is deepest in each other with the
    object at a pose; (-1, -1, 0): nothing is, by more than the touch tolerance.
    """
    place_boundary(held_at(geometry, placement), position, quaternion)
    found = deepest_overlap(geometry, placement, work)
    return found.feature, found.cage_feature, found.depth_m


@kernel
def deepest_overlap(geometry: Geometry, placement: Placement, work: OverlapWork) -> Overlap:
    """Return how deep the object, where it is placed, and a body of the cage are in each other at most."""
    held, deepest = held_at(geometry, placement), NO_OVERLAP
    for body in range(number_of_bodies(geometry.cage)):
        found = find_overlap(held, cage_at(geometry, body), geometry.touch_m, with_shells_of(work, body))
        if found.depth_m > deepest.depth_m:
            deepest = found
    return deepest
