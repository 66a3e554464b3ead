"""Parts with vertices, edges and faces, rounded by a radius: where two of them meet, at a pose and along a motion."""
