#include "platform/histogram.hpp"

#include <algorithm>
#include <cmath>

namespace depthscope::platform {
namespace {
constexpr double smallest_ms = 1e-3;
constexpr double growth = 1.02;  // from one bucket to the next
}  // namespace

void Histogram::add(double ms) {
  if (!std::isfinite(ms)) return;
  const double bucket = std::log(std::max(ms, smallest_ms) / smallest_ms) / std::log(growth);
  ++buckets_[static_cast<std::size_t>(std::min(bucket, bucket_count - 1.0))];
  ++count_;
  max_ = std::max(max_, ms);
}

double Histogram::percentile(double p) const {
  if (count_ == 0) return 0;
  const auto rank =
      static_cast<std::uint64_t>(std::max(1.0, std::ceil(p * static_cast<double>(count_))));
  std::uint64_t seen = 0;
  for (int i = 0; i < bucket_count; ++i) {
    seen += buckets_[static_cast<std::size_t>(i)];
    // The geometric middle of the bucket; never above what was really seen.
    if (seen >= rank) return std::min(max_, smallest_ms * std::pow(growth, i + 0.5));
  }
  return max_;
}

}  // namespace depthscope::platform
