"""A body as its boundary: trimmed vertices, edges, circles and faces; where two boundaries meet, at rest and moving.

It is built beside `cagepose.kernels.shapes`, whose place it will take.
"""
