"""Where names are written in a picture, so that none covers another. The same choice as in labels.js."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

PIXELS_BESIDE = 7.0
"""Pixels from a place to its name."""
PIXELS_TO_EDGE = 4.0
"""Pixels from the edge of the picture to a name."""
MOVED_BY, WAYS = (22.0, 40.0, 62.0, 90.0), 12
"""A name that has no room beside its place is moved so far, pixels, in one of so many directions."""
LEAST_LEADER = 14.0
"""Pixels from a place to its name, beyond which a line leads there."""

Pair = tuple[float, float]


Box = tuple[Pair, Pair]
"""Upper left corner, and size."""


def laid_out(
    places: Sequence[Pair], sizes: Sequence[Pair], picture: Pair, moving: Sequence[bool], taken: Sequence[Box] = ()
) -> list[Pair | None]:
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
    moving
        Of each name whether it may be moved away where there is no room beside its place.
    taken
        What no name may cover.
    """
    written = list(taken)
    marks = [((x - PIXELS_BESIDE / 2.0, y - PIXELS_BESIDE / 2.0), (PIXELS_BESIDE, PIXELS_BESIDE)) for x, y in places]
    corners: list[Pair | None] = []
    for which, (place, size) in enumerate(zip(places, sizes, strict=True)):
        others = [mark for index, mark in enumerate(marks) if index != which]
        beside = [_inside(corner, size, picture) for corner in _beside(place, size)]
        away = [corner for corner in _away(place, size) if corner == _inside(corner, size, picture)]
        free = [corner for corner in beside if not _meets(corner, size, written)]
        moved = [corner for corner in away if moving[which] and not _meets(corner, size, written)]
        clear = [corner for corner in [*free, *moved] if not _meets(corner, size, others)]
        chosen = next(iter([*clear, *free, *moved]), None)
        if chosen is not None:
            written.append((chosen, size))
        corners.append(chosen)
    return corners


def leader(place: Pair, corner: Pair, size: Pair) -> Pair | None:
    """Return where a line from a place to its name ends; None: the name is so near that it needs none."""
    x, y = (min(max(at, low), low + extent) for at, low, extent in zip(place, corner, size, strict=True))
    return (x, y) if math.dist(place, (x, y)) > LEAST_LEADER else None


def _beside(place: Pair, size: Pair) -> list[Pair]:
    """Return the corners that a name may have, the best one first."""
    (x, y), (width, height) = place, size
    right, left = x + PIXELS_BESIDE, x - PIXELS_BESIDE - width
    above, below, middle = y - PIXELS_BESIDE / 2.0 - height, y + PIXELS_BESIDE / 2.0, y - height / 2.0
    return [(right, above), (left, above), (right, below), (left, below), (right, middle), (left, middle)]


def _away(place: Pair, size: Pair) -> Iterator[Pair]:
    """Yield the corners of a name that is moved away, near ones first."""
    (x, y), (width, height) = place, size
    for distance in MOVED_BY:
        for way in range(WAYS):
            angle = 2.0 * math.pi * (way + 0.5) / WAYS
            across, down = math.cos(angle), -math.sin(angle)
            yield (
                x + distance * across - width * (1.0 - across) / 2.0,
                y + distance * down - height * (1.0 - down) / 2.0,
            )


def _inside(corner: Pair, size: Pair, picture: Pair) -> Pair:
    x, y = (
        max(PIXELS_TO_EDGE, min(room - extent - PIXELS_TO_EDGE, at))
        for at, extent, room in zip(corner, size, picture, strict=True)
    )
    return x, y


def _meets(corner: Pair, size: Pair, others: Sequence[Box]) -> bool:
    (ax, ay), (aw, ah) = corner, size
    return any(ax < bx + bw and bx < ax + aw and ay < by + bh and by < ay + ah for (bx, by), (bw, bh) in others)
