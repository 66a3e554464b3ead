"""The tolerances of lengths, which scale with the scene, and those of linear algebra, which have no unit."""

from __future__ import annotations

from typing import NamedTuple

from cagepose.kernels.native.kernel import kernel


class KernelTolerances(NamedTuple):
    """Lengths are metres; whoever builds this scales them by the scene's size.

    Attributes
    ----------
    touch_m
        A cage point within this distance of a face touches it. Set by the user, 1e-9 of the scene's size by default.
    resolution_m
        Depths up to this are rounding, not penetration. 1e-12 of the size: a thousand times the rounding of one pose
        (about 1e-15), a thousand times below the default touch tolerance. Motions end at a gap of exactly zero, so
        results do not carry this error.
    rounding_m
        A point that starts deeper than ``resolution_m`` (a start pose drawn by hand) may not go deeper by more than
        this. 1e-14 of the size.
    tie
        A moment below this fraction of force times distance is zero (rules R1, R2, Slp-1, Slp-2): in a turned frame
        an exact zero comes out as 1e-17 to 1e-15. No unit.
    """

    touch_m: float
    resolution_m: float
    rounding_m: float
    tie: float


RESOLUTION_OF_SIZE = 1e-12
ROUNDING_OF_SIZE = 1e-14
TIE_OF_MOMENT = 1e-9
"""See `KernelTolerances`."""
PROBE, PROBE_MARGIN = 3.0, 1.5
"""In touch tolerances: how far into a part it is asked whether there is material. The probe must clear a point that
lies a whole tolerance inside (hence more than 1 and more than the margin), and the margin must clear boxes that meet up
to a tolerance apart. Scenes refuse boxes thinner than 10.
"""

NEGLIGIBLE_ROTATION = 1e-20
"""Fraction of the diagonal entries. A rotation for a smaller entry would turn by less than any rounding."""
SINGULAR_PIVOT = 1e-11
"""Fraction of the greatest pivot. A smaller pivot is zero."""
RESIDUAL_OF_RIGHT_SIDE = 1e-11
"""Fraction of the right side. A smaller residual is rounding, and there is no vector."""
DEPENDENT_COLUMN = 1e-10
"""Fraction of a column. A column whose part outside the span of the others is smaller depends on them, where nothing
else is said."""
LEAST_PRICE = 1e-15
"""In lengths of the residual's terms. A column that points along the residual by less only meets rounding."""
LEAST_COEFFICIENT = 1e-11
"""A column that a dependent one takes less of than this cannot be dropped for it: that would divide by rounding."""
ORTHOGONAL_SHARE = 0.5
"""Share of the square of a vector. If one orthogonalisation leaves more, the vector is orthogonal to rounding."""
RESIDUAL_OF_OBJECTIVE = 1e-11
"""Fraction of the terms that f is the sum of. With a smaller residual the rows in use give f but for rounding. A share
of a ray that is smaller than this ends at no row."""
VIOLATION_OF_ROW = 1e-13
"""Fraction of the terms that x is the sum of. A row that x violates by less holds but for rounding."""
SUM_ROUNDING = 4e-15
"""Fraction of the magnitudes that are summed. It is twice the rounding of six products and their sum, twice."""


def kernel_tolerances(size_m: float, touch: float) -> KernelTolerances:
    """Scale the tolerances to a scene of size ``size_m``; ``touch`` is the user's fraction of it."""
    return KernelTolerances(
        touch_m=touch * size_m,
        resolution_m=RESOLUTION_OF_SIZE * size_m,
        rounding_m=ROUNDING_OF_SIZE * size_m,
        tie=TIE_OF_MOMENT,
    )


@kernel
def scaled_tolerances(of_size: KernelTolerances, size_m: float) -> KernelTolerances:
    """Scale tolerances that are given for a scene of size 1."""
    return KernelTolerances(
        of_size.touch_m * size_m, of_size.resolution_m * size_m, of_size.rounding_m * size_m, of_size.tie
    )


@kernel
def allowed_depth(depth_m: float, tolerances: KernelTolerances) -> float:
    """Return how deep what starts at ``depth_m`` may go: no deeper than it is, rounding apart."""
    return max(tolerances.resolution_m, depth_m + tolerances.rounding_m)
