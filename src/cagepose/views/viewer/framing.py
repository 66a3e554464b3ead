"""What a picture begins with: what moves and touches, where the rest is much larger. `frame_of`.

A rail of 1.2 m that rests on rollers 0.2 m apart moves by a millimetre: a picture of all of it shows nothing. So of an
object that reaches far beyond what touches it, and hardly moves, only what is near that must be seen; and of the cage
only what is near the object. An inset shows where that is in the whole.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from cagepose.model.checks import FloatArray

MOVED = 0.25
"""An object is seen as a whole if any place of it goes so far in its own extents."""
MUCH_OBJECT, MUCH_CAGE = 4.0, 1.8
"""Not all of the object is seen if it is so many times as large as what touches it, nor all of the cage if it is so
many times as large as what is seen of the object.
"""
ROOM, LEAST_ROOM = 0.2, 0.06
"""What is near: a share of the extent, and at least this in drawing units."""


class Frame(NamedTuple):
    """What must be seen: the least and the greatest coordinates, (3,) each, drawing units."""

    low: FloatArray
    high: FloatArray

    @property
    def extent(self) -> float:
        """The longest side."""
        return float((self.high - self.low).max())

    def near(self) -> Frame:
        """Return it with room around it."""
        room = max(ROOM * self.extent, LEAST_ROOM)
        return Frame(self.low - room, self.high + room)

    def within(self, places: FloatArray) -> FloatArray:
        """Return places, (n, 3), those outside moved to where they are nearest within."""
        moved: FloatArray = np.clip(places, self.low, self.high)
        return moved


def frame_of(touching: FloatArray, held: Sequence[FloatArray], driven: FloatArray, rest: FloatArray) -> Frame | None:
    """Return what must be seen; None: all.

    Parameters
    ----------
    touching
        What touches or may, and the centre of gravity, (n, 3), drawing units as all else.
    held
        Places of the object, (n, 3), the same ones at each of some moments.
    driven, rest
        Places of the cage's bodies that are driven, and of the others, (n, 3).
    """
    everywhere = np.stack(held)
    moved = float(np.ptp(everywhere, axis=0).max())
    object_, core = _bounds(everywhere.reshape(-1, 3)), _bounds(touching)
    both = _bounds(np.stack([*object_, *core]))
    is_seen = moved > MOVED * object_.extent or both.extent <= MUCH_OBJECT * core.extent
    inner = _bounds(np.concatenate([np.stack(both if is_seen else core.near()), driven]))
    whole = _bounds(np.concatenate([np.stack(inner), rest]))
    if whole.extent > MUCH_CAGE * inner.extent:
        return inner.near()
    return None if is_seen else whole


def _bounds(places: FloatArray) -> Frame:
    return Frame(places.min(axis=0), places.max(axis=0))
