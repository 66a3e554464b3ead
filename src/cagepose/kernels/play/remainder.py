"""What linearising a gap or the shift of a point leaves out, bounded over a box of twists: equation (7.8)."""

from __future__ import annotations

from cagepose.kernels.algebra.vector import Vector, dot, minus, norm, scaled
from cagepose.kernels.native.kernel import kernel


@kernel
def spread(a: Vector, size: Vector) -> float:
    """Return the greatest a . w where |w_k| <= size_k."""
    return abs(a[0]) * size[0] + abs(a[1]) * size[1] + abs(a[2]) * size[2]


@kernel
def turning_left_out(a: Vector, arm: Vector, turn: Vector) -> tuple[float, float]:
    """Bound a . (exp(w) d - d - w x d) from above, and its magnitude, where |w_k| <= turn_k (7.8)."""
    along = dot(a, arm)
    across = minus(arm, scaled(a, along))
    size = norm(turn)
    mixed = 0.5 * spread(a, turn) * spread(across, turn)
    square = 0.5 * size * size * abs(along)
    cubic = size * size * size * norm(arm) / 6.0
    return mixed + cubic + (square if along < 0.0 else 0.0), mixed + cubic + square


@kernel
def gap_left_out(normal: Vector, arm: Vector, travel: Vector, turn: Vector) -> tuple[float, float]:
    """Bound what linearising leaves out of the part of d - t along a normal that turns with the object (7.8)."""
    above, size = turning_left_out(normal, arm, turn)
    n = (abs(normal[0]), abs(normal[1]), abs(normal[2]))
    coupled = (
        n[0] * (turn[1] * travel[2] + turn[2] * travel[1])
        + n[1] * (turn[2] * travel[0] + turn[0] * travel[2])
        + n[2] * (turn[0] * travel[1] + turn[1] * travel[0])
    )
    coupled += 0.5 * dot(turn, turn) * norm(travel)
    return above + coupled, size + coupled
