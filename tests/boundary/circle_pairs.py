"""Random pairs of a circle and something else, among them what people draw: in line, flush, touching, equal."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.circles.beside_round import Round
from cagepose.kernels.circles.places import Circle

Array = NDArray[Any]


def turned(rng: np.random.Generator) -> Array:
    """A rotation; one in three leaves the axes of the world where they are."""
    if rng.random() < 1 / 3:
        return np.eye(3)[rng.permutation(3)] if rng.random() < 0.5 else np.eye(3)
    q = rng.normal(size=4)
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def small(rng: np.random.Generator) -> float:
    """From 1e-16 to 1, of either sign."""
    return float(rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(-16.0, 0.0))


def tilted(rng: np.random.Generator) -> Array:
    """A unit vector: along the axis z, across it, nearly so, or any."""
    kind, around = rng.integers(6), rng.uniform(0.0, 2 * np.pi) if rng.random() < 0.5 else 0.5 * np.pi * rng.integers(4)
    tilt = [0.0, small(rng), 0.5 * np.pi, 0.5 * np.pi + small(rng), rng.uniform(0.0, np.pi), rng.uniform(0.0, np.pi)]
    sine, cosine = np.sin(tilt[kind]), np.cos(tilt[kind])
    if kind == 2:
        cosine = 0.0
    return np.array([sine * np.cos(around), sine * np.sin(around), cosine])


def offset(rng: np.random.Generator, lengths: list[float]) -> float:
    """Zero, one of some lengths or nearly that, or any."""
    size, kind = max(lengths), rng.integers(6)
    drawn = float(rng.choice(lengths) * rng.choice([-1.0, 1.0]))
    return float([0.0, small(rng) * size, drawn, drawn + small(rng) * size, rng.normal(), rng.normal()][kind]) * (
        size if kind > 3 else 1.0
    )


def radius_beside(rng: np.random.Generator, radius: float) -> float:
    """Another radius: the same, nearly the same, similar, or from 1e-6 to 1e6 times as large."""
    kind = rng.integers(4)
    return radius * float([1.0, 1.0 + 0.5 * small(rng), rng.uniform(0.2, 5.0), 10.0 ** rng.uniform(-6.0, 6.0)][kind])


def scattered(
    rng: np.random.Generator, centre: Array, direction: Array, lengths: list[float]
) -> tuple[Circle, Any, Any]:
    """A circle about z, its radius the first of some lengths, turned and moved with what is around a direction."""
    turn, moved = turned(rng), rng.choice([0.0, 1.0]) * rng.normal(size=3) * lengths[0]
    angle = rng.choice([0.0, rng.uniform(0.0, 2.0 * np.pi)])
    toward = np.array([np.cos(angle), np.sin(angle), 0.0])
    circle = Circle(tuple(moved), tuple(turn[:, 2]), tuple(turn @ toward), lengths[0])
    return circle, tuple(turn @ centre + moved), tuple(turn @ direction)


def any_radius(rng: np.random.Generator) -> float:
    return float(10.0 ** rng.uniform(-3.0, 3.0))


def beside(rng: np.random.Generator, lengths: list[float]) -> Array:
    return np.array([offset(rng, lengths) for _ in range(3)])


def around_torus(rng: np.random.Generator) -> tuple[float, float, Array, Array]:
    """A meridian of a torus, or one of Villarceau's circles, or nearly so, and its core circle."""
    radius, size = any_radius(rng), rng.uniform(0.01, 0.99)
    away = rng.choice([0.0, 1.0]) * np.array([small(rng) for _ in range(3)]) * radius
    if rng.random() < 0.5:
        return size * radius, radius, np.array([radius, 0.0, 0.0]) + away, np.array([0.0, 1.0, 0.0])
    return radius, radius, np.array([size * radius, 0.0, 0.0]) + away, np.array([0.0, size, np.sqrt(1 - size * size)])


def with_line(rng: np.random.Generator) -> tuple[Circle, Round]:
    radius = any_radius(rng)
    circle, point, direction = scattered(rng, beside(rng, [radius]), tilted(rng), [radius])
    return circle, Round(point, direction, 0.0, 0.0)


def with_round(rng: np.random.Generator) -> tuple[Circle, Round]:
    """The surface of a cylinder or a cone, outward or inward; one in four runs through all of the circle, nearly."""
    radius = any_radius(rng)
    other = radius_beside(rng, radius)
    place = beside(rng, [radius, other, abs(radius - other), radius + other])
    circle, point, direction = scattered(rng, place, tilted(rng), [radius])
    taper = float(rng.choice([0.0, small(rng), rng.uniform(-0.95, 0.95)]))
    return circle, Round(point, direction, other * float(rng.choice([-1.0, 1.0])), taper)


def with_circle(rng: np.random.Generator) -> tuple[Circle, Circle]:
    if rng.random() < 0.1:
        radius, other, place, axis = around_torus(rng)
    else:
        radius, axis = any_radius(rng), tilted(rng)
        other = radius_beside(rng, radius)
        place = beside(rng, [radius, other, abs(radius - other), radius + other])
    circle, centre, axis_there = scattered(rng, place, axis, [radius])
    across = np.cross(axis_there, rng.normal(size=3))
    there = Circle(centre, axis_there, tuple(across / np.linalg.norm(across)), other)
    return (circle, there) if rng.random() < 0.5 else (there, circle)
