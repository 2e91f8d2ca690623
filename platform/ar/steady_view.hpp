#pragma once
#include <optional>

#include "types/view_outline.hpp"

namespace depthscope::platform {

/// The view of the scope from what single pictures show of it. Dark surroundings stay dark; dark
/// tissue at their border does not, for scope and light move. So what was lit once within the last
/// seconds belongs to the view.
class SteadyView {
 public:
  /// How long a place stays in the view at least, and at most twice that [s].
  static constexpr double remembered_s = 5;

  /// The view in the picture of `time_s`, which does not fall. True when view() has changed.
  bool add(const ViewOutline& seen, double time_s);
  const ViewOutline& view() const { return view_; }
  void reset() { *this = SteadyView(); }

 private:
  std::optional<ViewOutline> now_, before_;  // seen since `since_s_`; in the time before it
  double since_s_ = 0;
  ViewOutline view_;
};

}  // namespace depthscope::platform
