"""Numbers in, numbers out: machine code that is built with the program, plain Python with ``CAGEPOSE_KERNELS=python``.

Kernels check nothing, raise nothing and touch no file. Lengths are metres, angles radians, vectors 3-tuples. Whoever
calls them (`cagepose.model`, `cagepose.runs`) casts and checks first.
"""
