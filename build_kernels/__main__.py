"""``python -m build_kernels``: write the library of kernels beside their sources."""

import sys
import time

from build_kernels.build import build

began = time.perf_counter()
path = build()
sys.stdout.write(f"Built {path.name}, {path.stat().st_size / 1e6:.1f} MB, in {time.perf_counter() - began:.0f} s.\n")
