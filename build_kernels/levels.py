"""The levels of the processor family that the library is built for. Needs nothing but Python."""

import platform

LEVELS = ("x86-64-v2", "x86-64-v3") if platform.machine().lower() in ("x86_64", "amd64") else ("generic",)
"""In the order of ``best_level.c``."""
