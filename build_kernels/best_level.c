/* What the library of kernels says of itself: a description, and the best level that this processor can run. */

#include "description.h"

const char *cagepose_description = CAGEPOSE_DESCRIPTION;

/* The index into the levels of the description; -1: the processor is older than all of them. */
int cagepose_best_level(void) {
#if defined(__x86_64__) || defined(_M_X64)
    __builtin_cpu_init();
    /* By features, as older compilers do not know the names of levels; every processor with these has the others. */
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2")) return 1;
    return __builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("popcnt") ? 0 : -1;
#else
    return 0;
#endif
}

/* Numba's arrays could own memory; those of kernels never do, so that this is never called. */
void NRT_MemInfo_call_dtor(void *info) { (void)info; }
