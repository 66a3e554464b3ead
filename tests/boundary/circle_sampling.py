"""Where circles are stationary in distance from something else, by sampling them densely: an oracle.

It knows nothing of the equation that the kernels solve. The slope of the distance is that of its definition, with
points in space; where it changes sign between two of 16,384 angles, bisection in long doubles finds the place.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.circles.beside_round import Round
from cagepose.kernels.circles.places import Circle

Array = NDArray[Any]

N_ANGLES = 16_384
ANGLES = -np.pi + 2.0 * np.pi * (np.arange(N_ANGLES) + 0.137) / N_ANGLES
NOISE = 1e-14
"""Of the size: a slope below it has no sign that can be trusted."""


class Asked(NamedTuple):
    """A circle, what its distance is from, and from which side of that, see `Sampled`."""

    circle: Circle
    other: Circle | Round
    side: float = 1.0


class Change(NamedTuple):
    """A sampled place of the pair with this index: between which angles its slope changes sign, and how."""

    index: int
    low: float
    high: float
    rises: bool


def size_of(circle: Circle, other: Circle | Round) -> float:
    """The greatest length in a pair, metres."""
    seen, there = np.array(circle.centre), np.array(other.point if isinstance(other, Round) else other.centre)
    return float(max(circle.radius, np.linalg.norm(seen - there), abs(other.radius), abs(seen).max()))


def units(vectors: Array) -> Array:
    return vectors / np.sqrt(np.sum(vectors * vectors, axis=1))[:, None]


class Sampled:
    """The distances of places of circles, given by angles, from something else, in floats of a kind.

    There is one pair for all angles, or one for each. All are of one kind, circles or not. Of another circle it is the
    distance from its near (side 1) or far side (side -1).
    """

    def __init__(self, pairs: Sequence[Asked], kind: Any = np.float64) -> None:
        circles, others = [pair.circle for pair in pairs], [pair.other for pair in pairs]
        is_round = isinstance(others[0], Round)
        axes = units(np.array([circle.axis for circle in circles], dtype=kind))
        toward = np.array([circle.toward for circle in circles], dtype=kind)
        toward = units(toward - np.sum(toward * axes, axis=1)[:, None] * axes)
        there = [other.point if isinstance(other, Round) else other.centre for other in others]
        along = [other.direction if isinstance(other, Round) else other.axis for other in others]
        seen = np.array([circle.centre for circle in circles], dtype=kind) - np.array(there, dtype=kind)
        self.toward, self.aside, self.seen = toward.T, np.cross(axes, toward).T, seen.T
        self.along = units(np.array(along, dtype=kind)).T
        self.radius = np.array([circle.radius for circle in circles], dtype=kind)
        self.around = np.array([pair.side * pair.other.radius for pair in pairs])
        """Radius of the other circles, below zero on their far sides; of something round, its sign alone counts."""
        self.taper = np.array([other.taper for other in others if isinstance(other, Round)]) if is_round else None

    def _at(self, cosine: Array, sine: Array) -> tuple[list[Array], list[Array], Array, list[Array], Array]:
        """Point, tangent, height, way across the axis and its length."""
        outward = [cosine * self.toward[k] + sine * self.aside[k] for k in range(3)]
        tangent = [cosine * self.aside[k] - sine * self.toward[k] for k in range(3)]
        point = [self.seen[k] + self.radius * outward[k] for k in range(3)]
        height = _dot(point, self.along)
        across = [point[k] - height * self.along[k] for k in range(3)]
        return point, tangent, height, across, np.sqrt(_dot(across, across))

    def from_axis(self, angles: Array) -> Array:
        """The distance from the axis of the other one."""
        return self._at(np.cos(angles), np.sin(angles))[4]

    def distance(self, angles: Array) -> Array:
        _, _, height, _, rho = self._at(np.cos(angles), np.sin(angles))
        if self.taper is not None:
            return np.copysign(1.0, self.around) * np.sqrt(1.0 - self.taper**2) * rho + self.taper * height
        return np.sqrt(height * height + (rho - self.around) ** 2)

    def slope(self, angles: Array) -> Array:
        return self.slope_along(np.cos(angles), np.sin(angles))

    def slope_along(self, cosine: Array, sine: Array) -> Array:
        """The slope of the distance a length, times a length: nowhere more than the size."""
        point, tangent, _, across, rho = self._at(cosine, sine)
        if self.taper is not None:
            slant = np.copysign(1.0, self.around) * np.sqrt(1.0 - self.taper**2)
            return slant * _dot(tangent, across) + self.taper * _dot(tangent, self.along) * rho
        scale = self.around / np.maximum(rho, 1e-100)
        return _dot(tangent, [point[k] - scale * across[k] for k in range(3)])


def _dot(one: Sequence[Array] | Array, other: Sequence[Array] | Array) -> Array:
    return one[0] * other[0] + one[1] * other[1] + one[2] * other[2]


BLOCKS = [(np.cos(block), np.sin(block)) for block in np.split(ANGLES, 4)]
"""Of angles, small enough to stay in the cache of a processor."""


def changes(index: int, asked: Asked) -> list[Change]:
    """All places of a pair that sampling finds."""
    sampled = Sampled([asked])
    slope = np.concatenate([sampled.slope_along(*block) for block in BLOCKS])
    told = np.flatnonzero(np.abs(slope) > NOISE * size_of(asked.circle, asked.other))
    if len(told) == 0:
        return []
    signs = slope[told] > 0.0
    at = np.flatnonzero(signs != np.roll(signs, -1))
    low, rises = ANGLES[told[at]], ~signs[at]
    high = ANGLES[np.roll(told, -1)[at]]
    high = np.where(high < low, high + 2.0 * np.pi, high)
    return [Change(index, *found) for found in zip(low, high, rises, strict=True)]


def stationary(pairs: Sequence[Asked], found: Sequence[Change]) -> Array:
    """The angles at which the slopes of pairs vanish, halving the stretches in which they change sign."""
    exact = Sampled([pairs[change.index] for change in found], np.longdouble)
    first = np.array([change.low for change in found], dtype=np.longdouble)
    last = np.array([change.high for change in found], dtype=np.longdouble)
    rises = np.array([change.rises for change in found])
    for _ in range(64):
        middle = (first + last) / 2
        is_before = (exact.slope(middle) > 0.0) != rises
        first, last = np.where(is_before, middle, first), np.where(is_before, last, middle)
    return first
