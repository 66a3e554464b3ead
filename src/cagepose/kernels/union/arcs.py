"""Runs of material around a line between two faces of a union: its edges, and borders of its faces."""

from __future__ import annotations

from typing import Annotated

from cagepose.kernels.algebra.record import FloatArray, IntArray, Rows
from cagepose.kernels.native.kernel import kernel

SMOOTH, CONVEX, CONCAVE = 0, 1, 2
"""A run of half a turn, of less and of more."""


class Arc:
    """Material around a line from one face of the union to another; a record.

    The first face is where the material begins, seen in the sense of a turn about ``direction``, the second where it
    ends.

    Attributes
    ----------
    kind
        See above.
    start, end
        Of the line, metres.
    direction
        Unit vector from the start to the end.
    slacks
        How far the start and the end may be off, metres.
    planes, sides, parts
        Of both faces: plane, 1.0 or -1.0 (see `PieceFace.side`), and the first of the parts that it belongs to.
    normals
        Of both faces, outward unit vectors.
    inward
        Unit vectors from the line into both faces.
    is_border
        Of both faces, whether they end here, 1 or 0: a face may go on beyond the line.
    """

    kind: int
    start: Annotated[FloatArray, 3]
    end: Annotated[FloatArray, 3]
    direction: Annotated[FloatArray, 3]
    slacks: Annotated[FloatArray, 2]
    planes: Annotated[IntArray, 2]
    sides: Annotated[FloatArray, 2]
    parts: Annotated[IntArray, 2]
    normals: Annotated[FloatArray, 2, 3]
    inward: Annotated[FloatArray, 2, 3]
    is_border: Annotated[IntArray, 2]


@kernel
def is_continued(arcs: Rows[Arc], first: int, new: int) -> bool:
    """Make an earlier arc of the same line longer, if the new one goes on where it ends, and return whether it does."""
    for k in range(first, new):
        if _goes_on(arcs[k], arcs[new]):
            for j in range(3):
                arcs[k].end[j] = arcs[new].end[j]
            arcs[k].slacks[1] = arcs[new].slacks[1]
            return True
    return False


@kernel
def _goes_on(arc: Arc, new: Arc) -> bool:
    for j in range(3):
        if arc.end[j] != new.start[j]:
            return False
    for j in range(2):
        if arc.planes[j] != new.planes[j] or arc.sides[j] != new.sides[j] or arc.parts[j] != new.parts[j]:
            return False
        if arc.is_border[j] != new.is_border[j]:
            return False
    return arc.kind == new.kind
