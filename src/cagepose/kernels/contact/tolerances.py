"""The tolerances of contacts, forces and impending motion, each named by what it measures.

Forces and residuals are measured in lengths of the load, motions in lengths of the generalised velocity, and wrenches
with moments divided by the radii of gyration, so that no value depends on the units of a scene.
"""

RESIDUAL_OF_LOAD = 1e-11
"""In lengths of the load. Forces whose residual is at most this balance the load."""
RESIDUAL_AT_LIMIT = 1e-9
"""In lengths of the load. The same at the limit of friction, where round cones leave more, since rounding counts there
by its square root."""
ROUNDING_OF_PLACE = 1e-14
"""In distances from the centre of gravity: of a place where features touch."""
RESIDUAL_BY_ROUNDING = 1e-8
"""In lengths of the load. The rounding of places leaves no more."""
SHARE_OF_FORCES = 1e-5
"""Share of the lengths of the forces that counts for the length that a residual is measured in. It allows for their
rounding."""
MOST_FORCES_COUNTED = 1e8
"""In lengths of the load. Greater forces count no more, so that no balance leaves more than 1e-8 of the load."""
LEAST_FORCE = 1e-13
"""In lengths of the load. A contact that carries less carries nothing."""
STEEPER_BY_ROUNDING = 1e-13
"""In lengths of the residual. A generator that points along it by so little more than one in use is no better."""
LEAST_COSINE_OF_PITCH = 1e-6
"""Cosine of the pitch. Nearer to the joint's pole yaw and roll are one, and their slopes are taken as here."""
SAME_NORMAL_RAD = 1e-9
"""Radians between normals that are one. Flush faces of two boxes give one contact."""
VIOLATION_OF_COULOMB = 1e-9
"""In lengths of the motion. A motion that violates Coulomb's law by at most this obeys it."""
VIOLATION_IN_LOADS = 1e-6
"""In lengths of the load. Where the limit above is not reached, this one counts: it bends the path by far less than a
step does."""
LONGEST_MOTION = 1.0 + 1e-9
"""In lengths of the load. No motion is longer."""
LEAST_SPEED_OF_LAW = 1e-5
"""In lengths of the load. The violation of the law by a slower motion is measured as if it were as fast."""
SLIP_TRIED_STICKING = 1e-6
"""In lengths of the motion. A contact that slips more slowly is first tried as one that sticks."""
SLIP_TRIED_LAST = 1e-10
"""In lengths of the motion. The same for the second trial."""
LEAST_ALONG = 0.5
"""Cosine of a motion and the one before. One that turns by more is farther from it than rest, at the same speed."""
SLOWEST_ALONG = 1e-9
"""In lengths of the load. A motion that goes on, and is no faster, has come to rest."""
LAST_CHANGE = 1e-14
"""In lengths of the load. After so small a change the next one is rounding, since the digits double."""
LENGTH_OF_NO_SPRING = 1e-6
"""In sizes of the scene. The ends of a shorter spring count as one point."""
ROUNDING_OF_ENDS = 1e-4
"""In stiffnesses times where a spring is held. A load is measured in no less: of that the rounding of places is a
balance."""
SHORTEST_SPRING = 1e-12
"""In sizes of the scene. A spring is taken to be no shorter, where its length limits a step."""
LAST_TURN_RAD = 1e-9
"""Radians. A smaller change of the place on a circle ends the search that follows the slip."""
SPEED_OF_ENTRY = 1e-10
"""In lengths of the motion. A point of a circle that goes in more slowly does not count."""
ROUNDING_OF_SPEED = 3e-16
"""Fraction of the terms of the load. So much of a speed is their rounding."""
FASTER_MOTION = 1.0 + 1e-9
"""Factor between two speeds. A motion that is faster by less is the same."""
RESIDUAL_OF_SELF_STRESS = 1e-5
"""In lengths of the wrenches. Forces that leave at most this cancel. A plate that touches on both sides, within the
touch tolerance, can be tilted by up to the root of that tolerance; and its forces would be 1e5 loads and more."""
SHARE_IN_SELF_STRESS = 1e-4
"""In lengths of the wrenches, of forces that add up to one. A contact belongs to a self-stress if it carries more in
it."""
LEAST_CURVATURE = 1e-6
"""Fraction of the greatest second derivative. A smaller one is rounding."""
LEAST_PLAY = 1e-10
"""In radii of gyration. A contact with a wider gap has play, though it touches. A fork that turns around two opposite
points opens by the square of its turn."""
CARRIED_ALONG_LOCKED = 1e-6
"""In lengths of the load. So much along the motions that are stopped is more than rounding."""
SAME_PLACE_RAD = 1e-7
"""Radians. A circle goes in less than the square of this between a point and its deepest one, if they are nearer."""
PARALLEL_COSINE = 1.0 - 1e-12
"""Cosine of the angle between normals of one face, or axes of one circle."""
SAME_WAY = 0.5
"""Cosine of the angle between normals of one contact, before and after a step, or of one circle on one face."""
ACROSS = 1e-9
"""Length of the scaled wrench of a unit normal. A shorter one is the rounding of a normal along what is held."""
LEAST_OF_WHOLE = 1e-6
"""Fraction of a force or moment. If less of it is along what is not held, its rounding is no load."""
