"""The tolerances of what STEP files hold, each named by what it measures and in what."""

TANGENT_RAD = 1e-4
"""Radians between the faces at an edge. A smaller angle is none."""
LEAST_TAKEN = 1e-9
"""Fraction of the volume. Less than this is nothing that was taken away."""
SAME_OF_SIZE = 1e-7
"""Fraction of the size. Places and moments that are this near are one."""
SAME_VOLUME = 1e-7
"""Fraction of the volume. Shapes that have it are the solid, and its triangles alone are off."""
SAME_PLACE = 1e-8
"""Fraction of the size. Corners of different faces that are this near are one."""
