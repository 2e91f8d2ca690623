#pragma once

namespace depthscope::slam {

/// Which build of the integer kernels runs. The results are the same, only the speed differs; tests
/// run every path.
enum class SimdPath { Portable, Avx2 };

/// Is the path built in, and can this processor run it?
bool isAvailable(SimdPath path);
/// The fastest available.
SimdPath bestSimdPath();

}  // namespace depthscope::slam

// A kernel is written once as a DEPTHSCOPE_KERNEL template or function of plain loops over bytes,
// and compiled twice: by a caller of the baseline and by one marked DEPTHSCOPE_AVX2, into which it
// is inlined. Integer code only: it gives the same result at every vector width.
#define DEPTHSCOPE_KERNEL [[gnu::always_inline]] inline
#if defined(__x86_64__)
#define DEPTHSCOPE_HAS_AVX2 1
#define DEPTHSCOPE_AVX2 [[gnu::target("avx2")]]
#else
#define DEPTHSCOPE_HAS_AVX2 0
#endif
