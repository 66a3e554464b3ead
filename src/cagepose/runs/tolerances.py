"""The tolerances of runs: what counts as equal, parallel or zero before and after the kernels."""

TENSION_AT_ZERO = 1e-12
"""In the terms of a spring's tension. A smaller tension at length zero is rounding, and the spring's force is then
linear."""
MOMENT_ABOUT_POINT = 1e-12
"""In forces times their distances from each other. Forces whose moments agree so well act through one point."""
SINE_TO_SPAN = 1e-6
"""Sine of an angle. A freedom at a smaller angle to the undetermined ones lies in their span."""
EQUAL_DISTANCE_OF_SIZE = 1e-6
"""Fraction of the scene's size. Distances that differ by less are equal (R3, R6)."""
PARALLEL_SINE = 1e-6
"""Sine between normals. Normals at a smaller angle are one direction."""
LEAST_MOMENT = 1e-3
"""Fraction of force times distance. A smaller moment drives no turn (R3)."""
LEAST_RADIUS_OF_GYRATION = 1e-9
"""In lengths of the object. No radius of gyration is less."""
ACROSS_PLANE = 1e-6
"""Fraction of a phase's force. What is less across the plane of a planar scene is not told."""
