#pragma once
#include <vector>

#include "platform/label_anchor.hpp"
#include "types/label.hpp"
#include "types/tracking.hpp"

namespace depthscope::platform {

/// Labels asked for by their place in the picture, each anchored once, on the first surface that is
/// there.
class LabelBoard {
 public:
  explicit LabelBoard(std::vector<LabelRequest> waiting) : waiting_(std::move(waiting)) {}

  void request(LabelRequest label) { waiting_.push_back(std::move(label)); }
  /// Anchors what waits, if `estimate` tracks in the surface's map; what misses the surface goes on
  /// waiting. True when labels() changed.
  bool anchorWaiting(const SurfaceMesh& mesh, const CameraModel& camera,
                     const PoseEstimate& estimate);
  const std::vector<Label>& labels() const { return labels_; }
  void clear() {
    labels_.clear();
    waiting_.clear();
  }

 private:
  std::vector<LabelRequest> waiting_;
  std::vector<Label> labels_;
  std::uint32_t next_id_ = 1;
};

}  // namespace depthscope::platform
