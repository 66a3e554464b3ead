"""The tolerances of pictures and of the page."""

DISTANCE_OF_EDGE = 1e-9
"""Fraction of the scene's size. The centre of gravity is on the edge of the support region if it is no farther from it.
"""
LEAST_ANGLE_DEG = 1e-3
"""Degrees. An axis of angles spans at least this, so that rounding does not fill it."""
LEAST_FORCE = 1e-9
"""Newtons, or loads. A drive that needs no more needs no force."""
LEAST_LENGTH_OF_SIZE = 1e-6
"""Fraction of the scene's size. An axis of lengths spans at least this."""
