"""What tests know of the processor that they run on."""

from numpy._core._multiarray_umath import __cpu_features__

HAS_AVX512 = bool(__cpu_features__.get("X86_V4") or __cpu_features__.get("AVX512_SKX"))
"""Without it, last digits differ, and a few runs whose way hangs on them end otherwise."""
