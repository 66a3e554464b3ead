"""A body as its boundary: trimmed vertices, edges, circles and faces; where two boundaries meet, at rest and moving."""
