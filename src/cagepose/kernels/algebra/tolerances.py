"""The tolerances of lengths, which scale with the scene."""

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
TIE = 1e-9
PROBE, PROBE_MARGIN = 3.0, 1.5
"""In touch tolerances: how far into a part it is asked whether there is material. The probe must clear a point that
lies a whole tolerance inside (hence more than 1 and more than the margin), and the margin must clear boxes that meet up
to a tolerance apart. Scenes refuse boxes thinner than 10.
"""


def kernel_tolerances(size_m: float, touch: float) -> KernelTolerances:
    """Scale the tolerances to a scene of size ``size_m``; ``touch`` is the user's fraction of it."""
    return KernelTolerances(
        touch_m=touch * size_m,
        resolution_m=RESOLUTION_OF_SIZE * size_m,
        rounding_m=ROUNDING_OF_SIZE * size_m,
        tie=TIE,
    )


@kernel
def scaled_tolerances(of_size: KernelTolerances, size_m: float) -> KernelTolerances:
    """Scale tolerances that are given for a scene of size 1."""
    return KernelTolerances(
        of_size.touch_m * size_m, of_size.resolution_m * size_m, of_size.rounding_m * size_m, of_size.tie
    )
