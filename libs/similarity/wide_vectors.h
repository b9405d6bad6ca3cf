#pragma once

/// FATHOM_WIDE_VECTORS before a function: compiled for wider vectors too, and the widest that the processor
/// has are taken. Only for loops whose turns have nothing to do with each other: with no sums across turns
/// and no multiplication fused with an addition (see CMakeLists.txt) they give the same bits on every
/// processor. FATHOM_INDEPENDENT before such a loop: what it writes, no other turn reads.
#if defined(__clang__)
#define FATHOM_WIDE_VECTORS
#define FATHOM_INDEPENDENT
#elif defined(__x86_64__)
#define FATHOM_WIDE_VECTORS __attribute__((target_clones("avx2", "default")))
#define FATHOM_INDEPENDENT _Pragma("GCC ivdep")
#else
#define FATHOM_WIDE_VECTORS
#define FATHOM_INDEPENDENT _Pragma("GCC ivdep")
#endif
