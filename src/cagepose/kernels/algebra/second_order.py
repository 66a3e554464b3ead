"""Second derivatives with a twist (t, w) of the gap between a plane that moves with the object and a point that does
not: those of n . (w x (w x d)) / 2 + n . (w x t), equations (5.9) and (7.3).

Travel is along the axes of the world; turning is about the rows of ``axes``, in units of one over ``radii``.
"""

from __future__ import annotations

from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.algebra.vector import Matrix, Vector, cross, dot
from cagepose.kernels.native.kernel import kernel


@kernel
def add_turned_arm(force: Vector, arm: Vector, factor: float, axes: Matrix, radii: Vector, out: FloatArray) -> None:
    """Add those of factor * force . (w x (w x arm)) / 2: of a force times an arm that turns."""
    together = dot(force, arm)
    for j in range(3):
        for k in range(3):
            value = 0.5 * (dot(force, axes[j]) * dot(arm, axes[k]) + dot(force, axes[k]) * dot(arm, axes[j]))
            if j == k:
                value -= together
            out[3 + j, 3 + k] += factor * value / (radii[j] * radii[k])


@kernel
def add_coupling(normal: Vector, factor: float, axes: Matrix, radii: Vector, out: FloatArray) -> None:
    """Add those of factor * n . (w x t): of a travel along a plane that turns."""
    for j in range(3):
        across = cross(normal, axes[j])
        for k in range(3):
            value = factor * across[k] / radii[j]
            out[k, 3 + j] += value
            out[3 + j, k] += value
