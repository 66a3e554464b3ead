"""What touches at one pose: rows of meetings."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np

from cagepose.kernels.algebra.record import FloatArray, IntArray, Rows, empty_rows
from cagepose.kernels.algebra.vector import minus, norm, vector_from
from cagepose.kernels.circles.places import Kept, Place
from cagepose.kernels.native.kernel import kernel

MOST_OF_PARTS, MOST_MEETINGS, MOST_OF_POINT = 128, 4096, 12
"""Meetings that there is memory for: of each pair of parts, and of all; and of each single point, over all of them,
beside those of one pair, as where a tip of many faces stands on a point.
"""
MOST_PAIRS, MOST_PLACES = 256, 16
"""Pairs of nodes that wait while two trees are descended; places of one circle."""
CHAIN_BITS = 2
"""There are so many times two fewer chains of meetings than there is memory for meetings."""
SAME_PLACE = 4.0
"""In touch tolerances: meetings nearer to each other are at one place."""
SAME_NORMAL = 1e-9
"""Radians. Meetings at one place with normals nearer than this are one."""
HALF_SECTOR = math.pi / 4.0
"""Radians."""


class Along(NamedTuple):
    """Where on a circle two features meet: see `Touching`."""

    angle: float
    before: float
    after: float


AT_ONE_PLACE = Along(0.0, 0.0, 0.0)
"""Of features without a circle."""


class Touching:
    """Two features that touch; a record.

    Attributes
    ----------
    feature, cage_feature
        Indices.
    twin, cage_twin
        Features that meet at the same place with the same normal and bend more; -1: none do.
    beside, cage_beside
        A face of either body that is flush there with that which meets; -1: none is.
    angle
        Where on a circle, if one of them is one, radians; of two, on the object's.
    before, after
        How far to either side along that circle, about its axis, it touches as it does there, radians, up to
        `HALF_SECTOR`; both zero: nowhere else. A ball seated in a hole's slanted wall touches it along a circle about
        the wall's axis.
    gap, normal, place
        As in `Meeting`.
    is_kept
        Whether a contact there carries, so that a motion keeps it.
    group
        Index of the first row that it is an alternative to: the object is out of the cage there if it is along one of
        the normals of a group. A row that is the first of its group has its own.
    """

    feature: int
    cage_feature: int
    twin: int
    cage_twin: int
    beside: int
    cage_beside: int
    angle: float
    before: float
    after: float
    gap: float
    normal: Annotated[FloatArray, 3]
    place: Annotated[FloatArray, 3]
    is_kept: bool
    group: int


class Meetings(NamedTuple):
    """What touches at one pose.

    Attributes
    ----------
    used
        How many rows count, -1: there are more than there is memory for; and how many there are with those behind them
        that a motion keeps at other places of a circle than are listed, (2,).
    rows
        One for each meeting.
    order
        Memory for their indices in another order.
    heads, behind
        Memory for chains of rows, see `neighbours`: the first of each, and the next one behind each row.
    pairs
        Memory for pairs of nodes, (MOST_PAIRS, 2).
    places, kept
        Memory for the places of a circle, and for those of them that touch.
    waiting
        Memory for nodes, (MOST_PAIRS,), that wait while one tree is descended.
    heights
        Memory for how far a vertex is above faces, (n_features,) of the body that has more, metres.
    """

    used: IntArray
    rows: Rows[Touching]
    order: IntArray
    heads: IntArray
    behind: IntArray
    pairs: IntArray
    places: Rows[Place]
    kept: Rows[Kept]
    waiting: IntArray
    heights: FloatArray


def most_meetings(n_parts: int, n_points: int, n_others: int) -> int:
    """Return how many meetings there is memory for of so many parts with single points and others (plain Python)."""
    n_pairs = n_parts * n_others + min(n_points, 1)
    return MOST_OF_POINT * n_points + min(MOST_OF_PARTS * n_pairs, MOST_MEETINGS)


def empty_meetings(n_features: int, n_rows: int = MOST_MEETINGS) -> Meetings:
    """Return memory for so many meetings of two boundaries, of which none has more features (plain Python)."""
    pairs, places = np.zeros((MOST_PAIRS, 2), np.int64), empty_rows(Place, MOST_PLACES)
    return Meetings(
        np.zeros(2, np.int64),
        empty_rows(Touching, n_rows),
        np.zeros(n_rows, np.int64),
        np.zeros(1 << max(3, n_rows.bit_length() - CHAIN_BITS), np.int64),
        np.zeros(n_rows, np.int64),
        pairs,
        places,
        empty_rows(Kept, MOST_PLACES),
        np.zeros(MOST_PAIRS, np.int64),
        np.zeros(n_features),
    )


@kernel
def is_around(row: Touching) -> bool:
    """Whether a circle touches along an arc as it does at the place of a meeting."""
    return bool(row.before + row.after > 0.0)


@kernel
def is_at_place(found: Meetings, one: int, other: int, touch_m: float) -> bool:
    """Whether two meetings are at one place."""
    between = minus(vector_from(found.rows[one].place), vector_from(found.rows[other].place))
    return norm(between) <= SAME_PLACE * touch_m
