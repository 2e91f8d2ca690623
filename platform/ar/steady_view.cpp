#include "platform/ar/steady_view.hpp"

#include <algorithm>
#include <utility>

namespace depthscope::platform {
namespace {

void unite(ViewOutline& with, const ViewOutline& other) {
  for (std::size_t i = 0; i < with.spans.size(); ++i) {
    ViewOutline::Span& a = with.spans[i];
    const ViewOutline::Span& b = other.spans[i];
    if (b.empty()) continue;
    a = a.empty() ? b : ViewOutline::Span{std::min(a.left, b.left), std::max(a.right, b.right)};
  }
}

}  // namespace

bool SteadyView::add(const ViewOutline& seen, const PoseEstimate& estimate) {
  if (estimate.state != TrackingState::Tracking) return false;
  const double time_s = estimate.timestamp_s;
  if (now_ && time_s - since_s_ >= remembered_s) before_ = std::exchange(now_, std::nullopt);
  if (!now_) since_s_ = time_s;
  if (now_)
    unite(*now_, seen);
  else
    now_ = seen;
  ViewOutline view = *now_;
  if (before_) unite(view, *before_);
  if (view == view_) return false;
  view_ = view;
  return true;
}

}  // namespace depthscope::platform
