"""The tolerances of what the commands print."""

END_AT_START = 1e-12
"""Metres or radians. An end that is nearer is at the start but for rounding."""
LEAST_PRESS = 1e-9
"""Newtons. A smaller limit of what presses is zero but for rounding."""
LEAST_GAP_WORK = 1e-12
"""In the work of the load along its size. A smaller work along gaps is rounding, and is not told."""
