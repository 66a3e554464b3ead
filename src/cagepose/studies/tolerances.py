"""The tolerances of studies, each named by what it measures and in what."""

RESIDUAL_OF_BALANCE = 1e-8
"""In lengths of the load. Forces that balance it leave at most this."""
ROUNDING_OF_FORCES = 2.3e-16
"""Fraction of the forces, which may be millions of loads. Rounding leaves so much of the load besides."""
SAME_PLACE_OF_SIZE = 1e-9
"""Fraction of the scene's size, and radians. Contacts are where the certificate says."""
FORCE_OUTSIDE_CONE = 1e-12
"""In lengths of load and forces. A force may be so far outside of its friction cone."""
POWER_OF_NONE = 1e-11
"""In units of load and unit forces. Less power along a leaf's twist counts as none. The search asks for a twentieth of
it; the rest is for the rounding of arms, where the centre of gravity is far from the contacts."""
RESIDUAL_OF_LEAF = 1e-6
"""In lengths of the load. Velocities that a leaf does not allow may leave so much of (b - z). The search asks for half
of it."""
GAP_OF_SECTORS_RAD = 1e-12
"""Radians. Sectors that are no farther apart meet."""
VIOLATION_OF_COULOMB = 1e-11
"""In lengths of the load. Another impending motion may violate Coulomb's law by so much, as a velocity. The search
allows a tenth of it."""
LEAST_MOTION = 0.99e-6
"""In loads. A greater velocity is a motion, and not rest. The search asks for 1e-6."""
SAME_LOAD = 1e-9
"""In lengths of the load, and of a unit wrench. Contacts and load of the kernel are those of the scene but for
rounding."""
SAME_POSE_OF_SIZE = 1e-6
"""Fraction of the scene's size. Two poses are one where nothing of the object is farther apart."""
RESIDUAL_SOLVED = 1e-14
"""In lengths of the load. A residual of so little is a solution. Rounding ends most searches first."""
LEAST_DAMPING = 1e-13
"""In the stiffness of the contacts. It is for directions in which they have no stiffness."""
SHORTEST_PART = 1e-12
"""Share of a step. No smaller part of it is tried."""
GAP_OF_BOUNDS = 1e-3
"""Fraction of the distance. The bounds from below and above may differ by so much."""
LEAST_EXTRA_LOAD = 1e-8
"""In lengths of the load. Less than this is nothing, for forces that balance leave that much."""
GREATEST_FORCE = 1e5
"""In lengths of the load. Greater forces come of surfaces that are parallel but for rounding (`RESIDUAL_OF_SELF_STRESS`
of the kernels)."""
SAME_PLACE_IN_TOUCHES = 2.0
"""In touch tolerances. Points that are nearer to each other are one."""
RESIDUAL_OF_NONE = 1e-7
"""In lengths of the load. Forces that leave more do not balance it to first order. A rest leaves at most 1e-8."""
VIOLATION_FOR_BOUNDS = 1e-6
"""In lengths of a twist. Rays follow the cones so closely for bounds, which are certain however they do, and need three
digits."""
VIOLATION_FOR_RANGES = 1e-9
"""In lengths of a twist. Rays follow the cones so closely for ranges, which need more digits."""
PROVEN_WITHIN = 0.01
"""Fraction of an end. An end that no motion can pass by more is proven. Certified bounds include more than the end
itself."""
RANGE_OF_FREEDOM = 1e-7
"""Lengths of the scene, or radians. A freedom with a smaller range at rest is determined."""
GAP_AT_FACES = 1e-12
"""Lengths of the scene. The touching points stay at their faces so exactly while ranges are asked."""
FARTHER_END = 1e-9
"""In sizes of the scene, or radians. An end that lies farther by less is the same."""
PARALLEL_SINE = 1e-6
"""Sine of the angle between two lines. With a smaller one they do not cross."""
ROUNDING_OF_CORNER = 1e-9
"""Fraction of the largest distance. A crossing that a line cuts off by less is a corner."""
VIOLATION_OF_CONE = 1e-9
"""In lengths of a twist. A cone that is violated by less is left as it is."""
DISTANCE_OF_CORNER = 1e-3
"""Fraction of a corner's distance from the centre of gravity, or from the farthest contact. A corner is no farther
outside."""
MARGINS_OF_JAMS = (0.1, 1e-2, 1e-3, 1e-4, 1e-6, 0.0)
"""In drifts. A motion that gives way is looked for with these margins, one after the other."""
SPEED_OF_GIVING_WAY = 1e-9
"""In drifts. A contact that opens more slowly than it must by less gives way by rounding, however fast the motion."""
FORCES_THAT_CANCEL = 1e-8
"""In what forces add up to. They cancel if they leave at most this."""
SAME_DRIFT = 1e-9
"""In the fastest drift, and in the growth of the load. Drifts and growth are those of the scene but for rounding."""
SAME_FREEDOM = 1e-7
"""In lengths of the wrenches. A self-stress leaves motions free that close or open its contacts by less."""
MOST_JAM_FRICTION = 10.0
"""Up to this coefficient of friction it is asked whether an object could jam, as along a run."""
JAM_FRICTION_WITHIN = 1e-5
"""Fraction of a coefficient. The least one that lets an object jam at a place is known so well."""
LEAST_JAM_FRICTION = 1e-6
"""A coefficient of friction. Less of it is none: surfaces that are parallel but for rounding let an object jam so."""
