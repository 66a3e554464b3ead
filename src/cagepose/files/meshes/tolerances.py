"""The tolerances of meshes, each named by what it measures and in what.

A mesh in single precision is off by about 1e-7 of its size, which most of these come from.
"""

SAME_PLANE = 1e-5
"""Between the normals of planes, and in sizes between their heights. Less is rounding."""
DISTANCE_TO_BOTTOM = 1e-4
"""Fraction of a hole's radius. An end that is so near to the hole's bottom is in it."""
COSINE_ALONG_AXIS = 1e-6
"""Cosine between a hole's axis and the normal of a face. With at most this the face is along the axis."""
DISTANCE_OUTSIDE = 1e-6
"""Fraction of the size. Nothing of the part is so far outside of a triangle."""
LEAST_PYRAMID = 1e-12
"""Fraction of the cube of the size. A smaller pyramid is rounding."""
LEAST_PIECE = 1e-9
"""Fraction of the whole body's volume. A smaller piece is rounding."""
HEIGHT_OF_CUT = 1e-9
"""Fraction of a body's size. It is cut so far above a face."""
SINE_ACROSS = 1e-4
"""Sine of the angle between a hole's axis and the normal of a plane. With less, the plane is across the hole."""
VOLUME_NOT_CONVEX = 1e-5
"""Fraction of a hull's volume. A body that is less by more is not convex."""
LAST_MOVE = 1e-16
"""Fraction of the size. A smaller move is the last."""
ROUNDING_OF_MESH = 3e-7
"""Fraction of a mesh's size. What stands out by less does not. Single precision is off by as much."""
SINGLE_PRECISION = 1e-6
"""Fraction of a body's size. What is this near to a place or a plane is there, after single precision and some sums
with it."""
WIDEST_CRACK = 1e-3
"""Fraction of a mesh's size. What is open by more is missing."""
DEEPEST_CROSSING = 1e-4
"""Fraction of a mesh's size. A surface that runs through itself by less does so by what programs for CAD round to."""
FLAT_OF_SIZE = 1e-6
"""Fraction of a mesh's size. What is thinner is flat."""
LEAST_SHARED = 1e-6
"""Fraction of a hole's volume. A smaller part of it in a piece is rounding."""
PARALLEL_SINE = 1e-4
"""Sine between edges of one wall at most."""
DISTANCE_BEYOND = 1e-4
"""Fraction of a hole's radius. It is asked so far beyond its ends whether they are open."""
DISTANCE_OF_BALL = 1e-3
"""Fraction of the radius. Points that hang together and are as near to a ball are on it, before they tell it better."""
