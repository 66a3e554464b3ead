"""Bodies as boundaries: their features for kernels, and the boundary of a union of convex pieces."""
