#pragma once
#include <array>
#include <cstdint>

namespace depthscope::platform {

/// Durations in fixed memory: logarithmic buckets 2 % apart from 1 us to 20 min, so that a
/// percentile is known to 1 %. Count and maximum are exact. add() does not allocate.
class Histogram {
 public:
  void add(double ms);
  std::uint64_t count() const { return count_; }
  double max() const { return max_; }
  /// Value [ms] below which the share `p` (0..1) of all samples lies; 0 without samples.
  double percentile(double p) const;

 private:
  static constexpr int bucket_count = 1056;
  std::array<std::uint32_t, bucket_count> buckets_{};
  std::uint64_t count_ = 0;
  double max_ = 0;
};

}  // namespace depthscope::platform
