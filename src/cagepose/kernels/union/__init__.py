"""The boundary of a union: which planes, edges and vertices are left of its pieces, and how faces hang together."""
