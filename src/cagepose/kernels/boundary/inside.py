"""Whether a place on a plane lies in a trimmed face, its border included: crossing parity."""

from __future__ import annotations

from typing import Protocol

from cagepose.kernels.algebra.record import FloatArray, Rows
from cagepose.kernels.algebra.vector import Vector, dot, minus, norm, plus, scaled, vector_from
from cagepose.kernels.native.kernel import entry, kernel


class Segment(Protocol):
    """What has a start and an end, metres."""

    start: FloatArray
    end: FloatArray


@entry
def is_in_face(
    place: Vector, normal: Vector, borders: Rows[Segment], first: int, last: int, tolerance_m: float
) -> bool:
    """Whether a place on the plane of a face lies within its borders ``first`` to ``last``, the last one not included.

    What is within ``tolerance_m`` of a border belongs to the face. For all other places the borders are crossed on the
    way out, an odd number of times from within: exactly so, as borders that follow each other share their ends.
    """
    n_crossings = 0
    for b in range(first, last):
        if _distance(place, vector_from(borders[b].start), vector_from(borders[b].end)) <= tolerance_m:
            return True
        n_crossings += crossings_above(borders[b], place, normal)
    return n_crossings % 2 == 1


@kernel
def _distance(place: Vector, start: Vector, end: Vector) -> float:
    way, arm = minus(end, start), minus(place, start)
    share = min(max(dot(arm, way) / dot(way, way), 0.0), 1.0)
    return norm(minus(place, plus(start, scaled(way, share))))


@kernel
def crossings_above(border: Segment, place: Vector, normal: Vector) -> int:
    """Return 1 if a segment crosses the way from a place along one axis of its plane, else 0.

    The plane is seen along the axis of space that its normal is closest to: that changes no crossing.
    """
    start, end = border.start, border.end
    size = (abs(normal[0]), abs(normal[1]), abs(normal[2]))
    if size[0] >= size[1] and size[0] >= size[2]:
        x, y, at_x, at_y = 1, 2, place[1], place[2]
    elif size[1] >= size[2]:
        x, y, at_x, at_y = 2, 0, place[2], place[0]
    else:
        x, y, at_x, at_y = 0, 1, place[0], place[1]
    if (start[x] > at_x) == (end[x] > at_x):
        return 0
    height = start[y] + (at_x - start[x]) / (end[x] - start[x]) * (end[y] - start[y])
    return 1 if height > at_y else 0
