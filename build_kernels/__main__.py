"""``python -m build_kernels``: write the library of kernels beside their sources."""

import argparse
import sys
import time

from build_kernels.build import build

parser = argparse.ArgumentParser(prog="python -m build_kernels", description=__doc__)
parser.add_argument("--all-levels", action="store_true", help="for all processors of the family, as in a wheel")
given = parser.parse_args()
began = time.perf_counter()
path = build(all_levels=given.all_levels)
sys.stdout.write(f"Built {path.name}, {path.stat().st_size / 1e6:.1f} MB, in {time.perf_counter() - began:.0f} s.\n")
