"""The tolerances of stability, of proofs and of the search for another impending motion.

Twists and wrenches have unit length where nothing else is said, and moments are divided by the radii of gyration.
"""

SPEED_OF_OPENING = 1e-9
"""In lengths of the motion. A contact that it leaves more slowly stays where it is."""
RESIDUAL_WITH_DIGITS = 1e-6
"""In lengths of the terms. A residual of this size is small enough for one last step, and large enough to have its
digits."""
RESIDUAL_OF_ROW = 1e-9
"""Fraction of a row's size. A row that lacks less lacks it by rounding."""
SINE_AT_REST = 5e-7
"""Sine of the angle that no motion has above those across the load: rest. One of v loads has at least v."""
ROUNDING_OF_RESIDUAL = 1e-15
"""In lengths of the terms of the residual."""
WIDER_CONES = 1e-6
"""Fraction of a cone's width. A twist is looked for that no force inside cones wider by this part drives, so that few
generators are enough."""
DEPENDENT_FORCE = 1e-13
"""Fraction of a force. Forces that depend on each other by less make no twist."""
POWER_OF_TWIST = 1e-14
"""Power of a unit wrench along a unit twist. Less power is rounding."""
POWER_WITHOUT_HELP = 1e-10
"""The same where no generator helps any more, since they nearly depend on each other. What the proof makes of such a
twist may still be small enough."""
POWER_OF_PROOF = 5e-13
"""The same of z of the proof. With SINE_AT_REST it leaves no motion above 1e-6 loads where forces add up to a load."""
RESIDUAL_WITHOUT_CUT = 1e-6
"""In lengths of the motion. Forces that miss less of it make it."""
LIMIT_OF_FRICTION = 1e-4
"""Fraction of the friction cone. A tangential force this near to it is at the limit of friction, which nobody knows as
well."""
PART_OUTSIDE_SPAN = 1e-9
"""Fraction of a wrench. A wrench whose part outside a span is smaller lies in it."""
FLAT_CURVATURE = 1e-9
"""Fraction of the greatest curvature, or of a load for each size of the scene. A smaller curvature is rounding."""
CLOSING_OF_TWIST = 1e-11
"""In lengths of wrench and twist. A twist that closes every contact by less than this opens those that it opens by more
than the next one. No forces on the rest stand against that but such of a hundred thousand times their size."""
OPENING_OF_TWIST = 1e-6
"""In lengths of wrench and twist. See the one before."""
NARROWEST_SECTOR_RAD = 1e-4
"""Radians. A narrower sector is not halved again."""
LEAST_MOTION = 1e-6
"""In lengths of the load. A slower motion is not told from rest."""
VIOLATION_TRIED = 0.2
"""Fraction of the load's power. A motion that violates Coulomb's law by less power is tried by Newton's method."""
SLIP_AT_REST = 1e-6
"""In lengths of the motion. A contact that moves more slowly stands still."""
SPEED_OF_PROOF = 1e-9
"""In the fastest drift. A force that does less work than the drive by so little does as much."""
