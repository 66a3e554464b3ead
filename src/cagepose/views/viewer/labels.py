"""Where names are written in a picture, so that none covers another."""

from __future__ import annotations

from collections.abc import Sequence

PIXELS_BESIDE = 7.0
"""Pixels from a place to its name."""
PIXELS_TO_EDGE = 4.0
"""Pixels from the edge of the picture to a name."""

Pair = tuple[float, float]


def laid_out(places: Sequence[Pair], sizes: Sequence[Pair], picture: Pair) -> list[Pair | None]:
    """Return the upper left corner of each name; None where there is no room for it.

    Earlier ones choose first. A name keeps off places of others where it can, off other names always, and within the
    picture.

    Parameters
    ----------
    places
        What is named, in pixels, y down.
    sizes
        Width and height of each name as it is written.
    picture
        Width and height of the picture.
    """
    written: list[tuple[Pair, Pair]] = []
    marks = [((x - PIXELS_BESIDE / 2.0, y - PIXELS_BESIDE / 2.0), (PIXELS_BESIDE, PIXELS_BESIDE)) for x, y in places]
    corners: list[Pair | None] = []
    for which, (place, size) in enumerate(zip(places, sizes, strict=True)):
        inside = [_inside(corner, size, picture) for corner in _beside(place, size)]
        free = [corner for corner in inside if not any(_meet((corner, size), other) for other in written)]
        others = [mark for index, mark in enumerate(marks) if index != which]
        clear = [corner for corner in free if not any(_meet((corner, size), mark) for mark in others)]
        chosen = next(iter([*clear, *free]), None)
        if chosen is not None:
            written.append((chosen, size))
        corners.append(chosen)
    return corners


def _beside(place: Pair, size: Pair) -> list[Pair]:
    """Return the corners that a name may have, the best one first."""
    (x, y), (width, height) = place, size
    right, left = x + PIXELS_BESIDE, x - PIXELS_BESIDE - width
    above, below, middle = y - PIXELS_BESIDE / 2.0 - height, y + PIXELS_BESIDE / 2.0, y - height / 2.0
    return [(right, above), (left, above), (right, below), (left, below), (right, middle), (left, middle)]


def _inside(corner: Pair, size: Pair, picture: Pair) -> Pair:
    x, y = (
        max(PIXELS_TO_EDGE, min(room - extent - PIXELS_TO_EDGE, at))
        for at, extent, room in zip(corner, size, picture, strict=True)
    )
    return x, y


def _meet(one: tuple[Pair, Pair], other: tuple[Pair, Pair]) -> bool:
    (ax, ay), (aw, ah) = one
    (bx, by), (bw, bh) = other
    return ax < bx + bw and bx < ax + aw and ay < by + bh and by < ay + ah
