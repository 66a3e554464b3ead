"""Numbers in, numbers out: compiled by Numba, plain Python with ``NUMBA_DISABLE_JIT=1``.

Kernels check nothing, raise nothing and touch no file. Lengths are metres, angles radians, vectors 3-tuples. Whoever
calls them (`cagepose.model`, `cagepose.runs`) casts and checks first.
"""
