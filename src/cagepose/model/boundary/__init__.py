"""The boundary of a union of convex pieces: vertices, convex edges and trimmed faces."""
