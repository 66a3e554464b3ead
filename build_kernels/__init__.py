"""Builds the library of kernels: Numba compiles them, LLVM optimises them, a C compiler links them.

Nothing of this is installed. ``python -m build_kernels`` writes the library into the source tree; `pip` does so through
``hatch_build.py``.
"""
