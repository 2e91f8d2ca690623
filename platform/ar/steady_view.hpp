#pragma once
#include <optional>

#include "types/tracking.hpp"
#include "types/view_outline.hpp"

namespace depthscope::platform {

/// The view of the scope from what single pictures show of it. Dark surroundings stay dark; dark
/// tissue at their border does not, for scope and light move. So what was lit once within the last
/// seconds belongs to the view. Of a scope that is lost nothing does: withdrawn, it may see so
/// little that noise beside the view looks as lit as what is in it.
class SteadyView {
 public:
  /// How long a place stays in the view at least, and at most twice that [s].
  static constexpr double remembered_s = 5;

  /// What is seen in the picture that the estimate belongs to; its time does not fall. True when
  /// view() has changed.
  bool add(const ViewOutline& seen, const PoseEstimate& estimate);
  const ViewOutline& view() const { return view_; }
  void reset() { *this = SteadyView(); }

 private:
  std::optional<ViewOutline> now_, before_;  // seen since `since_s_`; in the time before it
  double since_s_ = 0;
  ViewOutline view_;
};

}  // namespace depthscope::platform
