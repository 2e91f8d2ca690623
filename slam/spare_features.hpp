#pragma once
#include <algorithm>
#include <optional>
#include <vector>

#include "slam/features.hpp"

namespace depthscope::slam {

/// Where further features of a picture go: behind the others while there is room, then in place of
/// those that may give way, the weakest corners first. All storage is allocated by the constructor.
class SpareFeatures {
 public:
  explicit SpareFeatures(int capacity) : capacity_(capacity) { spare_.reserve(capacity); }

  /// Features for whose index `may_go` is true may give way.
  template <typename MayGo>
  void collect(const FeatureSet& features, const MayGo& may_go) {
    spare_.clear();
    for (int f = 0; f < features.size(); ++f)
      if (may_go(f)) spare_.push_back(f);
    std::sort(spare_.begin(), spare_.end(), [&](int a, int b) {
      const float strength_a = features.keypoints[a].response,
                  strength_b = features.keypoints[b].response;
      return strength_a != strength_b ? strength_a > strength_b : a < b;
    });
  }
  /// Where the next feature goes; nothing when there is no room left.
  std::optional<int> slot(const FeatureSet& features) const {
    if (features.size() < capacity_) return features.size();
    if (spare_.empty()) return std::nullopt;
    return spare_.back();
  }
  /// A feature was put there.
  void take(int slot) {
    if (!spare_.empty() && spare_.back() == slot) spare_.pop_back();
  }

 private:
  int capacity_;
  std::vector<int> spare_;
};

}  // namespace depthscope::slam
