#include "slam/simd_dispatch.hpp"

namespace depthscope::slam {

bool isAvailable(SimdPath path) {
  if (path == SimdPath::Portable) return true;
#if DEPTHSCOPE_HAS_AVX2
  return __builtin_cpu_supports("avx2");
#else
  return false;
#endif
}

SimdPath bestSimdPath() {
  return isAvailable(SimdPath::Avx2) ? SimdPath::Avx2 : SimdPath::Portable;
}

}  // namespace depthscope::slam
