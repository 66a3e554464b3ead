"""Every tolerance of play's kernels, with its unit and reason. Lengths are in lengths of the scene.

Rows, slopes and positions are then of terms about one, and so are the sums that these are compared with.
"""

ROUNDING_OF_SUM = 1e-15
"""A sum's own rounding."""
ROUNDING_OF_TERMS = 1e-12
"""A smaller sum may be all rounding. It may be a bound, a gain, a coefficient, a speed, or the residual of a matrix."""
ROUNDING_OF_GAP = 1e-13
"""Length. Gaps of points that touch are known so well."""
GAP_OF_TOUCH = 1e-8
"""Length. A point that is beyond a face by less touches it, and does not stay beyond it instead of its own: the search
leaves limiting gaps of 1e-12, and knows flat tops to their square root."""
SAME_ROW = 1e-7
"""A row that differs by less from one that is taken, or from a sum of such, says nothing new."""
LEAST_PRICE = 1e-9
"""Fraction of the slope, for each length that a gap grows. A gap that is worth less does not limit an end."""
RESIDUAL_OF_SLOPE = 1e-6
"""Fraction of the slope. An end is one if the limiting rows hold all but this. Flat tops are known to 1e-7."""

FIRST_RADIUS = 0.3
"""Radians, and length. The linear rows say little beyond."""
LAST_RADIUS = 1e-6
"""Fraction of the motion. The value errs by the square of this."""
SHORTEST_STEP = 1e-9
"""Radians, and length. Where no step of this size can be taken, none is left."""
LAST_NEWTON_STEP = 1e-7
"""Fraction of the motion. A Newton step that is shorter is the last one, and the value errs by the square of this."""
ADDED_CURVATURE = 1e-6
"""Fraction of the curvature. It is added to it, so that directions in which nothing changes stay where they are."""
GREATEST_PITCH_RAD = 1.55
"""Radians. A greater pitch is next to the pole of the angles; where it can go there, it has no extreme."""
DISTANCE_OF_ESCAPE = 20.0
"""Length. An object that gets so far is out."""
MOST_MISSING = 0.01
"""Fraction of an objective. Programs whose multipliers miss it by more have no proof."""
