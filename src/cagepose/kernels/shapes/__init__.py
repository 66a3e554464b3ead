"""Where parts with vertices, edges and faces, rounded by a radius, meet."""
