"""Where a circle is stationary in distance from something else, by sampling it densely: an oracle.

It knows nothing of the equation that the kernels solve. The slope of the distance is that of its definition, with
points in space; where it changes sign between two of 16,384 angles, bisection in long doubles finds the place.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.boundary.circle_and_round import Round
from cagepose.kernels.boundary.circle_places import Circle

Array = NDArray[Any]

N_ANGLES = 16_384
NOISE = 1e-14
"""Of the size: a slope below it has no sign that can be trusted."""


class Stationary(NamedTuple):
    """A sampled place: between which angles the slope changes sign, whether it rises there, and the root."""

    low: float
    high: float
    rises: bool
    angle: float


def size_of(circle: Circle, other: Circle | Round) -> float:
    """The greatest length in a pair, metres."""
    seen, there = np.array(circle.centre), np.array(other.point if isinstance(other, Round) else other.centre)
    return float(max(circle.radius, np.linalg.norm(seen - there), abs(other.radius), abs(seen).max()))


def unit(vector: Array) -> Array:
    return vector / np.sqrt(np.sum(vector * vector))


class Sampled:
    """The distance of places of a circle, given by angles, from something else, in floats of a kind.

    Of another circle it is that from its near (side 1) or far side (side -1).
    """

    def __init__(self, circle: Circle, other: Circle | Round, side: float = 1.0, kind: Any = np.float64) -> None:
        self.other, self.side, self.size = other, side, size_of(circle, other)
        self.radius, self.axis = kind(circle.radius), unit(np.array(circle.axis, dtype=kind))
        toward = np.array(circle.toward, dtype=kind)
        self.toward = unit(toward - np.sum(toward * self.axis) * self.axis)
        self.aside = np.cross(self.axis, self.toward)
        there, along = (other.point, other.direction) if isinstance(other, Round) else (other.centre, other.axis)
        self.seen, self.along = (
            np.array(circle.centre, dtype=kind) - np.array(there, dtype=kind),
            unit(np.array(along, kind)),
        )

    def _at(self, angles: Array) -> tuple[Array, Array, Array, Array, Array]:
        """Point, tangent, height, way across the axis and its length."""
        cosine, sine = np.cos(angles), np.sin(angles)
        outward = [cosine * self.toward[k] + sine * self.aside[k] for k in range(3)]
        tangent = np.stack([cosine * self.aside[k] - sine * self.toward[k] for k in range(3)])
        point = np.stack([self.seen[k] + self.radius * outward[k] for k in range(3)])
        height = sum(point[k] * self.along[k] for k in range(3))
        across = np.stack([point[k] - height * self.along[k] for k in range(3)])
        return point, tangent, height, across, np.sqrt(np.sum(across * across, axis=0))

    def from_axis(self, angles: Array) -> Array:
        """The distance from the axis of the other one."""
        return self._at(angles)[4]

    def distance(self, angles: Array) -> Array:
        _, _, height, _, rho = self._at(angles)
        if isinstance(self.other, Round):
            taper = self.other.taper
            return np.copysign(1.0, self.other.radius) * np.sqrt(1.0 - taper**2) * rho + taper * height
        return np.sqrt(height * height + (rho - self.side * self.other.radius) ** 2)

    def slope(self, angles: Array) -> Array:
        """The slope of the distance a length, times a length: nowhere more than the size."""
        point, tangent, _, across, rho = self._at(angles)
        if isinstance(self.other, Round):
            taper = self.other.taper
            slant = np.copysign(1.0, self.other.radius) * np.sqrt(1.0 - taper**2)
            lean = sum(tangent[k] * self.along[k] for k in range(3))
            return slant * np.sum(tangent * across, axis=0) + taper * lean * rho
        scale = self.side * self.other.radius / np.maximum(rho, 1e-100)
        return np.sum(tangent * (point - scale * across), axis=0)


def stationary(circle: Circle, other: Circle | Round, side: float = 1.0) -> list[Stationary]:
    """All places that sampling finds."""
    angles = -np.pi + 2.0 * np.pi * (np.arange(N_ANGLES) + 0.137) / N_ANGLES
    sampled = Sampled(circle, other, side)
    slope = sampled.slope(angles)
    told = np.flatnonzero(np.abs(slope) > NOISE * sampled.size)
    if len(told) == 0:
        return []
    signs = slope[told] > 0.0
    changes = np.flatnonzero(signs != np.roll(signs, -1))
    low, rises = angles[told[changes]], ~signs[changes]
    high = angles[np.roll(told, -1)[changes]]
    high = np.where(high < low, high + 2.0 * np.pi, high)
    exact = Sampled(circle, other, side, np.longdouble)
    first, last = low.astype(np.longdouble), high.astype(np.longdouble)
    for _ in range(64):
        middle = (first + last) / 2
        is_before = (exact.slope(middle) > 0.0) != rises
        first, last = np.where(is_before, middle, first), np.where(is_before, last, middle)
    return [Stationary(*found) for found in zip(low, high, rises, first, strict=True)]
