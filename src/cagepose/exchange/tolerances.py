"""The tolerances of the exchange with other programs, each named by what it measures and in what."""

VOLUME_NOT_CONVEX = 1e-3
"""Fraction of a hull's volume. A mesh that is less by more is not convex."""
QUIET_OF_SIZE = 3e-7
"""In sizes of the scene. A window is quiet if no point moved by more."""
SAME_END = 1e-6
"""Fraction of a hole's radius. Ends of holes that are this near are one."""
PAST_FACE = 1e-11
"""Fraction of a part's size. Holes go on so far beyond their ends."""
ROUNDING_OF_MEASURES = 1e-7
"""Fraction of a volume, a moment or a size. What differs by less is the same, after the sums of two programs."""
SAME_AXES = 1e-7
"""Fraction of the greatest. Half axes of an ellipsoid that differ by less are those of a ball."""
