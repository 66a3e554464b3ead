"""The tolerances a user may set, each with its unit and reason, and those of the model itself."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cagepose.model.checks import ProblemList, degrees_of, is_finite

TOUCH_DEFAULT = 1e-9
TOUCH_LEAST = 1e-11
TOUCH_GREATEST = 1e-4
GRAZING_BAND_DEFAULT_RAD = float(np.radians(1.0))

OVERLAP_OF_TOUCH = 1e-12
"""Share of their reach. Shapes that overlap by no more only touch: that is rounding."""
PARALLEL_SINE = 1e-9
"""Sine between two directions. With a smaller one they give no third direction across both."""
DISTANCE_OF_FACE = 1e-6
"""Fraction of a hole's reach. A hole's edge this close to a face is on it."""
LAST_GAIN = 1e-12
"""Fraction of the distance to its least. Steps end where the next one would bring it nearer by less."""
LEAST_CLEARANCE = 1e-6
"""Fraction of a hole's radius. A smaller clearance is none."""
DISTANCE_OUTSIDE = 1e-9
"""Fraction of a shape's size. A point that is no farther out is still in it."""
ROUNDING_OF_INERTIA = 1e-9
"""Fraction of the greatest entry, and of a sum of principal moments. An inertia is symmetric, and possible, to this."""
LEAST_VOLUME_LEFT = 1e-6
"""Share of a body's volume. Holes that leave less leave rounding."""
SHOWN_AS_ZERO = 1e-12
"""Fraction of the greatest of some numbers. A smaller number is shown as 0."""


@dataclass(frozen=True)
class Tolerances:
    """What counts as touching, and as grazing.

    Attributes
    ----------
    touch
        A cage point within this distance of a face touches it. A fraction of the scene's size (see `Scene.size_m`),
        so that a scene means the same in millimetres and in metres. The least allowed value stays clear of rounding
        (about 1e-15 of the size for each step of a run); above the greatest, touching would be visible play.
    grazing_band_rad
        A contact whose face is steeper than perpendicular to the load by at most this angle still counts as slipping
        (rule R5): without it the classification flips with the object's tilt, and a push leaves the rail of docs/theory
        at the wrong one.
    """

    touch: float = TOUCH_DEFAULT
    grazing_band_rad: float = GRAZING_BAND_DEFAULT_RAD

    def __post_init__(self) -> None:
        problems = ProblemList()
        if not is_finite(self.touch) or not TOUCH_LEAST <= self.touch <= TOUCH_GREATEST:
            problems.add(
                ("touch",),
                f"is {self.touch!r}; give a fraction of the scene's size, {TOUCH_LEAST:g} to {TOUCH_GREATEST:g}",
            )
        if not is_finite(self.grazing_band_rad) or not 0.0 <= self.grazing_band_rad < np.pi / 4.0:
            problems.add(
                ("grazing_band_deg",),
                f"is {degrees_of(self.grazing_band_rad)}; give an angle from 0 to below 45 deg",
            )
        problems.raise_if_any()
