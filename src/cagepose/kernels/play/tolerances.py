"""Every tolerance of play's kernels, with its unit and reason. Lengths are in lengths of the scene.

Rows, slopes and positions are then of terms about one, and so are the sums that these are compared with.
"""

EPSILON = 1e-15
"""A sum's own rounding."""
ROUNDING = 1e-12
"""A sum that is smaller may be all rounding: of a bound, a gain, a coefficient, a speed, what is left of a matrix."""
GAP_ROUNDING = 1e-13
"""Length: gaps of points that touch are known so well."""
TOUCHES = 1e-8
"""Length. A point that is beyond a face by less touches it, and does not stay beyond it instead of its own: the search
leaves limiting gaps of 1e-12, and knows flat tops to their square root."""
SAME_ROW = 1e-7
"""A row that differs by less from one that is taken, or from a sum of such, says nothing new."""
PRICELESS = 1e-9
"""Of the slope. What a gap must be worth, to limit an end, for each length that it grows."""
STATIONARY = 1e-6
"""Of the slope: an end is one if the limiting rows hold all but this. Flat tops are known to 1e-7."""

FIRST_RADIUS = 0.3
"""Radians, and length: the linear rows say little beyond."""
LAST_RADIUS = 1e-6
"""Of the motion: the value errs by the square of this."""
SHORTEST = 1e-9
"""Radians, and length: where no step of this size can be taken, none is left."""
LAST_STEP = 1e-7
"""Of the motion: a Newton step that is shorter is the last one; the value errs by the square of this."""
FLAT = 1e-6
"""Of the curvature: added to it, so that directions in which nothing changes stay where they are."""
STEEPEST = 1.55
"""Radians. Pitch beyond is next to the pole of the angles; where it can go there, it has no extreme."""
FARTHEST = 20.0
"""Length. Whoever gets so far is out."""
